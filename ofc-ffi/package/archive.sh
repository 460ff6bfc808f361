#!/bin/sh
# archive.sh RAW CLEAN: from the archive that cargo makes, one that defines nothing but ofc_*.
#
# RAW brings along the runtime of the Rust compiler, with functions such as fmod, cbrt and fma: linked before -lm it would give
# them to the whole program, and beside another Rust library it would define them twice. So the object of the library is linked
# with what it needs of them, and all names but ofc_* become local. Sections stay apart, for --gc-sections.
#
# CC (with the options that choose the target), NM, OBJCOPY and AR name the tools.
set -eu
raw=$(realpath "$1")
clean=$2
mkdir -p "$(dirname "$clean")"
work=$(mktemp -d "$clean.XXXXXX")
trap 'rm -rf "$work"' EXIT

${AR:-ar} t "$raw" | grep -E '^ofc[-.].*\.o$' >"$work/members"
if [ "$(wc -l <"$work/members")" -ne 1 ]; then
    echo "$raw: more than one object of the library, or none: it was built without link-time optimization" >&2
    exit 1
fi
(cd "$work" && ${AR:-ar} x "$raw" "$(cat members)" && mv "$(cat members)" library.o)
# shellcheck disable=SC2086 # CC may hold options
${CC:-cc} -nostdlib -r "$work/library.o" "$raw" -o "$work/linked.o"
# Without bitcode for the compiler's own use, which binutils with LLVM's plugin take for the whole object.
${OBJCOPY:-objcopy} --wildcard --keep-global-symbol='ofc_*' --remove-section=.llvmbc --remove-section=.llvmcmd \
    "$work/linked.o" "$work/ofc.o"
if ${NM:-nm} -g --defined-only "$work/ofc.o" | grep -vE '^$| T ofc_[a-z0-9_]+$' >&2; then
    echo "$raw: these names are not to be defined" >&2
    exit 1
fi
${AR:-ar} rcs "$work/libofc.a" "$work/ofc.o"
# What has not changed stays as old as it is, and nothing is linked anew because of it.
cmp -s "$work/libofc.a" "$clean" || mv "$work/libofc.a" "$clean"
