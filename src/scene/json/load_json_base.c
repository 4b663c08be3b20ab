// Reads a document with a "base": loads that other scene file, then applies the differences of this
// one.
#include "scene/json/load_json.h"

#include "base/ascii.h"
#include "base/file.h"
#include "json/field_json.h"
#include "json/json_parse.h"
#include "scene/core/environment.h"
#include "scene/json/scene_edits.h"
#include "scene/json/scene_fields.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

// The maximum number of bases in a chain. More are an error, which also catches files that name
// themselves.
#define BASE_DEPTH_MAX 8

static const struct range RANGE_SECONDS = {-1e9, 1e9, false};

// --- loading the base ----------------------------------------------------------------------------

// Returns the text of an override's value, which load_json_apply_overrides() will parse again.
static const char *dump_value(struct arena *arena, const json_t *value)
{
    char *dumped = json_dumps(value, JSON_ENCODE_ANY | JSON_REAL_PRECISION(17));
    const char *kept = dumped ? arena_strdup(arena, dumped) : NULL;
    json_release(dumped);
    return kept;
}

static bool read_override(struct arena *arena, const struct json_node *node,
                          struct scene_override *out, struct err *err)
{
    static const char *const required[] = {"key", "value", NULL};
    static const char *const none[] = {NULL};
    const char *key = "";
    if (!node_check_object(node, required, none, err) || !node_read_string(node, "key", &key, err))
        return false;
    out->key = arena_strdup(arena, key);
    out->value = dump_value(arena, node_member(node, "value").value);
    return (out->key && out->value) || err_memory(err, "an override", strlen(key) + 1);
}

static bool read_overrides(struct json_loader *loader, const struct json_node *list,
                           struct scene_load_params *load, struct err *err)
{
    if (!list->value)
        return true;
    if (!path_has_extension(load->path, "json"))
        return node_fail(list, err, "are only possible for a .json base; this base is %s",
                         load->path);
    if (!node_check_array(list, 0, UINT32_MAX, err))
        return false;
    size_t count = json_array_size(list->value);
    struct arena *arena = &loader->scene->arena;
    struct scene_override *overrides = ARENA_NEW(arena, struct scene_override, count);
    if (!overrides)
        return err_memory(err, "overrides", count * sizeof *overrides);
    for (size_t i = 0; i < count; i++) {
        const struct json_node node = node_element(list, i);
        if (!read_override(arena, &node, &overrides[i], err))
            return false;
    }
    load->overrides = overrides;
    load->override_count = (uint32_t)count;
    return true;
}

static bool fail_not_gltf(const struct json_node *node, const struct scene_load_params *load,
                          struct err *err)
{
    return node_fail(node, err, "is only for .gltf and .glb files; the base is %s", load->path);
}

static bool read_gltf_choices(struct arena *arena, const struct json_node *node,
                              struct scene_load_params *load, struct err *err)
{
    const char *extension = path_extension(load->path);
    bool is_gltf = ascii_equal(extension, "gltf") || ascii_equal(extension, "glb");
    const struct json_node seconds = node_member(node, "at_seconds");
    double at = 0;
    for (size_t i = 0; i < sizeof scene_base_texts / sizeof *scene_base_texts; i++) {
        const struct json_node member = node_member(node, scene_base_texts[i].key);
        const char *text = NULL;
        if (!node_read_string(node, member.key, &text, err))
            return false;
        if (text && !is_gltf)
            return fail_not_gltf(&member, load, err);
        if (text && !(text = arena_strdup(arena, text)))
            return err_memory(err, "a name", 1);
        memcpy((char *)load + scene_base_texts[i].offset, &text, sizeof text);
    }
    if (!seconds.value)
        return true;
    if (!is_gltf)
        return fail_not_gltf(&seconds, load, err);
    load->at_seconds = arena_copy(arena, &at, 1, sizeof at);
    return load->at_seconds
               ? node_read_number(node, seconds.key, RANGE_SECONDS, (double *)load->at_seconds, err)
               : err_memory(err, "a time", sizeof at);
}

