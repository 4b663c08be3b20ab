// The origin of a scene file with a "base". scene_write() writes such a scene as another file with
// the same base, so that files do not form a chain.
#ifndef LAMPYRIS_SCENE_JSON_SCENE_EDITS_H
#define LAMPYRIS_SCENE_JSON_SCENE_EDITS_H

#include "scene/core/scene.h"

// All data are in the scene's arena.
struct scene_base {
    const struct scene_base *base; // base of the base; NULL: none
    struct scene_load_params load; // paths are relative to the working directory
    const struct scene_path *override_paths;
    uint32_t override_path_count;
    // The base's versions of the materials and objects that the file changes, kept because an
    // animation may move them later. NULL: it changes none.
    struct material *materials;
    struct instance *instances;
    struct shape *shapes;
    uint32_t material_count, shape_count; // numbers in the base, if there are "edits"
    struct light *lights;
    uint32_t light_count;
    struct environment environment;
};

#endif
