// The wavefront loop: one batch of paths from the camera to the film.
#ifndef LAMPYRIS_RENDER_WAVE_H
#define LAMPYRIS_RENDER_WAVE_H

#include "render/render.h"

struct wave_observer;

// pixel_count << sample_shift samples: at most plan.wave_samples.
struct wave {
    uint32_t film_chunk;
    uint64_t first_pixel; // of the image; with tiles this and first_sample are in lists instead
    uint32_t pixel_count;
    uint32_t sample_shift;
    uint64_t first_sample;
};

// *voided: some ray ran out of its budget without FEATURE_SUSPEND, and nothing reached the film.
// observer: see below; NULL: nobody looks.
bool wave_render(struct renderer *renderer, const struct wave *wave,
                 const struct wave_observer *observer, bool *voided, struct err *err);

// Creates the kernels that the renderer needs at present.
bool wave_create_kernels(struct renderer *renderer, struct err *err);
// The same, and compiles them by running each once on nothing, since drivers put that off until
// then.
bool wave_compile(struct renderer *renderer, struct err *err);
// SPIR-V instructions of a kernel as this specialization leaves them; 0 without memory to find out.
uint32_t wave_kernel_instructions(const struct renderer *renderer,
                                  const struct specialization *specialization, enum kernel_id id);
// Makes the kernels that trace count their steps from now on (render_stats.steps), or not: for
// measuring, since it takes time. Compiles.
bool wave_count_steps(struct renderer *renderer, bool on, struct err *err);

// --- step by step --------------------------------------------------------------------------------
// For replay.c, which follows one path, and kernel_recording.c, which repeats a kernel.

// A kernel at its place in the loop.
struct wave_step {
    enum kernel_id kernel;
    uint32_t bounce;
    uint32_t queue;     // that it consumes; of prepare_dispatch a mask; else 0
    uint32_t light_ray; // of intersect_shadow: which of a slot's
};
typedef bool (*wave_step_fn)(void *context, const struct wave_step *step, struct err *err);
struct wave_observer {
    // Called around each kernel with all that was before in memory, and the counters read back; may
    // be NULL. prepare_dispatch is watched where a bounce begins, and only before it. False ends
    // the wave.
    wave_step_fn before, after;
    void *context;
};
// wave_render without accumulation.
bool wave_trace_steps(struct renderer *renderer, const struct wave *wave,
                      const struct wave_observer *observer, struct err *err);
// Begins commands of their own, for wave_record_step.
bool wave_begin(struct renderer *renderer, const struct wave *wave, struct err *err);
// Records the kernel of a step, as the wave's loop does.
void wave_record_step(struct renderer *renderer, const struct wave *wave,
                      const struct wave_step *step);
// Leaves what a wave was in the middle of: empties all queues, counts from 0.
bool wave_clear_counters(struct renderer *renderer, struct err *err);

#endif
