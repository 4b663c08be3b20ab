// Writes the section "edits" of a scene file. Internal to scene_write.
#ifndef LAMPYRIS_SCENE_JSON_SCENE_WRITE_EDITS_H
#define LAMPYRIS_SCENE_JSON_SCENE_WRITE_EDITS_H

#include "json/json_text.h"
#include "scene/core/scene.h"

struct scene_difference {
    const struct scene *before; // the scene as the base has it
    const struct scene *scene;
    bool has_other_environment; // "environment" replaces it, and its sun
    bool has_other_adjustment;  // the environment was rotated or scaled relative to the base
};

void scene_write_edits(struct json_text *t, const struct scene_difference *difference);

// Returns whether all that can be edited is bitwise equal; else ERR_INPUT names what is not.
bool scene_compare_edits(const struct scene *a, const struct scene *b, struct err *err);
// Compares the fields that the kind of camera uses.
bool scene_same_camera(const struct camera *a, const struct camera *b);

#endif
