// Renders a frame, and finds where in the window it is shown.
#ifndef LAMPYRIS_VIEWER_CORE_FRAME_H
#define LAMPYRIS_VIEWER_CORE_FRAME_H

#include "base/err.h"
#include <stdint.h>

struct display_call;
struct view;
struct viewer;

// The size of the picture at rest: the window's.
void viewer_picture_size(const struct viewer *viewer, uint32_t *width, uint32_t *height);
// Where in the window it is shown: x, y, width, height, pixels. In the middle of what the panel
// leaves, and all of it: scaled down while the panel is shown. What is rendered is the same.
void viewer_picture_place(const struct viewer *viewer, uint32_t place[4]);
// The x in the window of the line of a split view.
double viewer_split_x(const struct viewer *viewer);
bool viewer_frame_is_over(void *viewer); // as a progress asks: whether to stop rendering
// How many samples of a pixel a side still wants, now.
uint64_t viewer_samples_left(const struct viewer *viewer, const struct view *view);
// Samples for as long as the frame may take.
bool viewer_render(struct viewer *viewer, struct err *err);
// Shows what there is, denoised where asked for, with the panel over it, on the screen and in the
// window.
bool viewer_show(struct viewer *viewer, struct err *err);
// Makes the call by which display_draw shows the picture now, for those who want the same in
// another way.
void viewer_display_call(const struct viewer *viewer, struct display_call *out);

#endif
