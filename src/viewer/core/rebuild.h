// BVHs of large scenes are rebuilt on the worker's thread, while the image with the old one
// continues. Small ones are built between two frames.
#ifndef LAMPYRIS_VIEWER_CORE_REBUILD_H
#define LAMPYRIS_VIEWER_CORE_REBUILD_H

#include "base/err.h"
#include "flatten/geometry.h"

struct viewer;

// The build in progress, or one that was adopted after the scene had changed again.
struct rebuild {
    struct rebuild_job *job; // NULL: no build is in progress
    bool is_stale;           // the scene changed since the job began
    // A copy of the scene of the geometry, if that is not the document's current scene; else NULL.
    struct scene *scene;
    struct arena scene_arena;
};

// Returns whether the last build took so long that frames would be delayed.
bool rebuild_is_worthwhile(const struct viewer *viewer);
bool rebuild_is_pending(const struct viewer *viewer);
// Starts a build for a copy of the document's current scene. Returns false on failure.
bool rebuild_start(struct viewer *viewer, struct err *err);
bool rebuild_is_done(const struct viewer *viewer); // the build has finished
// The result becomes the document's geometry, which no side may use meanwhile; all sides must be
// rebuilt. If the scene has changed since the build began, another build is started.
void rebuild_adopt(struct viewer *viewer);
// Cancels the build and waits for its end; the document's geometry must then be refreshed.
void rebuild_cancel(struct viewer *viewer);
// Returns the scene of the document's geometry.
const struct scene *rebuild_scene(const struct viewer *viewer);

#endif
