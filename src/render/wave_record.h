// Records kernels of waves into command buffers, submits these, and attributes the measured time to
// kernels and bounces. Submissions are limited to a duration if the renderer paces itself (pace.h).
#ifndef LAMPYRIS_RENDER_WAVE_RECORD_H
#define LAMPYRIS_RENDER_WAVE_RECORD_H

#include "render/wave.h"

// The state of the loop over the bounces of a wave.
struct wave_loop {
    struct renderer *r;
    const struct wave *wave;
    const struct wave_observer *observer; // NULL: kernels are not observed, and are submitted
                                          // together
    bool is_paced;
    bool is_timed;       // gives every part a timestamp of its own
    uint32_t part_items; // items of a queue or a list that one dispatch processes
    bool is_light;       // the paths are light paths
    uint32_t bounce;     // the next bounce to record
    uint32_t last;       // the last possible bounce of paths
};

// Begins a submission.
bool record_begin(struct renderer *r, const struct wave *wave, struct err *err);
// Submits the recorded commands, waits for them and reads the counters and times.
bool record_run(struct renderer *r, struct err *err);

// Makes the writes of earlier kernels visible to later ones. Kernels between two barriers may run
// at the same time; docs/architecture.md, "Kernels side by side", explains why that is correct.
void record_barrier(struct renderer *r);
void record_dispatch(struct renderer *r, enum kernel_id kernel, uint32_t groups, uint32_t items);
// Records a kernel over `items` items, in parts. work: the number of items of other kernels that
// take as long as one item of this kernel.
bool record_items(struct wave_loop *l, enum kernel_id kernel, uint32_t items, uint32_t work,
                  struct err *err);
// Records a kernel over a queue whose length only the device knows, in as many parts as it may
// need, without a barrier after it. Synchronization validation assumes that a kernel reads and
// writes every buffer that is bound to it; with that layer no two dispatches run at the same time.
bool record_queue(struct wave_loop *l, enum kernel_id kernel, uint32_t queue, struct err *err);
// Records the kernel that computes the indirect dispatches of the queues in a mask.
bool record_prepare(struct wave_loop *l, uint32_t queue_mask, struct err *err);
// Records the single workgroup of a sort: see lib/sort.glsl.
bool record_scan(struct wave_loop *l, uint32_t queue, struct err *err);

#endif
