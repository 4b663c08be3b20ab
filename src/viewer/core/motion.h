// What moved since the denoiser's history was seen: by that it follows objects.
#ifndef LAMPYRIS_VIEWER_CORE_MOTION_H
#define LAMPYRIS_VIEWER_CORE_MOTION_H

#include "flatten/flatten.h"
#include "render/show/denoise.h"
#include "shared/denoise.h"

// Where all objects of a scene are, by their numbers; NULL: that is not known.
struct object_frame;
struct object_frames {
    struct object_frame *list;
    uint32_t count;
    uint32_t deformations; // how often meshes had taken another form until then
};

// Of one side of the picture.
struct motion {
    struct object_frames now, past; // as its renderer has them, and as the history does
    struct denoise_motion list[DENOISE_MOTIONS_MAX]; // of what moved in between
    uint32_t count;
    bool has_changed; // the renderer is another one than the history's
};

// A renderer was created for a scene, which was flattened for it. False: the history says nothing
// of it, because there are other objects, meshes took another form, or too much moved.
bool motion_begin(struct motion *motion, const struct scene *scene, const struct flat_scene *flat,
                  uint32_t deformations);
// What the renderer has seen so far became the history.
void motion_keep(struct motion *motion);
void motion_finish(struct motion *motion); // accepts {0}

#endif
