// Defines variations of a render that must not change a single bit of the image: the size of the
// waves, how samples are divided among calls, features that the scene does not use, the ways to
// read and reserve memory, and lower device limits (docs/verification.md, G1, G2 and G3).
#ifndef LAMPYRIS_CHECK_BITS_H
#define LAMPYRIS_CHECK_BITS_H

#include "check/check.h"

#define BITS_SAMPLES 32u

struct bits_variant {
    const char *name;
    struct gpu_limit_overrides limits;
    bool from_storage; // reads the scene from storage buffers, of which few devices can bind enough
    uint32_t wave;
    bool compile_all;
    // Samples of the first calls; the last call renders the rest of BITS_SAMPLES.
    uint32_t first_calls[2];
    bool restarted;      // renders samples with another seed first
    bool representative; // also runs when a test runs only a selection of the variants
};

extern const struct bits_variant bits_variants[];
extern const size_t bits_variant_count;

// Renders the scene as the variant specifies. With limits, it opens the same device again instead
// of using `gpu`.
bool bits_render(struct gpu *gpu, const struct scene *scene, const struct bits_variant *variant,
                 struct arena *arena, struct film_image *film, struct err *err);
bool bits_are_same(const struct film_image *a, const struct film_image *b);

#endif
