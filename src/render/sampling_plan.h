// Passes the planned number of samples to samplers and half-buffers.
#ifndef LAMPYRIS_RENDER_SAMPLING_PLAN_H
#define LAMPYRIS_RENDER_SAMPLING_PLAN_H

#include "render/render.h"

// Ways in which the samples of a method depend on the planned number of samples per pixel.
enum sample_planning {
    PLANNING_NONE,     // the first samples are the same however many follow
    PLANNING_OPTIONAL, // a known number divides the sequence among pixels, but is not required
    PLANNING_NEEDED,   // strata and contiguous halves are laid out for the number; if it is
                       // unknown, samples and halves are independent
};

// Returns how the settings depend on the number of samples; no other code decides this. *option
// becomes the setting that is responsible, as an option of the command line ("--sampler grid"), or
// NULL with PLANNING_NONE. `option` may be NULL.
enum sample_planning sample_planning(const struct settings *settings, const char **option);

// Returns whether each half-buffer contains a contiguous half of a sequence. The difference of the
// halves is then an upper bound on the error.
bool halves_are_contiguous(const struct renderer *renderer);

// Sets renderer->frame.samples and the members for half-buffers. Call it after frame_fill() and
// before anything is compiled or uploaded. open_ended: the number of samples per pixel is not known
// in advance. Warns if the sampler cannot stratify as requested, because the number is unknown or
// too large.
void sampling_plan(struct renderer *renderer, bool open_ended);
// Warns once if more samples are taken than were planned and the settings depend on the planned
// number.
void sampling_plan_check(struct renderer *renderer, uint64_t samples);

#endif
