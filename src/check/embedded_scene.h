// Loads the scenes of the cases, which are embedded in the program.
#ifndef LAMPYRIS_CHECK_EMBEDDED_SCENE_H
#define LAMPYRIS_CHECK_EMBEDDED_SCENE_H

#include "scene/core/scene.h"

// Loads an embedded scene by name ("sky.json"). `overrides` ends with an entry whose key is NULL;
// it may be NULL.
bool embedded_scene_load(const char *name, const struct scene_override *overrides,
                         struct scene *out, struct err *err);

#endif
