// Opening scenes.
#ifndef LAMPYRIS_VIEWER_CORE_LOAD_H
#define LAMPYRIS_VIEWER_CORE_LOAD_H

#include "flatten/geometry.h"

struct viewer;

// Replaces the scene; on failure the old one stays, with a message. keep_view: camera, methods and
// display settings are kept (reloading). While events, jobs or the panel are being processed,
// returns true and opens the scene afterwards, in the same frame.
bool viewer_open_scene(struct viewer *viewer, const char *path, bool keep_view);
void viewer_close_scene(struct viewer *viewer);
// Loads a scene without a message. ERR_STOPPED if the window was closed meanwhile.
bool viewer_load_scene(struct viewer *viewer, const char *path, bool keep_view, struct err *err);
struct geometry_params viewer_geometry_params(const struct viewer *viewer,
                                              const struct scene *scene,
                                              const struct camera *camera);
void viewer_find_bounds(struct viewer *viewer); // bounds of the current geometry
// Restores the scene's camera. A framed camera is fitted to the current image and orbits the centre
// of the scene.
void viewer_go_home(struct viewer *viewer);

#endif
