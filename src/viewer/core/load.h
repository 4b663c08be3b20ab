// Opens and closes scenes.
#ifndef LAMPYRIS_VIEWER_CORE_LOAD_H
#define LAMPYRIS_VIEWER_CORE_LOAD_H

#include "flatten/geometry.h"

struct viewer;

// Replaces the scene. If that fails, the old scene stays and the viewer shows a message. keep_view
// keeps camera, methods and display settings, as for reloading. While events, jobs or the panel are
// being processed, the function returns true and the scene is opened later in the same frame.
bool viewer_open_scene(struct viewer *viewer, const char *path, bool keep_view);
void viewer_close_scene(struct viewer *viewer);
// Loads a scene without showing a message. Fails with ERR_STOPPED if the window was closed during
// loading.
bool viewer_load_scene(struct viewer *viewer, const char *path, bool keep_view, struct err *err);
struct geometry_params viewer_geometry_params(const struct viewer *viewer,
                                              const struct scene *scene,
                                              const struct camera *camera);
void viewer_find_bounds(struct viewer *viewer); // computes the bounds of the current geometry
// Restores the camera of the scene file. If the file has none, the camera is fitted to the current
// image and orbits the centre of the scene.
void viewer_go_home(struct viewer *viewer);

#endif
