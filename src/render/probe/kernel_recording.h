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
    // Number of bounces before the kernel; for intersect_shadow, before its rays were sent. Ignored
    // for generate_rays, accumulate and resolve.
    uint32_t depth;
    uint64_t samples; // a pixel, in the render; a wave takes the largest power of two up to 16
};

struct kernel_recording {
    struct renderer *renderer; // must outlive it
    struct wave wave;          // in the middle of the picture
    struct wave_step step;
    uint32_t launches; // number of shadow rays of a slot; else 1
    uint64_t items;    // in all launches; 0: no path gets that far, and nothing can be run
    uint64_t bytes;    // size of the kept state on the device
    uint64_t hash;     // hash of the output in the render itself, without the order of queues
    struct gpu_buffer kept[BINDING_COUNT]; // the buffers that the kernel writes
};

// Traces a wave up to the kernel. ERR_USAGE if the scene does not need the kernel; ERR_GPU if there
// is no memory to keep the state, or traversals need several dispatches. Finish *out in any case.
bool kernel_recording_create(struct renderer *renderer,
                             const struct kernel_recording_params *params,
                             struct kernel_recording *out, struct err *err);
// Runs the kernel once. Nothing else may have run on the renderer since the recording, because
// buffers that the kernel only reads are not kept. *ms: time on the device, or by the host's clock
// if there are no timestamps. ERR_BUG if the output differs from that of the render.
bool kernel_recording_run(const struct kernel_recording *recorded, double *ms, struct err *err);
// Counts the steps of the items, which are rays: the nodes of the BVH that they visit, and the
// primitives that they test. Compiles kernels that count, and afterwards those that do not.
bool kernel_recording_count_steps(const struct kernel_recording *recorded, uint64_t *nodes,
                                  uint64_t *primitives, struct err *err);
// Releases the recording and leaves the renderer as it was, between two waves. Accepts {0}.
bool kernel_recording_finish(struct kernel_recording *recorded, struct err *err);

#endif
