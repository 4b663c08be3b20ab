// Finds the closed surfaces that contain the camera.
#ifndef LAMPYRIS_RENDER_TABLES_CAMERA_MEDIA_H
#define LAMPYRIS_RENDER_TABLES_CAMERA_MEDIA_H

#include "render/tables/shading_tables.h"

// Returns the stack of media (lib/media.glsl) that contain the camera. A ray from the camera leaves
// the surfaces of these media more often than it enters them. Three rays decide by majority, so
// that one ray that grazes an edge does no harm. `materials` are the uploaded records, which have
// the numbers of the media. If the camera is inside more than four media, the four of highest
// priority are returned.
uint32_t camera_media_find(const struct shading_tables_params *params,
                           const struct gpu_material *materials);

#endif
