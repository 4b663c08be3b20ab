// The combinations of option values that a command line compares.
#ifndef LAMPYRIS_CLI_VARIANTS_H
#define LAMPYRIS_CLI_VARIANTS_H

#include "cli/options.h"

#define VARIANTS_MAX 64 // each has a renderer of its own

struct variant {
    const char *label;      // "sampler=pcg wave=4k"; "" if nothing is varied
    const char *picture;    // the part of the label that changes images: "sampler=pcg"
    uint32_t scene;         // index of the command line's scenes
    struct options options; // whose scene.path is that scene
};

// Makes all combinations of the values of --vary (--sweep of bench), with the last option varying
// fastest, after those of --curve; for each scene in turn. ERR_USAGE names a key that is no setting
// or a value that it does not have. The result lives in `arena`.
bool variants_make(const struct options *options, struct arena *arena, struct variant **out,
                   uint32_t *count, struct err *err);

// Returns whether two variants must give the same image, bit for bit.
bool variants_share_picture(const struct variant *a, const struct variant *b);

#endif
