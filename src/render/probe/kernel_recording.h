// One kernel alone, on what it gets in a real render: the state of a wave is kept just before the
// kernel, and put back before each run of it.
//
//   struct kernel_recording recorded = {0};
//   kernel_recording_create(&r, &(struct kernel_recording_params){.kernel =
//   KERNEL_intersect_closest, .depth = 1,
//                                                 .samples = 4}, &recorded, &err)
//       && kernel_recording_run(&recorded, &ms, &err);
//   kernel_recording_finish(&recorded, &err);
#ifndef LAMPYRIS_RENDER_PROBE_KERNEL_RECORDING_H
#define LAMPYRIS_RENDER_PROBE_KERNEL_RECORDING_H

#include "render/render.h"
#include "render/wave.h"

struct kernel_recording_params {
    enum kernel_id kernel;
    // Bounces that the paths have behind them; of intersect_shadow, when the rays were sent. Does
    // not matter for generate_rays, accumulate and resolve.
    uint32_t depth;
    uint64_t samples; // a pixel, of the render; a wave takes the largest power of two up to 16
};

struct kernel_recording {
    struct renderer *renderer; // must outlive it
    struct wave wave;          // in the middle of the picture
    struct wave_step step;
    uint32_t launches; // shadow rays of a slot; else 1
    uint64_t items;    // of all launches; 0: nothing comes so far, and nothing can be run
    uint64_t bytes;    // that keeping the state takes on the device
    uint64_t hash;     // of what the render itself left behind, without the order of queues
    struct gpu_buffer kept[BINDING_COUNT]; // what the kernel writes
};

// Traces a wave up to the kernel. ERR_USAGE where the scene left the kernel out; ERR_GPU where
// there is no memory to keep the state, or traversals need several dispatches. *out is to be
// finished in any case.
bool kernel_recording_create(struct renderer *renderer,
                             const struct kernel_recording_params *params,
                             struct kernel_recording *out, struct err *err);
// Runs the kernel once; nothing else may have run on the renderer since, for what the kernel only
// reads is not kept. *ms: on the device, or by the host's clock where that has no timestamps.
// ERR_BUG when it leaves behind anything else than the render did.
bool kernel_recording_run(const struct kernel_recording *recorded, double *ms, struct err *err);
// Counts what the items, which are rays, do: the nodes of the BVH that they visit, and the
// primitives that they test. Compiles kernels that count, and the others again.
bool kernel_recording_count_steps(const struct kernel_recording *recorded, uint64_t *nodes,
                                  uint64_t *primitives, struct err *err);
// Releases it, and leaves the renderer as it was: between two waves. Accepts {0}.
bool kernel_recording_finish(struct kernel_recording *recorded, struct err *err);

#endif
