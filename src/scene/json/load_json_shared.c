// Keys and ranges, and readers of names and paths, that several sections of a scene file share.
#include "scene/json/load_json.h"

#include "base/file.h"
#include <string.h>

// "$schema" names the schema for text editors.
const char *const load_json_document_keys[] = {
    "lampyris", "define", "camera", "film",  "settings", "materials", "environment",
    "lights",   "shapes", "base",   "edits", "$schema",  NULL};

const struct range RANGE_UNIT = {0, 1, false};
const struct range RANGE_RADIANCE = {0, SCENE_RADIANCE_MAX, false};
const struct range RANGE_COORDINATE = {-SCENE_COORDINATE_MAX, SCENE_COORDINATE_MAX, false};
const struct range RANGE_RADIUS = {SCENE_LENGTH_MIN, SCENE_COORDINATE_MAX, false};

// --- names ---------------------------------------------------------------------------------------

bool load_json_material_name(const struct json_loader *loader, const struct json_node *shape,
                             uint32_t *material, struct err *err)
{
    const char *name = NULL;
    *material = SCENE_NONE;
    if (!node_read_string(shape, "material", &name, err))
        return false;
    if (!name)
        return true;
    const struct json_node node = node_member(shape, "material");
    const json_t *index = json_object_get(loader->material_names, name);
    if (!index)
        return node_fail(&node, err, "there is no material %s%s", node_describe(node.value).text,
                         node_suggest_key(name, loader->material_names).text);
    *material = (uint32_t)json_integer_value(index);
    return true;
}

bool load_json_find_part(const struct json_loader *loader, const struct json_node *name,
                         const struct scene_part *parts, struct scene_part *out, struct err *err)
{
    if (!json_is_string(name->value))
        return node_unexpected(name, "the name of a shape", err);
    const char *text = json_string_value(name->value);
    const json_t *index = json_object_get(loader->shape_names, text);
    if (!index)
        return node_fail(name, err, "there is no earlier shape named \"%s\"%s", text,
                         node_suggest_key(text, loader->shape_names).text);
    *out = parts[json_integer_value(index)];
    return true;
}

// --- paths ---------------------------------------------------------------------------------------

// Returns whether `wanted` is `value` itself, or inside it. Compares pointers, not contents.
static bool contains_value(const json_t *value, const json_t *wanted)
{
    if (value == wanted)
        return true;
    const char *key;
    json_t *child;
    size_t i;
    json_object_foreach((json_t *)value, key, child) if (contains_value(child, wanted)) return true;
    json_array_foreach(value, i, child) if (contains_value(child, wanted)) return true;
    return false;
}

static bool note_override_path(struct scene *scene, const char *text, const char *path,
                               struct err *err)
{
    text = arena_strdup(&scene->arena, text);
    struct scene_path *added = text ? scene_add_override_path(scene) : NULL;
    if (!added)
        return err_memory(err, "a path", sizeof *added);
    *added = (struct scene_path){text, path};
    return true;
}

const char *load_json_path(struct json_loader *loader, const struct json_node *object,
                           const char *key, struct err *err)
{
    struct arena *arena = &loader->scene->arena;
    const struct json_node node = node_member(object, key);
    const char *text = "", *path, *override_folder = loader->params->override_folder;
    if (!node_read_string(object, key, &text, err))
        return NULL;
    bool is_override = contains_value(loader->trusted, node.value);
    if (is_override && !override_folder) {
        path = arena_strdup(arena, text);
        if (!path)
            err_memory(err, "a path", strlen(text) + 1);
    } else {
        const struct file_reference reference = {
            .folder = is_override ? override_folder : loader->folder,
            .allow_outside = loader->params->allow_outside_paths,
        };
        path = file_resolve(arena, &reference, text, err);
    }
    if (!path || (is_override && !note_override_path(loader->scene, text, path, err))) {
        node_prepend(&node, err);
        return NULL;
    }
    return path;
}
