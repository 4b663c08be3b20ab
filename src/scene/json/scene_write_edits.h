// Writes the section "edits" of a scene file. Internal to scene_write.
#ifndef LAMPYRIS_SCENE_JSON_SCENE_WRITE_EDITS_H
#define LAMPYRIS_SCENE_JSON_SCENE_WRITE_EDITS_H

#include "json/json_text.h"
#include "scene/core/scene.h"

struct scene_difference {
    const struct scene *before; // the scene as in the base
    const struct scene *scene;
    bool has_other_environment; // "environment" replaces the base's, and its sun
    bool has_other_adjustment;  // the command line rotated or scaled the environment
};

void scene_write_edits(struct json_text *t, const struct scene_difference *difference);

// Returns whether everything that can be edited is bitwise equal; otherwise fails with ERR_INPUT,
// naming the difference.
bool scene_compare_edits(const struct scene *a, const struct scene *b, struct err *err);
// Returns whether the fields that the kind of camera uses are equal.
bool scene_same_camera(const struct camera *a, const struct camera *b);

#endif
