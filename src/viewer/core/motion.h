// Object motion since the denoiser's history, with which the denoiser follows objects.
#ifndef LAMPYRIS_VIEWER_CORE_MOTION_H
#define LAMPYRIS_VIEWER_CORE_MOTION_H

#include "flatten/flatten.h"
#include "render/show/denoise.h"
#include "shared/denoise.h"

// The frames of all objects of a scene by their indices; NULL: not known.
struct object_frame;
struct object_frames {
    struct object_frame *list;
    uint32_t count;
    uint32_t deformations; // number of mesh deformations up to then
};

// For one side of the image.
struct motion {
    struct object_frames now, past; // those of its renderer, and those of the history
    struct denoise_motion list[DENOISE_MOTIONS_MAX]; // objects that moved between them
    uint32_t count;
    bool has_changed; // the renderer is not the one of the history
};

// Call when a renderer was created for a scene and its flat form. Returns false if the history is
// not usable, because there are other objects, meshes were deformed, or too many objects moved.
bool motion_begin(struct motion *motion, const struct scene *scene, const struct flat_scene *flat,
                  uint32_t deformations);
// The renderer's current frames become those of the history.
void motion_keep(struct motion *motion);
void motion_finish(struct motion *motion); // accepts {0}

#endif
