// Parses the JSON of a glTF document and checks its structure: version, extensions, arrays.
#include "scene/gltf/gltf_document.h"

#include "base/file.h"
#include "json/json_parse.h"
#include "scene/gltf/gltf_buffer.h"
#include <float.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const list_names[GLTF_LIST_COUNT] = {
    [GLTF_ACCESSORS] = "accessors", [GLTF_ANIMATIONS] = "animations",
    [GLTF_BUFFERS] = "buffers",     [GLTF_BUFFER_VIEWS] = "bufferViews",
    [GLTF_CAMERAS] = "cameras",     [GLTF_IMAGES] = "images",
    [GLTF_MATERIALS] = "materials", [GLTF_MESHES] = "meshes",
    [GLTF_NODES] = "nodes",         [GLTF_SAMPLERS] = "samplers",
    [GLTF_SCENES] = "scenes",       [GLTF_SKINS] = "skins",
    [GLTF_TEXTURES] = "textures",
};

#define QUANTIZATION "KHR_mesh_quantization"

// The extensions that the loader supports; a file may require these.
static const char *const known_extensions[] = {
    "EXT_mesh_gpu_instancing",
    "EXT_meshopt_compression",
    "EXT_texture_webp",
#ifdef HAS_DRACO
    "KHR_draco_mesh_compression",
#endif
    "KHR_lights_punctual",
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_diffuse_transmission",
    "KHR_materials_dispersion",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_variants",
    "KHR_materials_volume",
    QUANTIZATION,
    "KHR_texture_transform",
    NULL,
};

#undef gltf_no_memory // this file defines the function itself
bool gltf_no_memory(const struct gltf_document *document, const char *what, uint64_t bytes,
                    struct err *err)
{
    err_memory(err, what, bytes);
    return err_prepend(err, "%s", document->source->path);
}

// --- readers -------------------------------------------------------------------------------------

bool gltf_require(const struct json_node *object, const char *key, struct err *err)
{
    if (json_object_get(object->value, key))
        return true;
    return node_fail(object, err, "\"%s\" is missing", key);
}

bool gltf_read_index(const struct json_node *object, const char *key, uint32_t count, uint32_t *out,
                     struct err *err)
{
    const struct json_node node = node_member(object, key);
    uint64_t index = GLTF_NONE;
    if (!node_read_integer(object, key, 0, INT64_MAX, &index, err))
        return false;
    if (node.value && index >= count)
        return node_fail(&node, err, "%llu; expected an index below %u", (unsigned long long)index,
                         count);
    *out = (uint32_t)index;
    return true;
}

bool gltf_find(const struct gltf_document *document, enum gltf_list list, const char *what,
               const char *wanted, uint32_t *out, struct err *err)
{
    for (*out = 0; *out < document->counts[list]; ++*out) {
        const struct json_node node = gltf_item(document, list, *out);
        const char *name = json_string_value(json_object_get(node.value, "name"));
        if (name && strcmp(name, wanted) == 0)
            return true;
    }
    char *end;
    unsigned long index = strtoul(wanted, &end, 10);
    *out = (uint32_t)index;
    if (*wanted >= '0' && *wanted <= '9' && *end == '\0' && index < document->counts[list])
        return true;
    return err_set(err, ERR_USAGE, "%s: has no %s \"%s\"; expected a name or an index below %u",
                   document->source->path, what, wanted, document->counts[list]);
}

bool gltf_read_object(const struct json_node *object, const char *key, struct json_node *out,
                      struct err *err)
{
    *out = node_member(object, key);
    if (out->value && !json_is_object(out->value))
        return node_unexpected(out, "an object", err);
    return true;
}

bool gltf_read_array(const struct json_node *object, const char *key, struct json_node *out,
                     struct err *err)
{
    *out = node_member(object, key);
    return !out->value || node_check_array(out, 0, GLTF_MAX_COUNT, err);
}

bool gltf_read_extension(const struct json_node *object, const char *name,
                         struct json_node *extensions, struct json_node *out, struct err *err)
{
    return gltf_read_object(object, "extensions", extensions, err) &&
           gltf_read_object(extensions, name, out, err);
}

