// The uniform block that all kernels read: camera, picture, settings.
#ifndef LAMPYRIS_RENDER_FRAME_H
#define LAMPYRIS_RENDER_FRAME_H

#include "render/render.h"

// Fills renderer->frame from the scene, its settings and renderer->camera; the plan must be made.
void frame_fill(struct renderer *renderer);
// The part of it that the camera and the size of the picture decide. What is in view is forgotten.
void frame_look(struct renderer *renderer, uint32_t width, uint32_t height);
void in_view_finish(struct in_view *in_view);
bool frame_create(struct renderer *renderer, struct err *err); // the buffer
// To be called after renderer->frame was changed, while nothing runs.
bool frame_upload(struct renderer *renderer, struct err *err);

#endif
