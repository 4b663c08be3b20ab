// Progress display for work that takes longer than a frame.
#ifndef LAMPYRIS_VIEWER_CORE_LONG_WORK_H
#define LAMPYRIS_VIEWER_CORE_LONG_WORK_H

#include "base/progress.h"

struct viewer;

struct progress viewer_progress(struct viewer *viewer); // for work between frames
bool viewer_is_ending(const struct viewer *viewer);     // it was closed, or a signal arrived
// Draws a frame with a progress bar during long work; at most ten per second.
void viewer_show_progress(struct viewer *viewer, const char *phase, double fraction);

#endif
