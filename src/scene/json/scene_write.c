#include "scene/json/scene_write.h"

#include "base/file.h"
#include "base/file_inputs.h"
#include "base/file_system.h"
#include "base/maths.h"
#include "json/field_json.h"
#include "json/json_parse.h"
#include "scene/core/environment.h"
#include "scene/core/placement.h"
#include "scene/json/load_json.h"
#include "scene/json/scene_edits.h"
#include "scene/json/scene_fields.h"
#include "scene/json/scene_write_edits.h"
#include "scene/sky/sky.h"
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define JSON_REALS (JSON_ENCODE_ANY | JSON_REAL_PRECISION(17))

struct writer {
    const struct scene_write_params *params;
    struct scene_difference difference;
    struct scene before;
    struct settings settings;
    struct camera camera;
    struct arena arena;     // owns paths
    const char *folder;     // folder of the new file, with symbolic links resolved
    struct scene_base base; // the base of the new file
    bool is_outside;
};

// --- camera --------------------------------------------------------------------------------------

static void put_name(struct json_text *t, const char *key, const char *name)
{
    json_text_key(t, key);
    json_text_string(t, name);
}

static void put_camera(struct json_text *t, const struct camera *camera)
{
    struct scene_fields fields;
    scene_camera_fields(camera, &fields);
    json_text_open(t, '{', false);
    if (camera->name && *camera->name && json_text_can_hold(camera->name))
        put_name(t, "name", camera->name);
    fields_write(fields.list, fields.count, camera, t);
    json_text_close(t);
}

char *camera_to_json(struct arena *arena, const struct camera *camera)
{
    struct json_text t;
    if (!json_text_begin(&t, 1, NULL))
        return NULL;
    put_camera(&t, camera);
    char *text = json_text_end(&t), *kept = text ? arena_strdup(arena, text) : NULL;
    free(text);
    return kept;
}

// --- film and settings ---------------------------------------------------------------------------

// Writes settings: all of them, because the base may have other values.
static void put_settings(struct json_text *t, const char *key, const struct settings *settings,
                         enum setting_id first, enum setting_id last)
{
    json_text_key(t, key);
    json_text_open(t, '{', false);
    for (uint32_t i = first; i <= last; i++)
        field_write(&settings_table[i].field, settings, t);
    json_text_close(t);
}

// --- paths ---------------------------------------------------------------------------------------

static const char *real_path(struct writer *w, const char *path, struct err *err)
{
    char *resolved = file_real_path(path);
    if (!resolved) {
        err_set(err, ERR_INPUT, "%s: %s", path, strerror(errno));
        return NULL;
    }
    const char *copy = arena_strdup(&w->arena, resolved);
    free(resolved);
    if (!copy)
        err_memory(err, "a path", strlen(path) + 1);
    return copy;
}

// Returns the path for use in the new file: relative if it leads into the new file's folder, else
// absolute.
static const char *path_from_folder(struct writer *w, const char *path, struct err *err)
{
    const char *real = real_path(w, path, err);
    if (!real)
        return NULL;
    size_t length = strlen(w->folder);
    if (w->folder[length - 1] == '/') // the folder is "/" itself
        length--;
    if (strncmp(real, w->folder, length) != 0 || real[length] != '/') {
        w->is_outside = true;
        return real;
    }
    // "./" prevents a name with a colon from looking like a URI scheme.
    const char *relative = real + length + 1;
    const char *named =
        strchr(relative, ':') ? arena_printf(&w->arena, "./%s", relative) : relative;
    if (!named)
        err_memory(err, "a path", strlen(relative) + 3);
    return named;
}

static bool put_path(struct writer *w, struct json_text *t, const char *key, const char *path,
                     struct err *err)
{
    const char *named = path_from_folder(w, path, err);
    if (!named)
        return false;
    put_name(t, key, named);
    return true;
}

// --- base ----------------------------------------------------------------------------------------

// Replaces strings that were read as paths by the paths for use in the new file. Takes ownership of
// `value`.
static json_t *rename_paths(struct writer *w, json_t *value, struct err *err)
{
    const char *text = json_string_value(value), *key;
    json_t *child;
    size_t i;
    for (uint32_t p = 0; text && p < w->base.override_path_count; p++) {
        const struct scene_path *known = &w->base.override_paths[p];
        if (strcmp(known->text, text) != 0)
            continue;
        const char *named = path_from_folder(w, known->path, err);
        json_decref(value);
        return named ? json_string(named) : NULL;
    }
    bool ok = true;
    json_object_foreach(value, key, child)
    {
        json_t *renamed = ok ? rename_paths(w, json_incref(child), err) : NULL;
        ok = ok && renamed && json_object_set_new(value, key, renamed) == 0;
    }
    json_array_foreach(value, i, child)
    {
        json_t *renamed = ok ? rename_paths(w, json_incref(child), err) : NULL;
        ok = ok && renamed && json_array_set_new(value, i, renamed) == 0;
    }
    if (ok)
        return value;
    json_decref(value);
    return NULL;
}

