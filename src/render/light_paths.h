// Checks whether light paths (INTEGRATOR_BIDIR) support a scene and its settings.
#ifndef LAMPYRIS_RENDER_LIGHT_PATHS_H
#define LAMPYRIS_RENDER_LIGHT_PATHS_H

#include "flatten/flatten.h"

struct light_paths_params {
    const struct scene *scene;
    const struct flat_scene *flat;
    const struct camera *camera;
    uint32_t aovs;   // AOV_*
    bool tiles;      // tiles have sample counts of their own (an adaptive render)
    bool has_window; // the film is a window of the picture
};

// Fails with ERR_INPUT for settings and scenes that light paths do not support, whatever the
// integrator of the settings is.
bool light_paths_support(const struct light_paths_params *params, struct err *err);
// Does the same for INTEGRATOR_BIDIR, and returns true for other integrators.
bool light_paths_check(const struct light_paths_params *params, struct err *err);

#endif
