// Renders a frame, and computes its place in the window.
#ifndef LAMPYRIS_VIEWER_CORE_FRAME_H
#define LAMPYRIS_VIEWER_CORE_FRAME_H

#include "base/err.h"
#include <stdint.h>

struct display_call;
struct view;
struct viewer;

// Computes the size of the full-size image, which is that of the window.
void viewer_picture_size(const struct viewer *viewer, uint32_t *width, uint32_t *height);
// Computes the rectangle (x, y, width, height, in pixels) of the window in which the image is
// shown. It is centred in the space beside the panel. While the panel is shown, the image is scaled
// down to fit; its rendered size does not change.
void viewer_picture_place(const struct viewer *viewer, uint32_t place[4]);
// Returns the x coordinate in the window of the dividing line of a split view.
double viewer_split_x(const struct viewer *viewer);
// A progress callback that stops rendering at the end of the frame.
bool viewer_frame_is_over(void *viewer);
// Returns how many samples per pixel a side still needs.
uint64_t viewer_samples_left(const struct viewer *viewer, const struct view *view);
// Renders samples for as long as the frame may take. Returns false if the device failed.
bool viewer_render(struct viewer *viewer, struct err *err);
// Displays the current image, denoised if requested, with the panel over it, on the screen and in
// the window. Returns false if the device failed.
bool viewer_show(struct viewer *viewer, struct err *err);
// Fills in the parameters with which display_draw() shows the current image.
void viewer_display_call(const struct viewer *viewer, struct display_call *out);

#endif
