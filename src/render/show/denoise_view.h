// Converts cameras to the form that the denoiser's kernels read.
#ifndef LAMPYRIS_RENDER_SHOW_DENOISE_VIEW_H
#define LAMPYRIS_RENDER_SHOW_DENOISE_VIEW_H

#include "scene/core/scene.h"
#include "shared/denoise.h"

// Fills in a view for an image of width x height pixels. Positions are relative to a point in world
// space: the position of the camera whose film is shown.
void denoise_view_fill(const struct camera *camera, uint32_t width, uint32_t height,
                       const double origin[3], struct gpu_denoise_view *out);

#endif
