// The section "edits" of a scene that is written down. Internal to scene_write.
#ifndef LAMPYRIS_SCENE_JSON_SCENE_WRITE_EDITS_H
#define LAMPYRIS_SCENE_JSON_SCENE_WRITE_EDITS_H

#include "json/json_text.h"
#include "scene/core/scene.h"

struct scene_difference {
    const struct scene *before; // as the file that is to be the base has it
    const struct scene *scene;
    bool has_other_environment; // "environment" gives it, and its sun, anew
    bool has_other_adjustment;  // what was loaded was turned or scaled as the base is not
};

void scene_write_edits(struct json_text *t, const struct scene_difference *difference);

// Returns whether what can be edited is the same to the bit; else ERR_INPUT, naming what is not.
bool scene_compare_edits(const struct scene *a, const struct scene *b, struct err *err);
// Compares cameras as far as their kind makes use of their fields.
bool scene_same_camera(const struct camera *a, const struct camera *b);

#endif
