// Keeps what a scene file with a "base" was made from. scene_write writes such a scene down as
// another file with the same base, so that files do not pile up on one another.
#ifndef LAMPYRIS_SCENE_JSON_SCENE_EDITS_H
#define LAMPYRIS_SCENE_JSON_SCENE_EDITS_H

#include "scene/core/scene.h"

// All in the scene's arena.
struct scene_base {
    const struct scene_base *base; // of that file itself; NULL: it has none
    struct scene_load_params load; // paths as seen from the working directory
    const struct scene_path *override_paths;
    uint32_t override_path_count;
    // Materials and objects that the file changes, as the base has them: an animation may move them
    // later. NULL: it changes none.
    struct material *materials;
    struct instance *instances;
    struct shape *shapes;
    uint32_t material_count, shape_count; // with "edits": as the base has them
    struct light *lights;
    uint32_t light_count;
    struct environment environment;
};

#endif
