// Adds lights, and lamps (objects with an emissive material), to the scene.
#ifndef LAMPYRIS_VIEWER_CORE_LAMPS_H
#define LAMPYRIS_VIEWER_CORE_LAMPS_H

#include "scene/core/scene.h"

struct viewer;

// Returns whether the object's material emits light.
bool lamp_is(const struct scene *scene, uint32_t object);

// Each of the following functions makes one step of the history and selects the result in the
// panel. It returns false if it is rejected; the viewer then shows a message.
//
// Adds a square lamp that faces downwards, above the visible part of the scene.
bool lamp_add(struct viewer *viewer, const char *control);
// Adds a directional light that shines obliquely from above.
bool light_add(struct viewer *viewer, const char *control);
// Hides a lamp and adds a directional light that shines from its place and is as bright at the
// scene's centre.
bool lamp_exchange(struct viewer *viewer, uint32_t object, const char *control);
// Does the inverse: replaces a directional light by a square that faces the scene's centre.
bool light_exchange(struct viewer *viewer, uint32_t light, const char *control);

#endif
