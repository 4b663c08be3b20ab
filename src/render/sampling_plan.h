// What samplers and half-buffers need to know beforehand: how many samples there will be.
#ifndef LAMPYRIS_RENDER_SAMPLING_PLAN_H
#define LAMPYRIS_RENDER_SAMPLING_PLAN_H

#include "render.h"

// Settles renderer->frame.samples and the half-buffers, after frame_fill() and before anything is
// compiled or uploaded. open_ended: how many samples a pixel gets is not known. Warns where that,
// or their number, keeps the sampler from being what was asked for.
void sampling_plan(struct renderer *renderer, bool open_ended);
// Warns once when more samples are taken than were planned, and that matters.
void sampling_plan_check(struct renderer *renderer, uint64_t samples);

#endif
