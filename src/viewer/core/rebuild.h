// Hierarchies of large scenes are built anew on the worker's thread, while the picture of the old
// one goes on. Small ones are built between two frames.
#ifndef LAMPYRIS_VIEWER_CORE_REBUILD_H
#define LAMPYRIS_VIEWER_CORE_REBUILD_H

#include "base/err.h"
#include "flatten/geometry.h"

struct viewer;

// The build that is under way, or was adopted while the scene changed once more.
struct rebuild {
    struct rebuild_job *job; // NULL: nothing is under way
    bool is_stale;           // the scene changed since the job began
    // A copy of the scene that the geometry is of, where that is not the document's as it is now.
    struct scene *scene;
    struct arena scene_arena;
};

// Returns whether the geometry took so long the last time that frames would wait for it.
bool rebuild_is_worthwhile(const struct viewer *viewer);
bool rebuild_is_pending(const struct viewer *viewer);
// Builds for a copy of the document's scene as it is now. False: it cannot be had.
bool rebuild_start(struct viewer *viewer, struct err *err);
bool rebuild_is_done(const struct viewer *viewer); // what was under way is there
// It becomes the document's geometry, which no side may use meanwhile; all are to be built anew.
// Where the scene changed since it began, the next one is under way then.
void rebuild_adopt(struct viewer *viewer);
// Ends what is under way, and waits for that; the document's geometry has to be refreshed then.
void rebuild_cancel(struct viewer *viewer);
// The scene that the document's geometry is of.
const struct scene *rebuild_scene(const struct viewer *viewer);

#endif
