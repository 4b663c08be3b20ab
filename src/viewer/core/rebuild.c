#include "viewer/core/rebuild.h"

#include "base/clock.h"
#include "scene/json/scene_write.h"
#include "viewer/core/changes.h"
#include "viewer/core/load.h"
#include "viewer/core/messages.h"
#include "viewer/core/viewer.h"
#include <stdatomic.h>
#include <stdlib.h>

// Builds that take longer than this many seconds are done in the background, because they would
// delay frames.
#define REBUILD_SECONDS 0.05
#define NAME "geometry"

// All data that the worker's thread reads, except for meshes, which do not change.
struct rebuild_job {
    struct scene scene;
    struct arena scene_arena;
    struct camera camera;
    struct geometry_params params;
    struct progress progress;
    struct geometry geometry;
    atomic_bool is_cancelled;
    bool is_done, is_ok;
};

bool rebuild_is_worthwhile(const struct viewer *viewer)
{
    const struct geometry *geometry = &viewer->document.geometry;
    double seconds = geometry->flatten_seconds + geometry->bvh.stats.build_seconds;
    return geometry->bvh.node_count > 0 && seconds > REBUILD_SECONDS;
}

bool rebuild_is_pending(const struct viewer *viewer)
{
    return viewer->document.rebuild.job != NULL;
}

const struct scene *rebuild_scene(const struct viewer *viewer)
{
    const struct scene *copy = viewer->document.rebuild.scene;
    return copy ? copy : &viewer->document.scene;
}

static void free_job(struct rebuild_job *job)
{
    geometry_finish(&job->geometry);
    arena_finish(&job->scene_arena);
    free(job);
}

// --- on the worker's thread ----------------------------------------------------------------------

static bool is_cancelled(void *context)
{
    struct rebuild_job *job = context;
    return atomic_load(&job->is_cancelled);
}

static bool run(void *context, struct err *err)
{
    struct rebuild_job *job = context;
    return geometry_create(&job->params, &job->geometry, err);
}

// --- on the viewer's thread ----------------------------------------------------------------------

// Finishes a build. If it failed, the change that caused it is undone, as for a build between two
// frames.
static void done(void *context, void *of_viewer, bool ok, const struct err *err)
{
    struct viewer *viewer = of_viewer;
    struct rebuild_job *job = context;
    job->is_done = true;
    job->is_ok = ok;
    if (ok || err->code == ERR_STOPPED)
        return;
    viewer->document.rebuild.job = NULL;
    free_job(job);
    viewer_message(viewer, MESSAGE_ERROR, "undone: %s", err->msg);
    edit_undo(viewer);
    viewer_changed(viewer, CHANGE_GEOMETRY);
}

bool rebuild_start(struct viewer *viewer, struct err *err)
{
    struct rebuild_job *job = calloc(1, sizeof *job);
    if (!job)
        return err_memory(err, "a hierarchy", sizeof *job);
    job->camera = viewer->view.camera;
    job->progress = (struct progress){.should_stop = is_cancelled, .context = job};
    bool ok = scene_snapshot(&job->scene_arena, &viewer->document.scene, &job->scene, err);
    job->params = viewer_geometry_params(viewer, &job->scene, &job->camera);
    job->params.progress = &job->progress;
    const struct worker_task task = {.name = NAME, .run = run, .done = done, .context = job};
    if (ok && !worker_add(viewer->shell.worker, &task))
        ok = err_set(err, ERR_SYSTEM,
                     "the BVH cannot be built in the background: too many tasks are waiting");
    if (!ok) {
        free_job(job);
        return false;
    }
    viewer->document.rebuild.job = job;
    viewer->document.rebuild.is_stale = false;
    return true;
}

static void forget_copy(struct rebuild *rebuild)
{
    arena_finish(&rebuild->scene_arena);
    free(rebuild->scene);
    rebuild->scene = NULL;
}

// Makes the job's copy of the scene the one from which sides are built.
static bool keep_copy(struct rebuild *rebuild, struct rebuild_job *job)
{
    struct scene *copy = malloc(sizeof *copy);
    if (!copy)
        return false;
    *copy = job->scene;
    rebuild->scene = copy;
    rebuild->scene_arena = job->scene_arena;
    job->scene_arena = (struct arena){0};
    return true;
}

bool rebuild_is_done(const struct viewer *viewer)
{
    const struct rebuild_job *job = viewer->document.rebuild.job;
    return job && job->is_done && job->is_ok;
}

void rebuild_adopt(struct viewer *viewer)
{
    struct rebuild *rebuild = &viewer->document.rebuild;
    struct rebuild_job *job = rebuild->job;
    struct err err = {0};
    geometry_finish(&viewer->document.geometry);
    viewer->document.geometry = job->geometry;
    job->geometry = (struct geometry){0};
    rebuild->job = NULL;
    forget_copy(rebuild);
    bool goes_on = rebuild->is_stale && keep_copy(rebuild, job);
    bool is_old = rebuild->is_stale;
    free_job(job);
    viewer_find_bounds(viewer);
    if (goes_on && !rebuild_start(viewer, &err)) {
        forget_copy(rebuild);
        goes_on = false;
    }
    if (is_old && !goes_on)
        viewer_changed(viewer, CHANGE_GEOMETRY); // the BVH is then built between two frames
}

void rebuild_cancel(struct viewer *viewer)
{
    struct rebuild *rebuild = &viewer->document.rebuild;
    if (rebuild->job) {
        atomic_store(&rebuild->job->is_cancelled, true);
        while (rebuild->job && !rebuild->job->is_done) {
            clock_sleep(1e-3);
            worker_poll(viewer->shell.worker, viewer);
        }
        if (rebuild->job)
            free_job(rebuild->job);
        rebuild->job = NULL;
    }
    forget_copy(rebuild);
}
