// Rebuilds BVHs. The BVH of a large scene is built on the worker's thread, while rendering goes on
// with the old one. The BVH of a small scene is built between two frames.
#ifndef LAMPYRIS_VIEWER_CORE_REBUILD_H
#define LAMPYRIS_VIEWER_CORE_REBUILD_H

#include "base/err.h"
#include "flatten/geometry.h"

struct viewer;

// A build in progress, or one that was adopted although the scene had changed again.
struct rebuild {
    struct rebuild_job *job; // NULL if no build is in progress
    bool is_stale;           // the scene changed since the job began
    // A copy of the scene from which the geometry was built, if that differs from the document's
    // current scene; otherwise NULL.
    struct scene *scene;
    struct arena scene_arena;
};

// Returns whether the last build took so long that it would delay frames.
bool rebuild_is_worthwhile(const struct viewer *viewer);
bool rebuild_is_pending(const struct viewer *viewer);
// Starts a build for a copy of the document's current scene. Returns false on failure.
bool rebuild_start(struct viewer *viewer, struct err *err);
bool rebuild_is_done(const struct viewer *viewer); // returns whether the build has ended
// Makes the result the document's geometry. No side may be using the geometry, and all sides must
// be rebuilt afterwards. If the scene has changed since the build began, another build is started.
void rebuild_adopt(struct viewer *viewer);
// Cancels the build and waits for its end. The caller must then refresh the document's geometry.
void rebuild_cancel(struct viewer *viewer);
// Returns the scene from which the document's geometry was built.
const struct scene *rebuild_scene(const struct viewer *viewer);

#endif
