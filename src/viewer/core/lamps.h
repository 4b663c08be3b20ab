// Lights that are added to a scene, and lamps: objects that shine because their material emits.
#ifndef LAMPYRIS_VIEWER_CORE_LAMPS_H
#define LAMPYRIS_VIEWER_CORE_LAMPS_H

#include "scene/core/scene.h"

struct viewer;

// Returns whether the object's material emits light.
bool lamp_is(const struct scene *scene, uint32_t object);

// Each is one step of the history, and chooses what came of it in the panel. False: refused, with a
// message in the viewer.
// A square that shines downwards, above what is seen.
bool lamp_add(struct viewer *viewer, const char *control);
// A parallel light, obliquely from above.
bool light_add(struct viewer *viewer, const char *control);
// Hides a lamp, and lets parallel light come from there which is as bright at the scene's middle.
bool lamp_exchange(struct viewer *viewer, uint32_t object, const char *control);
// The other way round: a directional light becomes a square that faces the scene's middle.
bool light_exchange(struct viewer *viewer, uint32_t light, const char *control);

#endif
