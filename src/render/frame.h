// Fills and uploads the uniform block that all kernels read: camera, image, settings.
#ifndef LAMPYRIS_RENDER_FRAME_H
#define LAMPYRIS_RENDER_FRAME_H

#include "render/render.h"

// Fills renderer->frame from the scene, its settings and renderer->camera. The memory plan must be
// made.
void frame_fill(struct renderer *renderer);
// Fills the members of the frame that depend on the camera and on the image's size, and invalidates
// the list of emitters in view.
void frame_look(struct renderer *renderer, uint32_t width, uint32_t height);
void in_view_finish(struct in_view *in_view);
bool frame_create(struct renderer *renderer, struct err *err); // creates the uniform buffer
// Uploads renderer->frame after a change; no kernel may be running.
bool frame_upload(struct renderer *renderer, struct err *err);

#endif
