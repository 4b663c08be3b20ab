// Reads a scene file of this program's format (.json) as a whole.
#include "scene/json/load_json.h"

#include "base/file.h"
#include "base/hash.h"
#include "json/json_parse.h"
#include <string.h>

#define FORMAT_VERSION 1

// The version is checked first, because a file of a later version may differ in any way.
static bool check_version(const struct json_node *document, struct err *err)
{
    if (!json_is_object(document->value))
        return node_unexpected(document, "an object", err);
    const struct json_node version = node_member(document, "lampyris");
    if (!version.value)
        return node_fail(document, err,
                         "\"lampyris\" is missing: a scene file begins {\"lampyris\": %d",
                         FORMAT_VERSION);
    if (json_is_integer(version.value) && json_integer_value(version.value) == FORMAT_VERSION)
        return true;
    return node_fail(&version, err, "is format version %s; this program reads version %d",
                     node_describe(version.value).text, FORMAT_VERSION);
}

bool load_json_section(struct json_loader *loader, const struct json_node *document,
                       const char *key, load_json_fn *load, struct err *err)
{
    const struct json_node section = node_member(document, key);
    return !section.value || load(loader, &section, err);
}

static bool load_sections(struct json_loader *loader, const struct json_node *document,
                          struct err *err)
{
    static const char *const none[] = {NULL};
    if (!node_check_object(document, none, load_json_document_keys, err))
        return false;
    const struct json_node edits = node_member(document, "edits");
    if (node_member(document, "base").value)
        return load_json_base(loader, document, err);
    if (edits.value)
        return node_fail(&edits, err, "requires a \"base\", the file that it edits");
    return load_json_section(loader, document, "camera", load_json_camera, err) &&
           load_json_section(loader, document, "film", load_json_film, err) &&
           load_json_section(loader, document, "settings", load_json_settings, err) &&
           load_json_section(loader, document, "materials", load_json_materials, err) &&
           load_json_section(loader, document, "environment", load_json_environment, err) &&
           load_json_section(loader, document, "lights", load_json_lights, err) &&
           load_json_section(loader, document, "shapes", load_json_shapes, err);
}

static bool load_document(const struct scene_load_params *params, scene_load_fn load_base,
                          struct scene *scene, json_t *root, struct err *err)
{
    const struct json_node document = node_root(params->path, root);
    json_t *trusted = json_array(), *material_names = json_object(), *shape_names = json_object();
    struct json_loader loader = {
        .scene = scene,
        .params = params,
        .load_base = load_base,
        .folder = path_folder(&scene->arena, params->path),
        .trusted = trusted,
        .material_names = material_names,
        .shape_names = shape_names,
    };
    bool ok;
    if (!trusted || !material_names || !shape_names || !loader.folder)
        ok = err_memory(err, "the scene loader", sizeof loader);
    else
        ok = check_version(&document, err) &&
             load_json_apply_overrides(&document, params, trusted, err) &&
             load_json_resolve_references(&document, err) && load_sections(&loader, &document, err);
    json_decref(trusted);
    json_decref(material_names);
    json_decref(shape_names);
    return ok;
}

static void hash_inputs(struct scene *scene, const struct file_bytes *bytes,
                        const struct scene_load_params *params)
{
    scene->hash = hash_bytes(scene->hash, bytes->data, bytes->size);
    for (uint32_t i = 0; i < params->override_count; i++) {
        // The terminating NUL bytes are included, so that different lists of strings have different
        // bytes.
        const char *key = params->overrides[i].key, *value = params->overrides[i].value;
        scene->hash = hash_bytes(scene->hash, key, strlen(key) + 1);
        scene->hash = hash_bytes(scene->hash, value, strlen(value) + 1);
    }
}

bool load_json(struct scene *scene, const struct scene_load_params *params, scene_load_fn load_base,
               struct err *err)
{
    struct file_bytes bytes = {.data = (const uint8_t *)params->text};
    if (params->text)
        bytes.size = strlen(params->text);
    else if (!file_read(&scene->arena, params->path, LOAD_JSON_BYTES_MAX, &bytes, err))
        return false;
    hash_inputs(scene, &bytes, params);
    json_t *root = json_parse(params->path, &bytes, JSON_REJECT_DUPLICATES, err);
    bool ok = root && load_document(params, load_base, scene, root, err);
    if (ok && json_lost_memory())
        ok = err_memory(err, "the JSON document", bytes.size);
    json_decref(root);
    return ok;
}
