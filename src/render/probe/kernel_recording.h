// Runs a single kernel repeatedly on the input that it has in a real render: the state of a wave is
// saved just before the kernel runs, and restored before each repetition.
//
//   struct kernel_recording recorded = {0};
//   struct kernel_recording_params params = {
//     .kernel = KERNEL_intersect_closest, .depth = 1, .samples = 4};
//   kernel_recording_create(&r, &params, &recorded, &err)
//       && kernel_recording_run(&recorded, &ms, &err);
//   kernel_recording_finish(&recorded, &err);
#ifndef LAMPYRIS_RENDER_PROBE_KERNEL_RECORDING_H
#define LAMPYRIS_RENDER_PROBE_KERNEL_RECORDING_H

#include "render/render.h"
#include "render/wave.h"

struct kernel_recording_params {
    enum kernel_id kernel;
    // Number of bounces before the kernel; for intersect_shadow, before its rays were generated. It
    // is ignored for generate_rays, accumulate and resolve.
    uint32_t depth;
    uint64_t samples; // samples per pixel of the render; a wave takes the largest power of two up
                      // to 16
};

struct kernel_recording {
    struct renderer *renderer; // must outlive the recording
    struct wave wave;          // pixels from the middle of the image
    struct wave_step step;
    uint32_t launches; // number of shadow rays of a slot, each traced by a launch; 1 for other
                       // kernels
    uint64_t items;    // items of all launches; 0: no path gets that far, and nothing can be run
    uint64_t bytes;    // size of the saved state in device memory
    uint64_t hash;     // hash of the kernel's output in the render; the order of queues is ignored
    struct gpu_buffer kept[BINDING_COUNT]; // the buffers that the kernel writes
};

// Traces a wave up to the kernel. Fails with ERR_USAGE if the scene does not need the kernel, and
// with ERR_GPU if memory does not suffice to save the state, or traversals need several dispatches.
// Finish *out in any case.
bool kernel_recording_create(struct renderer *renderer,
                             const struct kernel_recording_params *params,
                             struct kernel_recording *out, struct err *err);
// Runs the kernel once. Nothing else may have run on the renderer since the recording, because
// buffers that the kernel only reads are not saved. *ms: time on the device, or by the host's clock
// if there are no timestamps. Fails with ERR_BUG if the output differs from that in the render.
bool kernel_recording_run(const struct kernel_recording *recorded, double *ms, struct err *err);
// Counts the traversal steps of the items, which must be rays: BVH nodes visited, and primitives
// tested. Compiles kernels that count, and afterwards again those that do not.
bool kernel_recording_count_steps(const struct kernel_recording *recorded, uint64_t *nodes,
                                  uint64_t *primitives, struct err *err);
// Releases the recording and leaves the renderer between two waves, as it was before. Accepts {0}.
bool kernel_recording_finish(struct kernel_recording *recorded, struct err *err);

#endif