// Reads the parameters for loading the base. If the base has no light, the command line chooses
// light and ground, unless this file chooses them.
static bool read_base(struct json_loader *loader, const struct json_node *node,
                      struct scene_load_params *load, struct err *err)
{
    static const char *const required[] = {"file", NULL};
    static const char *const optional[] = {
        "overrides", "scene", "animation", "variant", "at_seconds", "studio", "ground", "up", NULL};
    const struct scene_load_params *own = loader->params;
    *load = (struct scene_load_params){.override_folder = loader->folder,
                                       .allow_outside_paths = own->allow_outside_paths,
                                       .base_depth = own->base_depth + 1,
                                       .studio = own->studio,
                                       .ground = own->ground,
                                       .up = own->up,
                                       .progress = own->progress};
    if (!node_check_object(node, required, optional, err) ||
        !fields_read(scene_base_fields, 3, node, load, err) ||
        !(load->path = load_json_path(loader, node, "file", err)))
        return false;
    const struct json_node overrides = node_member(node, "overrides");
    return read_overrides(loader, &overrides, load, err) &&
           read_gltf_choices(&loader->scene->arena, node, load, err);
}

// Turns a usage error into an input error, because the file caused it, not an option.
static bool blame_file(const struct json_node *file, struct err *err)
{
    if (err->code == ERR_USAGE)
        err->code = ERR_INPUT;
    return node_prepend(file, err);
}

static bool load_file(struct json_loader *loader, const struct json_node *node,
                      struct scene_base *base, struct err *err)
{
    struct scene *scene = loader->scene;
    const char *path = scene->path;
    const struct json_node file = node_member(node, "file");
    scene->up = base->load.up;
    if (base->load.base_depth > BASE_DEPTH_MAX)
        return node_fail(&file, err,
                         "ends a chain of %d bases; expected at most %d (does a file name itself?)",
                         BASE_DEPTH_MAX + 1, BASE_DEPTH_MAX);
    struct err problem = {0};
    if (!loader->load_base(scene, &base->load, &problem)) {
        blame_file(&file, &problem);
        if (err)
            *err = problem;
        return false;
    }
    scene->path = path;
    scene->placed_count = 0; // this file's placements are relative to the base
    base->base = scene->base;
    base->override_paths = scene->override_paths;
    base->override_path_count = scene->override_path_count;
    return true;
}

// --- the differences -----------------------------------------------------------------------------

// Copies the environment and the lights of the base, so that differences can be found later.
static bool keep_base(struct scene *scene, struct scene_base *base, struct err *err)
{
    base->environment = scene->environment;
    base->light_count = scene->light_count;
    base->lights =
        arena_copy(&scene->arena, scene->lights, scene->light_count, sizeof *scene->lights);
    return base->lights || err_memory(err, "lights", scene->light_count * sizeof *scene->lights);
}

// Puts the document's camera before those of the base, so that it is used by default; a framed
// camera is removed.
static bool put_camera_first(struct json_loader *loader, const struct json_node *node,
                             struct err *err)
{
    struct scene *scene = loader->scene;
    if (!load_json_camera(loader, node, err))
        return false;
    struct camera *cameras = scene->cameras, added = cameras[scene->camera_count - 1];
    if (scene->camera_is_framed)
        scene->camera_count = 1;
    else
        memmove(&cameras[1], &cameras[0], (scene->camera_count - 1) * sizeof *cameras);
    cameras[0] = added;
    scene->camera_is_framed = false;
    return true;
}

static bool replace_environment(struct json_loader *loader, const struct json_node *node,
                                struct err *err)
{
    const struct environment former = loader->scene->environment;
    if (!load_json_environment(loader, node, err))
        return false;
    scene_remove_sun(loader->scene, &former);
    return scene_add_sky_sun(loader->scene, err);
}

static bool check_keys(const struct json_node *document, struct err *err)
{
    static const char *const others[] = {"materials", "lights", "shapes"};
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        const struct json_node node = node_member(document, others[i]);
        if (node.value)
            return node_fail(
                &node, err,
                "cannot be combined with \"base\"; \"edits\" changes what the base has");
    }
    return true;
}

bool load_json_base(struct json_loader *loader, const struct json_node *document, struct err *err)
{
    struct scene *scene = loader->scene;
    const struct json_node node = node_member(document, "base");
    struct scene_base *base = ARENA_NEW(&scene->arena, struct scene_base, 1);
    if (!base)
        return err_memory(err, "a base", sizeof *base);
    loader->base = base;
    if (!check_keys(document, err) || !read_base(loader, &node, &base->load, err) ||
        !load_file(loader, &node, base, err) || !keep_base(scene, base, err) ||
        !load_json_section(loader, document, "film", load_json_film, err) ||
        !load_json_section(loader, document, "settings", load_json_settings, err) ||
        !load_json_section(loader, document, "camera", put_camera_first, err) ||
        !load_json_section(loader, document, "environment", replace_environment, err) ||
        !load_json_section(loader, document, "edits", load_json_edits, err))
        return false;
    scene_frame_camera(scene);
    scene->base = base;
    return true;
}
