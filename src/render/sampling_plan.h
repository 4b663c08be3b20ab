// Tells samplers and half-buffers what they need to know beforehand: how many samples there will
// be.
#ifndef LAMPYRIS_RENDER_SAMPLING_PLAN_H
#define LAMPYRIS_RENDER_SAMPLING_PLAN_H

#include "render/render.h"

// How a method's samples depend on the number of samples a pixel that is planned.
enum sample_planning {
    PLANNING_NONE,     // they do not: the first ones are the same however many follow
    PLANNING_OPTIONAL, // a known number shares the sequence out between pixels; works without one
    PLANNING_NEEDED,   // strata and contiguous halves are made for the number; without one, samples
                       // and halves are independent
};

// The one place that knows this of the settings. *option is set to the setting that decides, as an
// option of the command line ("--sampler grid"), or to NULL with PLANNING_NONE; `option` may be
// NULL.
enum sample_planning sample_planning(const struct settings *settings, const char **option);

// Returns whether each half-buffer has half of one sequence: their difference then bounds the
// error.
bool halves_are_contiguous(const struct renderer *renderer);

// Settles renderer->frame.samples and the half-buffers, after frame_fill() and before anything is
// compiled or uploaded. open_ended: how many samples a pixel gets is not known. Warns where that,
// or their number, keeps the sampler from being what was asked for.
void sampling_plan(struct renderer *renderer, bool open_ended);
// Warns once when more samples are taken than were planned, and that matters.
void sampling_plan_check(struct renderer *renderer, uint64_t samples);

#endif
