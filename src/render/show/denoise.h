// A preview of the picture without noise: the spatial filter of SVGF with variance and its temporal
// reprojection (Schied et al. 2017, "Spatiotemporal Variance-Guided Filtering"). It biases; what is
// saved is the film. docs/denoising.md says what it does.
#ifndef LAMPYRIS_RENDER_SHOW_DENOISE_H
#define LAMPYRIS_RENDER_SHOW_DENOISE_H

#include "render/render.h"

// What a renderer has to have been created with.
#define DENOISE_AOVS (AOV_ALBEDO | AOV_NORMAL | AOV_DEPTH | AOV_ALPHA | AOV_EMISSION | AOV_IDS)

enum denoise_pass {
    DENOISE_PASS_gather,
    DENOISE_PASS_blend,
    DENOISE_PASS_variance,
    DENOISE_PASS_wavelet, // all levels
    DENOISE_PASS_finish,
    DENOISE_PASS_COUNT
};

struct denoiser {
    struct gpu *gpu;
    struct gpu_buffer picture; // vec4 a pixel: linear radiance, samples of the film; width * height
                               // of them, and room for more. Made anew where the picture grows
    uint32_t width, height;
    bool has_history;
    double ms; // of the last call on the device
    double pass_ms[DENOISE_PASS_COUNT];
    struct denoiser_state *own;
};

// An object that is elsewhere than in the history, by the numbers that the flat scene of now has
// for what it is made of.
struct denoise_motion {
    uint32_t first_primitive, primitive_count; // shapes with PRIMITIVE_SHAPE
    uint32_t instance;                         // NO_INSTANCE: they are in the world itself
    double to_past[3][4]; // from where a point of it is to where that was, in the world
};

struct denoise_call {
    const struct renderer *renderer; // between two calls of renderer_render
    const struct camera *camera;     // of its film
    uint32_t iterations;             // of the wavelet, 1 to 5; 0: 5
    bool temporal; // take the history along where the camera moved; else the film alone
    // The scene is another than the history's: that counts only where its light is still what the
    // film has. Objects that moved since take it along; at most DENOISE_MOTIONS_MAX.
    bool has_changed;
    const struct denoise_motion *motions;
    uint32_t motion_count;
};

bool denoiser_create(struct gpu *gpu, struct denoiser *out, struct err *err);
void denoiser_finish(struct denoiser *denoiser); // accepts NULL and {0}
// Makes the picture from the film as it is; waits. To be called for every frame that is shown.
// Pixels without samples are black.
bool denoiser_run(struct denoiser *denoiser, const struct denoise_call *call, struct err *err);
// To be called before the film is emptied for another view: what it has becomes history. A film
// without samples leaves the history as it is.
bool denoiser_keep(struct denoiser *denoiser, const struct denoise_call *call, struct err *err);
// After a change of the scene: what was before says nothing any more.
void denoiser_forget(struct denoiser *denoiser);

#endif
