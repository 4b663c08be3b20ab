// Whether the surfaces of a scene may focus light that light paths would find (INTEGRATOR_BIDIR).
// It is decided from materials and lights alone, without tracing rays.
#ifndef LAMPYRIS_RENDER_FOCUS_H
#define LAMPYRIS_RENDER_FOCUS_H

#include "flatten/flatten.h"

enum focus {
    FOCUS_NONE,     // nothing focuses light, or light paths cannot begin or end
    FOCUS_POSSIBLE, // camera paths find the focused light by chance
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
