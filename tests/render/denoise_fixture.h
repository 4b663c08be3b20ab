// Helpers for the denoiser's tests: invented films, and their denoised pictures.
#ifndef LAMPYRIS_TESTS_DENOISE_FIXTURE_H
#define LAMPYRIS_TESTS_DENOISE_FIXTURE_H

#include "render/show/denoise.h"
#include "render_fixture.h"

// A pixel of a film, given by its means over samples.
struct made_pixel {
    uint32_t samples; // 0: the other members have no effect
    float light[3];   // reflected light, without the albedo
    float apart[3];   // half of the difference between the light of the two halves
    float albedo[3], emission[3], normal[3];
    float depth, alpha; // alpha 0: no surface
    uint32_t primitive; // number of the primitive plus 1
};

typedef struct made_pixel make_pixel(const void *context, uint32_t x, uint32_t y);

struct made_film {
    struct gpu *gpu;
    struct scene scene;
    struct renderer renderer; // its film is overwritten
    uint32_t width, height;
    float (*picture)[4]; // picture of the last film_denoise()
};

bool film_open(struct gpu *gpu, uint32_t width, uint32_t height, struct made_film *out,
               struct err *err);
void film_close(struct made_film *film);
bool film_make(struct made_film *film, make_pixel *make, const void *context, struct err *err);
bool film_denoise(struct made_film *film, struct denoiser *denoiser,
                  const struct denoise_call *call, struct err *err);

#endif
