// The wavefront loop: one batch of paths from the camera to the film.
#ifndef LAMPYRIS_RENDER_WAVE_H
#define LAMPYRIS_RENDER_WAVE_H

#include "render/render.h"

struct wave_observer;

// Renders a wave; goes on with it where it is the one that was begun ahead. Meanwhile begins `next`
// (NULL: none), for the next call: its first bounces run beside the last ones of the wave, which
// few paths reach. They must have no pixel in common, and no call without `next` renders another
// wave than that. *voided: some ray ran out of its budget without FEATURE_SUSPEND, and nothing
// reached the film. observer: see below; NULL: nobody looks. With one no wave may be begun ahead.
bool wave_render(struct renderer *renderer, const struct wave *wave, const struct wave *next,
                 const struct wave_observer *observer, bool *voided, struct err *err);
// Leaves the wave that was begun ahead, if there is one: to be called before the memory of waves is
// used in another way.
bool wave_forget_ahead(struct renderer *renderer, struct err *err);
// Exchanges the memory of the two waves that may be in flight: renderer->buffers and so on are the
// other one's then.
void wave_exchange(struct renderer *renderer);

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
    uint32_t queue;      // that it consumes; of prepare_dispatch a mask; else 0
    uint32_t light_ray;  // of intersect_shadow: which of a slot's
    uint32_t part_items; // of the queue, in one dispatch; 0: as the device takes now
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
// Returns how many shadow rays of a slot are traced, one after the other, at a bounce: those of the
// vertex before it.
uint32_t wave_shadow_launches(const struct renderer *renderer, uint32_t bounce);
// Runs the kernel of a step alone, on what is in memory, as the wave's loop does: of
// intersect_shadow for all shadow rays of a slot, and in as many submissions as a device that is
// watched takes. *ms: on the device, or by the host's clock where that has no timestamps.
bool wave_run_step(struct renderer *renderer, const struct wave *wave, const struct wave_step *step,
                   double *ms, struct err *err);
// Leaves what a wave was in the middle of: empties all queues, counts from 0.
bool wave_clear_counters(struct renderer *renderer, struct err *err);

#endif