static bool put_override(struct writer *w, struct json_text *t,
                         const struct scene_override *override, struct err *err)
{
    json_t *value = load_json_override_value(override->value, err);
    if (!value)
        return err_prepend(err, "-D %s", override->key);
    value = rename_paths(w, value, err);
    char *dumped = value ? json_dumps(value, JSON_REALS) : NULL;
    json_decref(value);
    json_text_next(t);
    json_text_open(t, '{', true);
    put_name(t, "key", override->key);
    json_text_key(t, "value");
    json_text_raw(t, dumped ? dumped : "null");
    json_text_close(t);
    json_release(dumped);
    return dumped || (err && err->code != ERR_NONE) ||
           err_set(err, ERR_INPUT,
                   "-D %s: \"%s\" cannot be written; expected a file name in "
                   "UTF-8",
                   override->key, override->value);
}

static bool put_base(struct writer *w, struct json_text *t, struct err *err)
{
    const struct scene_load_params *load = &w->base.load;
    static const struct scene_load_params nothing = {.studio = SCENE_STUDIO_AUTO};
    struct err problem = {0};
    json_text_key(t, "base");
    json_text_open(t, '{', false);
    bool ok = put_path(w, t, "file", load->path, &problem);
    if (ok && load->override_count > 0) {
        json_text_key(t, "overrides");
        json_text_open(t, '[', false);
        for (uint32_t i = 0; i < load->override_count && ok; i++)
            ok = put_override(w, t, &load->overrides[i], &problem) && problem.code == ERR_NONE;
        json_text_close(t);
    }
    for (size_t i = 0; i < sizeof scene_base_texts / sizeof *scene_base_texts; i++) {
        const char *text;
        memcpy(&text, (const char *)load + scene_base_texts[i].offset, sizeof text);
        if (text)
            put_name(t, scene_base_texts[i].key, text);
    }
    if (load->at_seconds) {
        json_text_key(t, "at_seconds");
        json_text_double(t, *load->at_seconds);
    }
    fields_write_changed(scene_base_fields, 3, load, &nothing, t);
    json_text_close(t);
    if (!ok && err)
        *err = problem;
    return ok;
}

// --- environment ---------------------------------------------------------------------------------

static bool same_source(const struct environment *a, const struct environment *b)
{
    return a->present == b->present && a->texels == b->texels && a->width == b->width &&
           a->height == b->height && a->file == b->file && a->sky == b->sky &&
           a->gradient == b->gradient;
}

// Writes the source of the environment; "edits" rotates and scales the environment.
static bool put_environment(struct writer *w, struct json_text *t, struct err *err)
{
    const struct environment *environment = &w->params->scene->environment;
    bool ok = true;
    json_text_key(t, "environment");
    json_text_open(t, '{', true);
    if (!environment->present) {
        put_name(t, "type", "none");
    } else if (environment->sky) {
        put_name(t, "type", "sky");
        fields_write(scene_sky_fields, 5, environment->sky, t);
    } else if (environment->gradient) {
        put_name(t, "type", "gradient");
        fields_write(scene_gradient_fields, 3, environment->gradient, t);
    } else {
        ok = !environment->file || put_path(w, t, "file", environment->file, err);
        field_write(&scene_environment_fields[0], environment, t);
    }
    json_text_close(t);
    return ok;
}

// --- the document --------------------------------------------------------------------------------

static bool put_document(struct writer *w, struct json_text *t, struct err *err)
{
    json_text_open(t, '{', false);
    json_text_key(t, "lampyris");
    json_text_uint(t, 1);
    if (!put_base(w, t, err))
        return false;
    json_text_key(t, "camera");
    put_camera(t, &w->camera);
    put_settings(t, "film", &w->settings, SETTINGS_FILM_FIRST, SETTINGS_FILM_LAST);
    put_settings(t, "settings", &w->settings, SETTINGS_FILM_LAST + 1, SETTING_TOTAL - 1);
    if (w->difference.has_other_environment && !put_environment(w, t, err))
        return false;
    if (w->is_outside)
        put_name(t, "comment",
                 "refers to files outside of this folder: loading it needs --allow-outside-paths");
    scene_write_edits(t, &w->difference);
    json_text_close(t);
    json_text_raw(t, "\n");
    return true;
}

