// Reads a scene from its document or file.
#include "library/library.h"

#include "json/json_parse.h"
#include <stdlib.h>

void loaded_release(struct loaded *loaded)
{
    if (!loaded || --loaded->refs > 0)
        return;
    scene_finish(&loaded->scene);
    free(loaded);
}

static bool check_visible(const struct scene *scene, struct err *err)
{
    if (scene->is_empty)
        return err_set(err, ERR_INPUT,
                       "%s: the scene is empty: it has no triangle with an area, no shape and no "
                       "environment; expected something to see",
                       scene->path);
    return !scene->is_hidden ||
           err_set(err, ERR_INPUT,
                   "%s: everything in the scene is hidden, and it has no environment; expected "
                   "something to see",
                   scene->path);
}

// Collects the arrays of all meshes in a list.
static struct scene_array *list_arrays(const struct lampyris_scene *scene, struct arena *arena,
                                       struct err *err)
{
    struct scene_array *list = ARENA_NEW(arena, struct scene_array, scene->mesh_count);
    if (!list)
        err_memory(err, "meshes", scene->mesh_count * sizeof *list);
    for (uint32_t i = 0; list && i < scene->mesh_count; i++)
        list[i] = scene->meshes[i].array;
    return list;
}

static bool read_with(const struct lampyris_scene *scene, struct library_progress *progress,
                      const char *text, struct arena *scratch, struct loaded *out, struct err *err)
{
    const struct scene_load_params params = {
        .path = text ? scene->document_path : scene->path,
        .text = text,
        .overrides = scene->overrides,
        .override_count = scene->override_count,
        .arrays = list_arrays(scene, scratch, err),
        .array_count = scene->mesh_count,
        .allow_outside_paths = scene->allow_outside_paths,
        .is_strict = scene->is_strict,
        .studio = SCENE_STUDIO_AUTO,
        .progress = &progress->progress,
    };
    if (!params.arrays || !scene_load(&params, &out->scene, err))
        return false;
    if (check_visible(&out->scene, err)) {
        for (uint32_t i = 0; i < out->scene.note_count; i++)
            log_info("%s", out->scene.notes[i]);
        return true;
    }
    scene_finish(&out->scene);
    return false;
}

// Reads the scene. If the document was not changed, the file itself is read, so that the scene is
// the same as for the command line.
static bool read_scene(const struct lampyris_scene *scene, struct library_progress *progress,
                       struct loaded *out, struct err *err)
{
    struct arena scratch = {0};
    char *text = NULL;
    bool ok = true;
    if (scene->is_edited) {
        text = json_dumps(scene->document, JSON_REAL_PRECISION(17));
        ok = text || err_memory(err, "the document", 1);
    }
    ok = ok && read_with(scene, progress, text, &scratch, out, err);
    if (!ok)
        err_locate(err, scene->is_edited ? scene->document_path : scene->path, "");
    json_release(text);
    arena_finish(&scratch);
    return ok;
}

bool scene_need(struct lampyris_scene *scene, struct library_progress *progress,
                struct loaded **out, struct err *err)
{
    *out = NULL;
    if (!scene->loaded) {
        struct loaded *loaded = calloc(1, sizeof *loaded);
        if (!loaded)
            return err_memory(err, "a scene", sizeof *loaded);
        if (!read_scene(scene, progress, loaded, err)) {
            free(loaded);
            return false;
        }
        loaded->refs = 1;
        scene->loaded = loaded;
    }
    scene->loaded->refs++;
    *out = scene->loaded;
    return true;
}

enum lampyris_status lampyris_scene_check(struct lampyris_scene *scene,
                                          const struct lampyris_progress *progress)
{
    struct library_progress listener;
    struct loaded *loaded = NULL;
    struct err *err = &scene->context->err;
    if (!library_enter(scene->context))
        return LAMPYRIS_INPUT;
    bool ok = library_progress_init(&listener, progress, NULL, err) &&
              scene_need(scene, &listener, &loaded, err);
    loaded_release(loaded);
    return library_leave(scene->context, ok);
}
