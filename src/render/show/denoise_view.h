// Cameras as the denoiser's kernels take them.
#ifndef LAMPYRIS_RENDER_SHOW_DENOISE_VIEW_H
#define LAMPYRIS_RENDER_SHOW_DENOISE_VIEW_H

#include "scene/core/scene.h"
#include "shared/denoise.h"

// Of a picture of width x height pixels, relative to a point in the world: the position of the
// camera whose film is looked at.
void denoise_view_fill(const struct camera *camera, uint32_t width, uint32_t height,
                       const double origin[3], struct gpu_denoise_view *out);

#endif
