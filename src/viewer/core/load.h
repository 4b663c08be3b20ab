// Opening scenes.
#ifndef LAMPYRIS_VIEWER_CORE_LOAD_H
#define LAMPYRIS_VIEWER_CORE_LOAD_H

#include "flatten/geometry.h"

struct viewer;

// Replaces the scene; on failure the old one stays, with a message. keep_view: camera, methods and
// what is shown stay as they are (reloading). While events, jobs or the panel are in hand, the
// scene is opened afterwards, in the same frame, and the answer is true.
bool viewer_open_scene(struct viewer *viewer, const char *path, bool keep_view);
void viewer_close_scene(struct viewer *viewer);
// Loads a scene without a message. ERR_STOPPED where the window was closed meanwhile.
bool viewer_load_scene(struct viewer *viewer, const char *path, bool keep_view, struct err *err);
struct geometry_params viewer_geometry_params(const struct viewer *viewer,
                                              const struct scene *scene,
                                              const struct camera *camera);
void viewer_find_bounds(struct viewer *viewer); // of the geometry as it is
// The scene's camera; one that was made up is fitted to the picture as it is now, and turns about
// the middle of the scene.
void viewer_go_home(struct viewer *viewer);

#endif
