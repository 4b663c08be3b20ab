// Makes a preview of the image without noise, by the spatial filter of SVGF with its variance
// estimate and temporal reprojection (Schied et al. 2017, "Spatiotemporal Variance-Guided
// Filtering"). The preview is biased; saved files contain the unfiltered film. See
// docs/denoising.md.
#ifndef LAMPYRIS_RENDER_SHOW_DENOISE_H
#define LAMPYRIS_RENDER_SHOW_DENOISE_H

#include "render/render.h"

// The AOVs that the renderer must have been created with.
#define DENOISE_AOVS (AOV_ALBEDO | AOV_NORMAL | AOV_DEPTH | AOV_ALPHA | AOV_EMISSION | AOV_IDS)

enum denoise_pass {
    DENOISE_PASS_gather,
    DENOISE_PASS_blend,
    DENOISE_PASS_variance,
    DENOISE_PASS_wavelet, // all levels of the wavelet filter
    DENOISE_PASS_finish,
    DENOISE_PASS_COUNT
};

struct denoiser {
    struct gpu *gpu;
    struct gpu_buffer picture; // a vec4 per pixel: linear radiance, and the film's sample count;
                               // width * height pixels, with room for more. The buffer is recreated
                               // if the image grows
    uint32_t width, height;
    bool has_history;
    double ms; // time of the last call on the device, in milliseconds
    double pass_ms[DENOISE_PASS_COUNT];
    struct denoiser_state *own;
};

// An object that has moved since the history was made, identified by its primitives and instance in
// the current flat scene.
struct denoise_motion {
    uint32_t first_primitive, primitive_count; // for shapes, first_primitive includes
                                               // PRIMITIVE_SHAPE
    uint32_t instance;                         // NO_INSTANCE: the primitives are in world space
    double to_past[3][4]; // maps the object's points to their former positions, in world space
};

struct denoise_call {
    const struct renderer *renderer; // must be between two calls of renderer_render
    const struct camera *camera;     // the film's camera
    uint32_t iterations;             // levels of the wavelet filter, 1 to 5; 0: 5
    bool temporal; // reprojects the history if the camera moved; false: uses the film alone
    // The scene has changed since the history was made. The history then only counts in pixels in
    // which its light still agrees with that of the film. `motions` lists the objects that have
    // moved, at most DENOISE_MOTIONS_MAX; their history moves with them.
    bool has_changed;
    const struct denoise_motion *motions;
    uint32_t motion_count;
};

bool denoiser_create(struct gpu *gpu, struct denoiser *out, struct err *err);
void denoiser_finish(struct denoiser *denoiser); // accepts NULL and {0}
// Makes the denoised image from the film's current state, and waits for it. Call it for every frame
// that is shown. Pixels without samples are black.
bool denoiser_run(struct denoiser *denoiser, const struct denoise_call *call, struct err *err);
// Makes the current film's view the history. Call it before the film is emptied for another view. A
// film without samples leaves the history unchanged.
bool denoiser_keep(struct denoiser *denoiser, const struct denoise_call *call, struct err *err);
// Discards the history, after a change of the scene that makes it invalid.
void denoiser_forget(struct denoiser *denoiser);

#endif