static char *make_text(struct writer *w, struct err *err)
{
    struct json_text t;
    if (!json_text_begin(&t, 0, err))
        return NULL;
    bool ok = put_document(w, &t, err);
    char *text = json_text_end(&t);
    if (ok)
        return text;
    free(text);
    return NULL;
}

// --- check of the document -----------------------------------------------------------------------

// Prepares the scene that the loader has before it reads the edits: the scene as loaded, or with
// the environment of the document.
static bool prepare_check(const struct writer *w, struct arena *arena, struct scene *out,
                          struct err *err)
{
    const struct scene *scene = w->params->scene;
    if (!scene_snapshot(arena, &w->before, out, err))
        return false;
    out->settings = settings_default();
    if (!w->difference.has_other_environment)
        return true;
    scene_remove_sun(out, &out->environment);
    out->environment = scene->environment;
    out->environment.rotation = 0;
    out->environment.sun.light = 0;
    if (scene_sun_light(scene) == SCENE_NONE)
        return true;
    struct light *sun = scene_add_light(out, NULL);
    if (!sun)
        return err_memory(err, "a sun", sizeof *sun);
    sun->name = "sun";
    out->environment.sun.light = out->light_count;
    return true;
}

static bool check_parts(const struct writer *w, struct scene *scene,
                        const struct json_node *document, struct err *err)
{
    struct json_loader loader = {.scene = scene, .params = w->params->load};
    const struct json_node camera = node_member(document, "camera");
    const struct json_node film = node_member(document, "film");
    const struct json_node settings = node_member(document, "settings");
    const struct json_node edits = node_member(document, "edits");
    if (!load_json_camera(&loader, &camera, err) || !load_json_film(&loader, &film, err) ||
        !load_json_settings(&loader, &settings, err) || !load_json_edits(&loader, &edits, err))
        return false;
    if (!scene_same_camera(&scene->cameras[scene->camera_count - 1], &w->camera))
        return node_fail(&camera, err,
                         "cannot be written exactly: is its direction of unit "
                         "length?");
    if (!settings_same(&scene->settings, &w->settings))
        return node_fail(&settings, err, "cannot be written exactly");
    return scene_compare_edits(scene, w->params->scene, err) || node_prepend(&edits, err);
}

// Reads the text as the loader would, on top of the scene as loaded, so that values that the format
// rejects or cannot represent are found before a file is written.
static bool check_text(const struct writer *w, const char *text, struct err *err)
{
    const struct file_bytes bytes = {(const uint8_t *)text, strlen(text)};
    json_t *root = json_parse(w->params->path, &bytes, JSON_REJECT_DUPLICATES, err);
    struct arena arena = {0};
    struct scene scene = {0};
    bool ok;
    if (!root) {
        if (err && err->code == ERR_INPUT)
            err->code = ERR_BUG; // because this program wrote the text
        ok = false;
    } else {
        const struct json_node document = node_root(w->params->path, root);
        ok = prepare_check(w, &arena, &scene, err) && check_parts(w, &scene, &document, err);
    }
    json_decref(root);
    arena_finish(&scene.arena);
    arena_finish(&arena);
    return ok;
}

// --- writing -------------------------------------------------------------------------------------

// Chooses the base of the new file: the file from which the scene was loaded, or that file's own
// base.
static void find_base(struct writer *w)
{
    const struct scene_load_params *load = w->params->load;
    const struct scene *before = w->params->before;
    w->before = *before;
    w->before.placed_count = 0; // if a file places objects, its base does not have these placements
    if (before->base) {
        const struct scene_base *base = before->base;
        w->base = *base;
        w->before.environment = base->environment;
        w->before.lights = base->lights;
        w->before.light_count = base->light_count;
        if (base->materials) {
            w->before.materials = base->materials;
            w->before.material_count = base->material_count;
        }
        if (base->instances)
            w->before.instances = base->instances;
        if (base->shapes) {
            w->before.shapes = base->shapes;
            w->before.shape_count = base->shape_count;
        }
        return;
    }
    // With an environment on the command line, no ground was added. When the new file is loaded,
    // its environment is applied after its base has been loaded, so the ground must be turned off
    // explicitly.
    bool is_lit = load->environment_file || load->environment_radiance || load->environment_sky;
    w->base = (struct scene_base){.load = *load,
                                  .override_paths = before->override_paths,
                                  .override_path_count = before->override_path_count};
    if (is_lit && !before->has_ground)
        w->base.load.ground = SCENE_GROUND_OFF;
}

static void choose_base(struct writer *w)
{
    const struct scene_pose *pose = w->params->pose;
    find_base(w);
    if (pose)
        w->base.load.at_seconds = pose->is_posed ? &pose->seconds : NULL;
}

