// Implements the wavefront loop, which traces one batch of paths from the camera and adds them to
// the film.
#ifndef LAMPYRIS_RENDER_WAVE_H
#define LAMPYRIS_RENDER_WAVE_H

#include "render/render.h"

struct wave_observer;

// Renders a wave, or finishes it if it was begun ahead. Meanwhile it begins `next` (NULL: none):
// the first bounces of that wave run at the same time as the last bounces of this one, which have
// few paths. The two waves must have no pixel in common, and the next call must render `next`.
// *voided: some ray exceeded its iteration budget without FEATURE_SUSPEND, and nothing was added to
// the film. observer: see below; NULL: none. With an observer no wave may be begun ahead.
bool wave_render(struct renderer *renderer, const struct wave *wave, const struct wave *next,
                 const struct wave_observer *observer, bool *voided, struct err *err);
// Abandons the wave that was begun ahead, if there is one. Call it before the memory of waves is
// used in another way.
bool wave_forget_ahead(struct renderer *renderer, struct err *err);
// Exchanges the memory of the two waves that may be in flight: renderer->buffers and other members
// then belong to the other wave.
void wave_exchange(struct renderer *renderer);

// Creates the kernels that the renderer currently needs.
bool wave_create_kernels(struct renderer *renderer, struct err *err);
// Creates the kernels, and runs each one without work, because drivers may postpone compilation
// until the first run.
bool wave_compile(struct renderer *renderer, struct err *err);
// Returns the number of SPIR-V instructions of a kernel after specialization; 0 when out of memory.
uint32_t wave_kernel_instructions(const struct renderer *renderer,
                                  const struct specialization *specialization, enum kernel_id id);
// Sets whether the traversal kernels count their steps (render_stats.steps), and recompiles them.
// Counting takes time, so only measurements use it.
bool wave_count_steps(struct renderer *renderer, bool on, struct err *err);

// --- step by step --------------------------------------------------------------------------------
// The following declarations are for replay.c, which follows one path, and for kernel_recording.c,
// which repeats a kernel.

// A kernel, and its position in the wavefront loop.
struct wave_step {
    enum kernel_id kernel;
    uint32_t bounce;
    uint32_t queue;      // queue that the kernel processes; for prepare_dispatch a mask of queues;
                         // else 0
    uint32_t light_ray;  // for intersect_shadow: index of the shadow ray in its slot
    uint32_t part_items; // items of one dispatch; 0: as many as the device currently permits
};
typedef bool (*wave_step_fn)(void *context, const struct wave_step *step, struct err *err);
struct wave_observer {
    // The loop calls these functions before and after each kernel; they may be NULL. All earlier
    // results are then in memory, and the counters were read back. For prepare_dispatch only
    // `before` is called, at the beginning of a bounce. If a callback returns false, the wave ends.
    wave_step_fn before, after;
    void *context;
};
// Renders a wave as wave_render() does, but does not add it to the film.
bool wave_trace_steps(struct renderer *renderer, const struct wave *wave,
                      const struct wave_observer *observer, struct err *err);
// Returns the number of shadow rays that are traced for a slot at a bounce, one after the other:
// those of the preceding vertex.
uint32_t wave_shadow_launches(const struct renderer *renderer, uint32_t bounce);
// Runs one kernel alone, as the wavefront loop does, on the current contents of memory:
// intersect_shadow for all shadow rays of a slot, and in as many submissions as a device with a
// watchdog needs. *ms: time on the device, or by the host's clock if there are no timestamps.
bool wave_run_step(struct renderer *renderer, const struct wave *wave, const struct wave_step *step,
                   double *ms, struct err *err);
// Abandons an unfinished wave: empties all queues and sets the counters to 0.
bool wave_clear_counters(struct renderer *renderer, struct err *err);

#endif
