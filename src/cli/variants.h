// Combinations of values of options that a command line asks to compare.
#ifndef LAMPYRIS_CLI_VARIANTS_H
#define LAMPYRIS_CLI_VARIANTS_H

#include "cli/options.h"

#define VARIANTS_MAX 64 // each has a renderer of its own

struct variant {
    const char *label;      // "sampler=pcg wave=4k"; "" where nothing is varied
    const char *picture;    // what of the label changes pictures: "sampler=pcg"
    uint32_t scene;         // index of the command line's scenes
    struct options options; // whose scene.path is this one
};

// All combinations of the values of --vary (--sweep of bench), the last one changing fastest, after
// those that --curve spells out; for each scene in turn. ERR_USAGE names what is no setting or has
// no such value. The result lives in `arena`.
bool variants_make(const struct options *options, struct arena *arena, struct variant **out,
                   uint32_t *count, struct err *err);

// Returns whether two variants are to give the same picture, bit for bit.
bool variants_share_picture(const struct variant *a, const struct variant *b);

#endif
