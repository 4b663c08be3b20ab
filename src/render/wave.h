// The wavefront loop: one batch of paths from the camera to the film.
#ifndef LAMPYRIS_RENDER_WAVE_H
#define LAMPYRIS_RENDER_WAVE_H

#include "render/render.h"

struct wave_observer;

// Renders a wave, or finishes it if it was begun ahead. Meanwhile begins `next` (NULL: none) for
// the next call: its first bounces run beside the last bounces of this wave, which few paths reach.
// The two waves must have no pixel in common, and the next call must render `next`. *voided: some
// ray ran out of its budget without FEATURE_SUSPEND, and nothing reached the film. observer: see
// below; NULL: none. With an observer no wave may be begun ahead.
bool wave_render(struct renderer *renderer, const struct wave *wave, const struct wave *next,
                 const struct wave_observer *observer, bool *voided, struct err *err);
// Abandons the wave that was begun ahead, if there is one; call it before the memory of waves is
// used otherwise.
bool wave_forget_ahead(struct renderer *renderer, struct err *err);
// Exchanges the memory of the two waves that may be in flight: renderer->buffers and the other
// members are then those of the other wave.
void wave_exchange(struct renderer *renderer);

// Creates the kernels that the renderer needs at present.
bool wave_create_kernels(struct renderer *renderer, struct err *err);
// Creates the kernels and compiles them by running each once without work, since drivers postpone
// compiling until then.
bool wave_compile(struct renderer *renderer, struct err *err);
// Returns the SPIR-V instructions of a kernel after specialization; 0 when out of memory.
uint32_t wave_kernel_instructions(const struct renderer *renderer,
                                  const struct specialization *specialization, enum kernel_id id);
// Makes the traversal kernels count their steps (render_stats.steps), or not. Counting takes time,
// so only measurements use it. Recompiles those kernels.
bool wave_count_steps(struct renderer *renderer, bool on, struct err *err);

// --- step by step --------------------------------------------------------------------------------
// These are for replay.c, which follows one path, and kernel_recording.c, which repeats a kernel.

// A kernel at its position in the loop.
struct wave_step {
    enum kernel_id kernel;
    uint32_t bounce;
    uint32_t queue;      // the queue that it consumes; for prepare_dispatch a mask; else 0
    uint32_t light_ray;  // for intersect_shadow: the number of the shadow ray in its slot
    uint32_t part_items; // items of one dispatch; 0: as many as the device takes at present
};
typedef bool (*wave_step_fn)(void *context, const struct wave_step *step, struct err *err);
struct wave_observer {
    // Called before and after each kernel, when all earlier results are in memory and the counters
    // were read back; may be NULL. For prepare_dispatch only `before` is called, at the beginning
    // of a bounce. If a callback returns false, the wave ends.
    wave_step_fn before, after;
    void *context;
};
// Renders a wave as wave_render() does, but without accumulation.
bool wave_trace_steps(struct renderer *renderer, const struct wave *wave,
                      const struct wave_observer *observer, struct err *err);
// Returns how many shadow rays of a slot are traced, one after the other, at a bounce: those of the
// preceding vertex.
uint32_t wave_shadow_launches(const struct renderer *renderer, uint32_t bounce);
// Runs the kernel of a step alone on the present contents of memory, as the wave's loop does:
// intersect_shadow for all shadow rays of a slot, and in as many submissions as a device with a
// watchdog needs. *ms: time on the device, or by the host's clock if there are no timestamps.
bool wave_run_step(struct renderer *renderer, const struct wave *wave, const struct wave_step *step,
                   double *ms, struct err *err);
// Abandons an unfinished wave: empties all queues and sets the counters to 0.
bool wave_clear_counters(struct renderer *renderer, struct err *err);

#endif
