// Tells samplers and half-buffers how many samples there will be.
#ifndef LAMPYRIS_RENDER_SAMPLING_PLAN_H
#define LAMPYRIS_RENDER_SAMPLING_PLAN_H

#include "render/render.h"

// How the samples of a method depend on the planned number of samples a pixel.
enum sample_planning {
    PLANNING_NONE,     // not at all: the first samples are the same however many follow
    PLANNING_OPTIONAL, // a known number divides the sequence among pixels; it works without one
    PLANNING_NEEDED,   // strata and contiguous halves are made for the number; without one,
                       // samples and halves are independent
};

// Returns how the settings depend on the number of samples; the only place that knows. *option is
// set to the deciding setting as an option of the command line ("--sampler grid"), or to NULL with
// PLANNING_NONE; `option` may be NULL.
enum sample_planning sample_planning(const struct settings *settings, const char **option);

// Returns whether each half-buffer has one half of a sequence: the difference of the halves is then
// an upper bound on the error.
bool halves_are_contiguous(const struct renderer *renderer);

// Sets renderer->frame.samples and the half-buffers; call it after frame_fill() and before anything
// is compiled or uploaded. open_ended: the number of samples a pixel is not known. Warns if that,
// or the number itself, keeps the sampler from stratifying as asked.
void sampling_plan(struct renderer *renderer, bool open_ended);
// Warns once if more samples are taken than were planned and the sampler depends on it.
void sampling_plan_check(struct renderer *renderer, uint64_t samples);

#endif
