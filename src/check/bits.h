// What must not change one bit of a picture: the size of the waves, how samples are split over
// calls, features that the scene lacks, ways to read and to reserve, and lower limits of the device
// (docs/verification.md, G1, G2 and G3).
#ifndef LAMPYRIS_CHECK_BITS_H
#define LAMPYRIS_CHECK_BITS_H

#include "check/check.h"

#define BITS_SAMPLES 32u

struct bits_variant {
    const char *name;
    struct gpu_limit_overrides limits;
    bool
        from_storage; // scenes are read from storage buffers, which few devices cannot bind at once
    uint32_t wave;
    bool compile_all;
    uint32_t first_calls[2]; // samples of the first calls; the last one makes up BITS_SAMPLES
    bool restarted;          // after other samples of another seed
    bool representative;     // of all of them, where not all are tried
};

extern const struct bits_variant bits_variants[];
extern const size_t bits_variant_count;

// The scene's picture as the variant makes it: on `gpu` or, with limits, on another opening of the
// same device.
bool bits_render(struct gpu *gpu, const struct scene *scene, const struct bits_variant *variant,
                 struct arena *arena, struct film_image *film, struct err *err);
bool bits_are_same(const struct film_image *a, const struct film_image *b);

#endif
