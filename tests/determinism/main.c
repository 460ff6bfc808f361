/* Prints a digest of everything that the library computes, one line a group: the same text on every target. */
#include "digest.h"
#include "inputs.h"
#include "stages.h"

#include "board.h"

uint64_t workspace[OFC_LARGER(OFC_PAINT_WORKSPACE_SIZE, OFC_LARGER(OFC_SEGMENT_WORKSPACE_SIZE(WIDTH, HEIGHT),
                                                                   OFC_SURFACE_WORKSPACE_SIZE(WIDTH, HEIGHT))) /
                   sizeof(uint64_t) + 1];
const size_t workspace_bytes = sizeof workspace;
float normals[PIXELS * 3];
float angles[PIXELS];
uint8_t marks[PIXELS];

static void print(const char *scene, const char *group)
{
    char name[64];
    int length = 0;
    for (const char *letter = scene; *letter != 0; letter++)
        name[length++] = *letter;
    name[length++] = ':';
    name[length++] = ' ';
    for (const char *letter = group; *letter != 0; letter++)
        name[length++] = *letter;
    name[length] = 0;
    digest_print(name);
}

/* The paint and the offset of every so-many-th scene: they take as long as all the rest where doubles are emulated. */
enum { PAINTED = 4 };

int main(void)
{
    digest_constants();
    digest_mathematics();
    digest_rendering();
    for (int i = 0; i < SCENES; i++) {
        static const struct fitted nothing;
        struct fitted fitted = nothing;
        const ofc_image image = scenes[i].make();
        mix_fit(&image, &fitted);
        print(scenes[i].name, "fit");
        mix_lights(&image, &fitted);
        print(scenes[i].name, "lights");
        mix_methods(&image, &fitted);
        print(scenes[i].name, "orientation methods");
        mix_segments(&image, &fitted);
        print(scenes[i].name, "segments and ranks");
        mix_solve(&image, i);
        print(scenes[i].name, "solve");
        mix_flat_field(&image);
        mix_stream(&image);
        print(scenes[i].name, "flat field and stream");
        if (i % PAINTED == 0) {
            mix_paint(&image);
            print(scenes[i].name, "paint");
            mix_transfer(&image, &fitted);
            print(scenes[i].name, "transfer");
        }
        /* One is enough: its integrations take as long. */
        if (i == 0) {
            mix_surface(&image);
            print(scenes[i].name, "whole surface");
        }
    }
    mix_relief();
    print("bump", "relief");
    board_print("done\n");
    return 0;
}
