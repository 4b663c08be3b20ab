// Polls files several times a second. This works on every file system, both for files that are
// overwritten and for files that are replaced by renaming.
#include "viewer/core/watch.h"

#include "viewer/core/load.h"
#include "viewer/core/messages.h"
#include "viewer/core/reload.h"
#include "viewer/core/viewer.h"
#include "viewer/core/watch_files.h"
#include <stdlib.h>
#include <string.h>

#define SECONDS_BETWEEN_LOOKS 0.25

// A set of files that are reloaded together.
struct watched {
    struct watch_files files;
    uint64_t loaded; // hash of the files when they were loaded
    uint64_t seen;   // hash of the files at the last poll
};

struct watch {
    struct watched scene, shaders;
    uint64_t scene_hash; // hash of the scene whose files are watched
    char scene_path[SURROUNDINGS_PATH_MAX];
    double looked_seconds;
};

static void take_stamps(struct watched *watched)
{
    watched->loaded = watched->seen = watch_files_stamp(&watched->files);
}

static void list_scene(struct watch *watch, const struct viewer *viewer)
{
    struct watch_files *files = &watch->scene.files;
    watch_files_finish(files);
    watch->scene_hash = viewer->document.scene.hash;
    memcpy(watch->scene_path, viewer->document.scene_path, sizeof watch->scene_path);
    if (!viewer->document.has_scene)
        return;
    watch_files_add_scene(files, viewer->document.scene_path);
    if (viewer->document.scene.environment.file)
        watch_files_add(files, viewer->document.scene.environment.file);
    watch_files_add(files, viewer->document.surroundings.image);
    take_stamps(&watch->scene);
}

bool watch_create(struct viewer *viewer, struct watch **out, struct err *err)
{
    struct watch *watch = calloc(1, sizeof *watch);
    *out = watch;
    if (!watch)
        return err_memory(err, "watching files", sizeof *watch);
    watch_files_add_shaders(&watch->shaders.files, reload_folder(viewer->shell.reload));
    take_stamps(&watch->shaders);
    list_scene(watch, viewer);
    return true;
}

void watch_destroy(struct watch *watch)
{
    if (!watch)
        return;
    watch_files_finish(&watch->scene.files);
    watch_files_finish(&watch->shaders.files);
    free(watch);
}

// Returns whether files have changed since they were loaded and were then unchanged between two
// polls, because saving may take several steps.
static bool has_changed(struct watched *watched)
{
    uint64_t stamp = watch_files_stamp(&watched->files);
    bool rested = stamp == watched->seen;
    watched->seen = stamp;
    if (!rested || stamp == watched->loaded)
        return false;
    watched->loaded = stamp;
    return true;
}

void watch_poll(struct viewer *viewer)
{
    struct watch *watch = viewer->shell.watch;
    double now = viewer_seconds(viewer);
    if (now - watch->looked_seconds < SECONDS_BETWEEN_LOOKS)
        return;
    watch->looked_seconds = now;
    if (watch->scene_hash != viewer->document.scene.hash ||
        strcmp(watch->scene_path, viewer->document.scene_path) != 0)
        list_scene(watch, viewer);
    if (has_changed(&watch->shaders))
        reload_shaders(viewer);
    if (viewer->document.has_scene && has_changed(&watch->scene))
        viewer_open_scene(viewer, watch->scene_path, true);
}

void viewer_watch(struct viewer *viewer, bool on)
{
    struct err err = {0};
    if (!on) {
        watch_destroy(viewer->shell.watch);
        viewer->shell.watch = NULL;
    } else if (!watch_create(viewer, &viewer->shell.watch, &err)) {
        viewer_message(viewer, MESSAGE_ERROR, "%s", err.msg);
    }
}

bool viewer_watches(const struct viewer *viewer)
{
    return viewer->shell.watch != NULL;
}