bool gltf_read_name(const struct json_node *object, struct arena *arena, const char **out,
                    struct err *err)
{
    const char *name = "";
    if (!node_read_string(object, "name", &name, err))
        return false;
    *out = *name ? arena_strdup(arena, name) : "";
    return *out || err_memory(err, "a name", strlen(name) + 1);
}

bool gltf_read_numbers(const struct json_node *object, const char *key, size_t count, double *out,
                       struct err *err)
{
    // The parser rejects numbers that a double cannot hold, so every number is finite.
    const struct range any = {-DBL_MAX, DBL_MAX, false};
    const struct json_node node = node_member(object, key);
    return !node.value || node_numbers(&node, count, any, out, err);
}

struct json_node gltf_item(const struct gltf_document *document, enum gltf_list list,
                           uint32_t index)
{
    return node_element(&document->lists[list], index);
}

// --- JSON ----------------------------------------------------------------------------------------

static bool parse_json(struct gltf_document *document, const struct file_bytes *text,
                       struct err *err)
{
    const char *path = document->source->path;
    document->json = json_parse(path, text, JSON_REJECT_DUPLICATES, err);
    if (!document->json)
        return false;
    document->root = node_root(path, document->json);
    return json_is_object(document->json) || node_unexpected(&document->root, "an object", err);
}

// --- asset and extensions ------------------------------------------------------------------------

// Parses "MAJOR.MINOR"; only digits are allowed around the dot.
static bool parse_version(const char *text, unsigned *major, unsigned *minor)
{
    static const char digits[] = "0123456789";
    size_t before = strspn(text, digits);
    size_t after = text[before] == '.' ? strspn(text + before + 1, digits) : 0;
    if (before == 0 || before > 4 || after == 0 || after > 4 || text[before + 1 + after] != '\0')
        return false;
    return sscanf(text, "%u.%u", major, minor) == 2;
}

static bool check_version(const struct json_node *asset, const char *key, struct err *err)
{
    const struct json_node node = node_member(asset, key);
    const char *text = NULL;
    unsigned major = 0, minor = 0;
    if (!node.value)
        return true;
    if (!node_read_string(asset, key, &text, err))
        return false;
    if (!parse_version(text, &major, &minor))
        return node_unexpected(&node, "a version like \"2.0\"", err);
    // A file that needs more than version 2.0 gives minVersion; "version" itself may be any 2.x.
    bool is_minimum = strcmp(key, "minVersion") == 0;
    if (major != 2 || (is_minimum && minor > 0))
        return node_unexpected(&node, is_minimum ? "\"2.0\"" : "a version 2.x", err);
    return true;
}

static bool check_asset(const struct gltf_document *document, struct err *err)
{
    struct json_node asset;
    return gltf_require(&document->root, "asset", err) &&
           gltf_read_object(&document->root, "asset", &asset, err) &&
           gltf_require(&asset, "version", err) && check_version(&asset, "version", err) &&
           check_version(&asset, "minVersion", err);
}

static bool is_known_extension(const char *name)
{
    for (const char *const *known = known_extensions; *known; known++)
        if (strcmp(name, *known) == 0)
            return true;
    return false;
}

static bool read_extension_names(const struct gltf_document *document, const char *key,
                                 struct json_node *out, struct err *err)
{
    if (!gltf_read_array(&document->root, key, out, err))
        return false;
    for (size_t i = 0; i < json_array_size(out->value); i++) {
        const struct json_node name = node_element(out, i);
        if (!json_is_string(name.value))
            return node_unexpected(&name, "a string", err);
    }
    return true;
}

// Returns how to make a file without the extension; "" if there is nothing to say.
static const char *extension_hint(const char *name)
{
    if (strcmp(name, "KHR_draco_mesh_compression") == 0)
        return " by this build of Lampyris, which lacks libdraco; expected a file without it, such "
               "as Blender exports with compression off";
    if (strcmp(name, "KHR_texture_basisu") == 0)
        return "; expected textures in PNG, JPEG or WebP, to which glTF-Transform converts KTX2";
    return "";
}

static bool check_extensions_required(const struct gltf_document *document, struct err *err)
{
    struct json_node required;
    if (!read_extension_names(document, "extensionsRequired", &required, err))
        return false;
    for (size_t i = 0; i < json_array_size(required.value); i++) {
        const struct json_node node = node_element(&required, i);
        const char *name = json_string_value(node.value);
        if (!is_known_extension(name))
            return node_fail(&node, err, "the extension \"%.64s\" is not supported%s", name,
                             extension_hint(name));
    }
    return true;
}

