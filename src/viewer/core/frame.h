// Renders a frame, and computes where in the window it is shown.
#ifndef LAMPYRIS_VIEWER_CORE_FRAME_H
#define LAMPYRIS_VIEWER_CORE_FRAME_H

#include "base/err.h"
#include <stdint.h>

struct display_call;
struct view;
struct viewer;

// Computes the size of the full image, which is that of the window.
void viewer_picture_size(const struct viewer *viewer, uint32_t *width, uint32_t *height);
// Computes the rectangle of the window in which it is shown: x, y, width, height, pixels. It is
// centred in the space beside the panel, and is scaled down to fit while the panel is shown. The
// size of the rendered image does not change.
void viewer_picture_place(const struct viewer *viewer, uint32_t place[4]);
// Returns the x coordinate in the window of the dividing line of a split view.
double viewer_split_x(const struct viewer *viewer);
bool viewer_frame_is_over(void *viewer); // a progress callback: whether to stop rendering
// Returns how many samples per pixel a side still needs.
uint64_t viewer_samples_left(const struct viewer *viewer, const struct view *view);
// Renders samples for as long as the frame may take.
bool viewer_render(struct viewer *viewer, struct err *err);
// Displays the current image, denoised if requested, with the panel over it, on the screen and in
// the window.
bool viewer_show(struct viewer *viewer, struct err *err);
// Makes the call with which display_draw shows the current image, for other uses of the same image.
void viewer_display_call(const struct viewer *viewer, struct display_call *out);

#endif
