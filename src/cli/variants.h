// The combinations of option values that a command line compares.
#ifndef LAMPYRIS_CLI_VARIANTS_H
#define LAMPYRIS_CLI_VARIANTS_H

#include "cli/options.h"

#define VARIANTS_MAX 64 // the limit exists because each variant has a renderer of its own

struct variant {
    const char *label;      // "sampler=pcg wave=4k"; "" if nothing is varied
    const char *picture;    // the part of `label` that changes the image: "sampler=pcg"
    uint32_t scene;         // index into the scenes of the command line
    struct options options; // options.scene.path is that scene
};

// Makes all combinations of the values of --vary (for bench: --sweep), with the last option varying
// fastest. The variants of --curve come before them. This is done for each scene. Fails with
// ERR_USAGE if a key is not a setting, or a value is not one of its values. `arena` owns the
// result.
bool variants_make(const struct options *options, struct arena *arena, struct variant **out,
                   uint32_t *count, struct err *err);

// Returns whether two variants must give the same image, bit for bit.
bool variants_share_picture(const struct variant *a, const struct variant *b);

#endif
