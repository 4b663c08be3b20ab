// Describes how objects have moved since the denoiser's history, so that the denoiser can follow
// them.
#ifndef LAMPYRIS_VIEWER_CORE_MOTION_H
#define LAMPYRIS_VIEWER_CORE_MOTION_H

#include "flatten/flatten.h"
#include "render/show/denoise.h"
#include "shared/denoise.h"

// The frames of all objects of a scene, by index. NULL if they are not known.
struct object_frame;
struct object_frames {
    struct object_frame *list;
    uint32_t count;
    uint32_t deformations; // number of mesh deformations up to this state
};

// The motion of objects in one side of the image.
struct motion {
    struct object_frames now, past; // frames in the renderer, and frames in the denoiser's history
    struct denoise_motion list[DENOISE_MOTIONS_MAX]; // objects whose frames in the two differ
    uint32_t count;
    bool has_changed; // the renderer has changed since the history was made
};

// Call this when a renderer was created for a scene and its flat form. Returns false if the
// denoiser cannot use its history, because objects were added or removed, meshes were deformed, or
// too many objects moved.
bool motion_begin(struct motion *motion, const struct scene *scene, const struct flat_scene *flat,
                  uint32_t deformations);
// Makes the frames of the renderer those of the history.
void motion_keep(struct motion *motion);
void motion_finish(struct motion *motion); // accepts {0}

#endif
