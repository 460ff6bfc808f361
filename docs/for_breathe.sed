# The header as Breathe can take it: a struct and its typedef have one name, which Sphinx takes for two declarations.
s/^typedef struct \([a-z_0-9]*\) {/struct \1 {/
s/^} ofc_[a-z_0-9]*;/};/
s/^typedef struct \([a-z_0-9]*\) \1;/struct \1;/
# Two parameters with one description.
s|^/// @param width,height  \(.*\)|/// @param width  \1\n/// @param height  \1|
