// Variations that must not change one bit of an image: the size of the waves, how samples are split
// over calls, features that the scene lacks, the ways to read and to reserve memory, and lower
// limits of the device (docs/verification.md, G1, G2 and G3).
#ifndef LAMPYRIS_CHECK_BITS_H
#define LAMPYRIS_CHECK_BITS_H

#include "check/check.h"

#define BITS_SAMPLES 32u

struct bits_variant {
    const char *name;
    struct gpu_limit_overrides limits;
    bool from_storage; // the scene is read from storage buffers, of which few devices bind enough
    uint32_t wave;
    bool compile_all;
    uint32_t first_calls[2]; // samples of the first calls; the last call renders the rest of
                             // BITS_SAMPLES
    bool restarted;          // samples of another seed were rendered before
    bool representative;     // is among those that are run when not all are
};

extern const struct bits_variant bits_variants[];
extern const size_t bits_variant_count;

// Renders the scene as the variant says: on `gpu` or, with limits, on the same device opened again.
bool bits_render(struct gpu *gpu, const struct scene *scene, const struct bits_variant *variant,
                 struct arena *arena, struct film_image *film, struct err *err);
bool bits_are_same(const struct film_image *a, const struct film_image *b);

#endif
