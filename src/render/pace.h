// Limits how much work is submitted at a time to a device with a watchdog. A driver resets a GPU,
// which may also drive a display, if its work does not end within seconds (Windows: two). So
// dispatches and submissions are short: their sizes begin small, and are adapted to the measured
// times. The image does not depend on these sizes. CPU drivers have no watchdog.
#ifndef LAMPYRIS_RENDER_PACE_H
#define LAMPYRIS_RENDER_PACE_H

#include "render/kernels.h"
#include "render/memory_plan.h"

// Target durations in nanoseconds. They are a tenth of the dangerous duration or less, because the
// next dispatch may take several times as long as the previous ones; and they are long compared
// with the microseconds that a submission costs.
#define PACE_DISPATCH_NS 5e7
#define PACE_SUBMISSION_NS 2e8

// Kernels are numbered by enum kernel_id, or by the caller's own numbers for a separate pace.
#define PACE_KERNELS KERNEL_COUNT

struct pace {
    bool is_on;
    uint32_t samples;             // maximum samples of a wave
    uint32_t part_items;          // maximum items of a dispatch; may change at the beginning of
                                  // each bounce
    double ns[PACE_KERNELS];      // time of one item in nanoseconds; 0: not known
    double wave_ns[PACE_KERNELS]; // the longest such time in this wave
    double recorded_ns; // the expected time of everything recorded since the last submission
};

// Sets the initial limits; call it again when the size of waves or the kernels change.
void pace_begin(struct pace *pace, const struct gpu *gpu, const struct memory_plan *plan);
// Sets the initial limits of a pace for kernels that do not belong to waves.
void pace_begin_others(struct pace *pace, const struct gpu *gpu);
// Returns the number of samples that the next wave may have.
uint32_t pace_samples(const struct pace *pace, const struct memory_plan *plan);
// Chooses the number of items of a dispatch for a wave of `slots` slots. No dispatch may have been
// prepared by prepare_dispatch when it is called.
void pace_choose_part(struct pace *pace, const struct memory_plan *plan, uint32_t workgroup,
                      uint32_t slots);
// Returns whether `items` more items of a kernel fit into the current submission; if so, adds them
// to it.
bool pace_takes(struct pace *pace, uint32_t kernel, uint32_t items);
// Returns the number of items, at most `most`, that can be submitted in one submission of their
// own.
uint32_t pace_items(const struct pace *pace, uint32_t kernel, uint32_t most);
// Records that `items` items took `ns` nanoseconds.
void pace_learn(struct pace *pace, uint32_t kernel, uint32_t items, double ns);
// Ends a round of kernels outside of waves; longer times of earlier rounds count half from then on.
void pace_end_round(struct pace *pace);
// Ends a wave and adapts the size of the next one.
void pace_end_wave(struct pace *pace, const struct memory_plan *plan);

#endif
