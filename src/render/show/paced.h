// Records and submits kernels that do not belong to a wave, one after the other, in as many
// submissions as the device needs: see render/pace.h.
#ifndef LAMPYRIS_RENDER_SHOW_PACED_H
#define LAMPYRIS_RENDER_SHOW_PACED_H

#include "render/pace.h"

struct paced_mark {
    uint32_t kernel, items; // the dispatch that ends at a timestamp
};

struct paced {
    struct gpu *gpu;
    struct gpu_commands commands;
    struct pace pace;
    struct paced_mark marks[GPU_MAX_TIMESTAMPS]; // marks of the current submission
    uint32_t mark_count;
    double ns[PACE_KERNELS]; // time of each kernel since paced_begin(); 0 without timestamps
};

// A dispatch that may be divided into several dispatches of fewer workgroups.
struct paced_work {
    uint32_t number; // number of the kernel, below PACE_KERNELS
    const struct gpu_kernel *kernel;
    struct gpu_bindings *bindings;
    void *push;
    uint32_t push_bytes;
    uint32_t *first; // set to the index of the part's first workgroup, times first_unit
    uint32_t first_unit;
    uint64_t groups;
    uint32_t workgroup;
};

bool paced_create(struct gpu *gpu, struct paced *out, struct err *err);
void paced_finish(struct paced *paced); // accepts {0}
bool paced_begin(struct paced *paced, struct err *err);
// Records the dispatch and a barrier. If the submission would become too long, first submits the
// commands recorded so far, and waits.
bool paced_dispatch(struct paced *paced, const struct paced_work *work, struct err *err);
// Submits and waits.
bool paced_end(struct paced *paced, struct err *err);

#endif
