// Finds out whether the surfaces of a scene may focus light, which light paths (INTEGRATOR_BIDIR)
// would find. Only the materials and the lights are examined; no rays are traced.
#ifndef LAMPYRIS_RENDER_FOCUS_H
#define LAMPYRIS_RENDER_FOCUS_H

#include "flatten/flatten.h"

enum focus {
    FOCUS_NONE,     // nothing focuses light, or light paths cannot begin or end
    FOCUS_POSSIBLE, // surfaces may focus light, and camera paths can find it by chance
    // Perfectly specular surfaces may focus the light of delta lights, which no camera path finds.
    FOCUS_LOST,
};

struct focus_found {
    enum focus focus;
    uint32_t delta_lights;
    const char *reason; // for FOCUS_NONE, what is missing
};

struct focus_found focus_find(const struct scene *scene, const struct flat_scene *flat);

#endif
