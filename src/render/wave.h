// The wavefront loop: one batch of paths from the camera to the film.
#ifndef LAMPYRIS_RENDER_WAVE_H
#define LAMPYRIS_RENDER_WAVE_H

#include "render.h"

// pixel_count << sample_shift paths: at most plan.wave_slots.
struct wave {
    uint32_t film_chunk;
    uint64_t first_pixel; // of the image; with tiles this and first_sample are in lists instead
    uint32_t pixel_count;
    uint32_t sample_shift;
    uint64_t first_sample;
};

// *voided: some ray ran out of its budget without FEATURE_SUSPEND, and nothing reached the film.
bool wave_render(struct renderer *renderer, const struct wave *wave, bool *voided, struct err *err);

// Creates the kernels that the renderer needs at present; compiles them by running each once on
// nothing, since drivers put that off until then.
bool wave_compile(struct renderer *renderer, struct err *err);

// --- for replay.c, which follows one path step by step
// --------------------------------------------
typedef bool (*wave_step_fn)(void *context, enum kernel_id kernel, uint32_t bounce,
                             struct err *err);
// wave_render without accumulation, calling `step` after each kernel with its results in memory.
bool wave_trace_steps(struct renderer *renderer, const struct wave *wave, wave_step_fn step,
                      void *context, struct err *err);

#endif
