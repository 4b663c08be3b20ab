// Displays the progress of work that takes longer than a frame.
#ifndef LAMPYRIS_VIEWER_CORE_LONG_WORK_H
#define LAMPYRIS_VIEWER_CORE_LONG_WORK_H

#include "base/progress.h"

struct viewer;

struct progress viewer_progress(struct viewer *viewer); // for work between two frames
bool viewer_is_ending(const struct viewer *viewer); // the window was closed, or a signal arrived
// Draws a frame with a progress bar during long work. It draws at most ten frames per second.
void viewer_show_progress(struct viewer *viewer, const char *phase, double fraction);

#endif