// Joins the names of `used` that are unknown into document->ignored_extensions.
static bool list_ignored_extensions(struct gltf_document *document, const struct json_node *used,
                                    struct err *err)
{
    size_t size = 0;
    for (size_t i = 0; i < json_array_size(used->value); i++)
        size += strlen(json_string_value(json_array_get(used->value, i))) + 2;
    char *list = ARENA_NEW(&document->arena, char, size);
    if (!list)
        return gltf_no_memory(document, "the names of extensions", size, err);
    char *end = list;
    for (size_t i = 0; i < json_array_size(used->value); i++) {
        const char *name = json_string_value(json_array_get(used->value, i));
        if (is_known_extension(name))
            continue;
        end += snprintf(end, size - (size_t)(end - list), "%s%s", end > list ? ", " : "", name);
    }
    document->ignored_extensions = end > list ? list : NULL;
    return true;
}

static bool read_extensions_used(struct gltf_document *document, struct err *err)
{
    struct json_node used;
    if (!read_extension_names(document, "extensionsUsed", &used, err))
        return false;
    for (size_t i = 0; i < json_array_size(used.value); i++)
        if (strcmp(json_string_value(json_array_get(used.value, i)), QUANTIZATION) == 0)
            document->is_quantized = true;
    return list_ignored_extensions(document, &used, err);
}

// --- opening -------------------------------------------------------------------------------------

static bool check_list(struct gltf_document *document, enum gltf_list list, struct err *err)
{
    struct json_node *node = &document->lists[list];
    if (!gltf_read_array(&document->root, list_names[list], node, err))
        return false;
    document->counts[list] = (uint32_t)json_array_size(node->value);
    for (uint32_t i = 0; i < document->counts[list]; i++) {
        const struct json_node item = node_element(node, i);
        if (!json_is_object(item.value))
            return node_unexpected(&item, "an object", err);
    }
    return true;
}

static bool check_frame(struct gltf_document *document, struct err *err)
{
    if (!check_asset(document, err) || !check_extensions_required(document, err) ||
        !read_extensions_used(document, err))
        return false;
    for (int list = 0; list < GLTF_LIST_COUNT; list++)
        if (!check_list(document, (enum gltf_list)list, err))
            return false;
    return true;
}

// Finds the JSON text and the binary chunk of a .gltf or .glb file.
static bool open_container(const struct gltf_source *source, struct glb_chunks *out,
                           struct err *err)
{
    *out = (struct glb_chunks){.json = source->bytes};
    if (glb_is_container(&source->bytes))
        return glb_open(&source->bytes, out, err) || err_prepend(err, "%s", source->path);
    if (path_has_extension(source->path, "glb"))
        return err_set(err, ERR_INPUT, "%s: does not begin with \"glTF\", as a GLB file does",
                       source->path);
    return true;
}

static bool allocate_accessors(struct gltf_document *document, struct err *err)
{
    const uint32_t count = document->counts[GLTF_ACCESSORS];
    document->decoded_accessors = ARENA_NEW(&document->arena, const void *, count);
    return document->decoded_accessors ||
           gltf_no_memory(document, "accessors", count * sizeof(void *), err);
}

bool gltf_document_open(struct gltf_document *document, const struct gltf_source *source,
                        struct err *err)
{
    *document = (struct gltf_document){.source = source};
    struct glb_chunks chunks;
    return open_container(source, &chunks, err) && parse_json(document, &chunks.json, err) &&
           check_frame(document, err) && gltf_buffers_load(document, &chunks.binary, err) &&
           gltf_meshopt_decode(document, err) && allocate_accessors(document, err);
}

void gltf_document_close(struct gltf_document *document)
{
    json_decref(document->json);
    arena_finish(&document->arena);
    *document = (struct gltf_document){0};
}

bool gltf_read_float(const struct json_node *object, const char *key, struct range range,
                     float *out, struct err *err)
{
    double value = (double)*out;
    if (!node_read_number(object, key, range, &value, err))
        return false;
    *out = (float)value;
    return true;
}
