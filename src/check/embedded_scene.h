// The scenes of the cases, which are embedded in the program.
#ifndef LAMPYRIS_CHECK_EMBEDDED_SCENE_H
#define LAMPYRIS_CHECK_EMBEDDED_SCENE_H

#include "scene/core/scene.h"

// Loads the scene of that name ("sky.json"), with overrides up to one whose key is NULL; NULL: no
// overrides.
bool embedded_scene_load(const char *name, const struct scene_override *overrides,
                         struct scene *out, struct err *err);

#endif
