// How much work a device that somebody watches is given at a time. GPUs show pictures, too, and a
// driver takes one for hung whose work does not end within seconds (Windows: two). So dispatches
// and submissions are kept short: they begin small, and grow and shrink by what they were measured
// to take. The picture does not depend on that. Drivers on the processor are not watched.
#ifndef LAMPYRIS_RENDER_PACE_H
#define LAMPYRIS_RENDER_PACE_H

#include "render/kernels.h"
#include "render/memory_plan.h"

// A tenth of what is dangerous, since what comes next may take several times as long as what was
// measured; and long against the microseconds that a submission costs.
#define PACE_DISPATCH_NS 5e7
#define PACE_SUBMISSION_NS 2e8

// Kernels by number: enum kernel_id, or the numbers of somebody else who has a pace of his own.
#define PACE_KERNELS KERNEL_COUNT

struct pace {
    bool is_on;
    uint32_t samples;             // a wave has at most
    uint32_t part_items;          // a dispatch has at most, from the last bounce's beginning on
    double ns[PACE_KERNELS];      // that an item takes; 0: not known
    double wave_ns[PACE_KERNELS]; // the most of this wave
    double recorded_ns;           // what was recorded since the last submission will take
};

// To begin with; of waves of other sizes and other kernels, too.
void pace_begin(struct pace *pace, const struct gpu *gpu, const struct memory_plan *plan);
// The same for kernels that are not a wave's.
void pace_begin_others(struct pace *pace, const struct gpu *gpu);
// Samples that the next wave may have.
uint32_t pace_samples(const struct pace *pace, const struct memory_plan *plan);
// Chooses how many items of a wave of so many slots a dispatch may have, now that none is prepared.
void pace_choose_part(struct pace *pace, const struct memory_plan *plan, uint32_t workgroup,
                      uint32_t slots);
// Whether so many items more of a kernel go into the same submission, and are counted to it then.
bool pace_takes(struct pace *pace, uint32_t kernel, uint32_t items);
// Items that can be submitted alone, at most `most`.
uint32_t pace_items(const struct pace *pace, uint32_t kernel, uint32_t most);
// So many items took so long.
void pace_learn(struct pace *pace, uint32_t kernel, uint32_t items, double ns);
// A round of such kernels is over: what was slow in rounds before counts less.
void pace_end_round(struct pace *pace);
// The wave is over: the next may be larger, or has to be smaller.
void pace_end_wave(struct pace *pace, const struct memory_plan *plan);

#endif