static void choose_environment(struct writer *w)
{
    const struct scene_load_params *load = w->params->load;
    w->difference.has_other_environment =
        load->environment_file || load->environment_radiance || load->environment_sky ||
        !same_source(&w->params->scene->environment, &w->before.environment);
    w->difference.has_other_adjustment =
        load->environment_rotation != 0 || load->environment_strength;
}

static bool is_same_file(const char *a, const char *b)
{
    struct file_status x, y;
    return file_status(a, &x) && file_status(b, &y) && file_status_same(&x, &y);
}

// Checks the name, and that the file is not one on which the scene is based.
static bool check_path(const struct writer *w, struct err *err)
{
    const char *path = w->params->path;
    if (!path_has_extension(path, "json"))
        return err_set(err, ERR_USAGE, "%s: expected a name that ends in .json", path);
    for (const struct scene_base *base = &w->base; base; base = base->base)
        if (is_same_file(path, base->load.path))
            return err_set(
                err, ERR_USAGE,
                "%s: is the file that the edited scene was loaded from; expected another name",
                path);
    return true;
}

static bool find_folder(struct writer *w, struct err *err)
{
    char *folder = path_folder(&w->arena, w->params->path);
    if (!folder)
        return err_memory(err, "a path", strlen(w->params->path));
    w->folder = real_path(w, folder, err);
    if (!w->folder && err && err->code == ERR_INPUT)
        err->code = ERR_OUTPUT; // the path is that of an output, not of an input
    return w->folder != NULL;
}

static bool write_scene(struct writer *w, struct err *err)
{
    const struct scene_write_params *params = w->params;
    char *text = NULL;
    choose_base(w);
    choose_environment(w);
    w->is_outside = params->load->allow_outside_paths;
    if (!check_path(w, err) || !find_folder(w, err) || !(text = make_text(w, err)))
        return false;
    if (strlen(text) > LOAD_JSON_BYTES_MAX) {
        err_set(err, ERR_INPUT, "%s: would have %zu bytes; expected at most %zu", params->path,
                strlen(text), LOAD_JSON_BYTES_MAX);
        free(text);
        return false;
    }
    // A scene that has a base may be saved to the file from which it was opened; check_path() has
    // ensured that the new file does not depend on the old one.
    if (is_same_file(params->path, params->load->path))
        file_inputs_forget(params->path);
    bool ok = check_text(w, text, err) && file_write_atomic(params->path, text, strlen(text), err);
    free(text);
    if (ok && params->is_outside)
        *params->is_outside = w->is_outside;
    return ok;
}

static struct writer writer_of(const struct scene_write_params *params)
{
    return (struct writer){
        .params = params,
        .difference = {.scene = params->scene},
        .settings = params->settings ? *params->settings : params->scene->settings,
        .camera = params->camera ? *params->camera : params->scene->cameras[0],
    };
}

bool scene_write_check(const struct scene_write_params *params, struct err *err)
{
    struct writer w = writer_of(params);
    choose_base(&w);
    bool ok = check_path(&w, err) && find_folder(&w, err) && file_check_writable(params->path, err);
    arena_finish(&w.arena);
    return ok;
}

bool scene_write(const struct scene_write_params *params, struct err *err)
{
    struct writer w = writer_of(params);
    w.difference.before = &w.before;
    bool ok = write_scene(&w, err);
    arena_finish(&w.arena);
    return ok;
}

// --- snapshots -----------------------------------------------------------------------------------

bool scene_snapshot(struct arena *arena, const struct scene *scene, struct scene *out,
                    struct err *err)
{
    *out = *scene;
    out->arena = (struct arena){0};
    out->materials =
        arena_copy(arena, scene->materials, scene->material_count, sizeof *scene->materials);
    out->lights = arena_copy(arena, scene->lights, scene->light_count, sizeof *scene->lights);
    out->instances =
        arena_copy(arena, scene->instances, scene->instance_count, sizeof *scene->instances);
    out->shapes = arena_copy(arena, scene->shapes, scene->shape_count, sizeof *scene->shapes);
    out->cameras = arena_copy(arena, scene->cameras, scene->camera_count, sizeof *scene->cameras);
    out->placed = arena_copy(arena, scene->placed, scene->placed_count, sizeof *scene->placed);
    if (!out->materials || !out->lights || !out->instances || !out->shapes || !out->cameras ||
        !out->placed) {
        *out = (struct scene){0};
        return err_memory(err, "a copy of the scene", scene->material_count);
    }
    out->material_capacity = out->material_count;
    out->light_capacity = out->light_count;
    out->instance_capacity = out->instance_count;
    out->shape_capacity = out->shape_count;
    out->camera_capacity = out->camera_count;
    out->placed_capacity = out->placed_count;
    return true;
}
