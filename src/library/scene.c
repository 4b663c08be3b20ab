// Scenes: documents that can be changed, and meshes in arrays.
#include "library/library.h"

#include "base/file.h"
#include "base/file_system.h"
#include "json/json_parse.h"
#include <stdlib.h>
#include <string.h>

// --- life ----------------------------------------------------------------------------------------

void lampyris_scene_release(struct lampyris_scene *scene)
{
    if (!scene)
        return;
    struct lampyris_context *context = scene->context;
    loaded_release(scene->loaded);
    for (uint32_t i = 0; i < scene->mesh_count; i++)
        arena_finish(&scene->meshes[i].arena);
    json_decref(scene->document);
    arena_finish(&scene->arena);
    free(scene);
    library_unref(context);
}

static struct lampyris_scene *create(struct lampyris_context *context)
{
    struct lampyris_scene *scene = calloc(1, sizeof *scene);
    if (!scene) {
        err_memory(&context->err, "a scene", sizeof *scene);
        return NULL;
    }
    scene->context = context;
    scene->last_edit = &scene->edits;
    context->refs++;
    return scene;
}

// Splits each override "KEY=VALUE" and stores it.
static bool keep_overrides(struct lampyris_scene *scene, const char *const *overrides,
                           struct err *err)
{
    uint32_t count = 0;
    while (overrides && overrides[count])
        count++;
    scene->overrides = ARENA_NEW(&scene->arena, struct scene_override, count);
    if (!scene->overrides)
        return err_memory(err, "overrides", count * sizeof *scene->overrides);
    for (; scene->override_count < count; scene->override_count++) {
        const char *text = overrides[scene->override_count];
        char *key = arena_strdup(&scene->arena, text), *equals = key ? strchr(key, '=') : NULL;
        if (!key)
            return err_memory(err, "overrides", strlen(text) + 1);
        if (!equals || equals == key)
            return err_set(err, ERR_USAGE, "the override \"%s\": expected KEY=VALUE", text);
        *equals = '\0';
        scene->overrides[scene->override_count] = (struct scene_override){key, equals + 1};
    }
    return true;
}

static bool keep_params(struct lampyris_scene *scene, const struct lampyris_scene_params *params,
                        struct err *err)
{
    struct lampyris_scene_params given;
    if (!library_take(&given, sizeof given, params, "lampyris_scene_params", err))
        return false;
    scene->allow_outside_paths = given.allow_outside_paths;
    scene->is_strict = given.is_strict;
    return keep_overrides(scene, given.overrides, err);
}

static enum lampyris_status finish_creation(struct lampyris_scene *scene, bool ok,
                                            struct lampyris_scene **out)
{
    struct lampyris_context *context = scene->context;
    enum lampyris_status status = library_leave(context, ok);
    *out = ok ? scene : NULL;
    if (!ok)
        lampyris_scene_release(scene);
    return status;
}

static bool set_path(struct lampyris_scene *scene, const char *path, struct err *err)
{
    scene->is_repeatable = true;
    scene->is_model = !path_has_extension(path, "json");
    scene->path = arena_strdup(&scene->arena, path);
    scene->document_path =
        scene->is_model ? arena_printf(&scene->arena, "%s.json", path) : scene->path;
    return (scene->path && scene->document_path) || err_memory(err, "a path", strlen(path) + 6);
}

static bool check_model(const char *path, struct err *err)
{
    if (path_has_extension(path, "gltf") || path_has_extension(path, "glb") || is_mesh_file(path))
        return file_exists(path) || err_set(err, ERR_INPUT, "%s: there is no such file", path);
    return scene_unknown_extension(path, err);
}

enum lampyris_status lampyris_scene_load(struct lampyris_context *context, const char *path,
                                         const struct lampyris_scene_params *params,
                                         struct lampyris_scene **out)
{
    *out = NULL;
    if (!library_enter(context))
        return LAMPYRIS_INPUT;
    struct lampyris_scene *scene = create(context);
    if (!scene)
        return library_leave(context, false);
    struct err *err = &context->err;
    bool ok = set_path(scene, path, err) && keep_params(scene, params, err) &&
              (scene->is_model ? check_model(path, err) : scene_need_document(scene, err));
    if (!ok)
        err_locate(err, path, "");
    return finish_creation(scene, ok, out);
}

static json_t *parse(const char *name, const char *json, struct err *err)
{
    const struct file_bytes bytes = {(const uint8_t *)json, strlen(json)};
    return json_parse(name, &bytes, JSON_REJECT_DUPLICATES | JSON_DECODE_ANY, err);
}

enum lampyris_status lampyris_scene_parse(struct lampyris_context *context, const char *json,
                                          const char *folder,
                                          const struct lampyris_scene_params *params,
                                          struct lampyris_scene **out)
{
    *out = NULL;
    if (!library_enter(context))
        return LAMPYRIS_INPUT;
    struct lampyris_scene *scene = create(context);
    if (!scene)
        return library_leave(context, false);
    struct err *err = &context->err;
    scene->is_text = scene->is_edited = true;
    scene->path = scene->document_path =
        arena_printf(&scene->arena, folder && *folder ? "%s/%s" : "%s%s",
                     folder && *folder ? folder : "", "document.json");
    bool ok = (scene->path || err_memory(err, "a path", 16)) && keep_params(scene, params, err) &&
              (scene->document = parse(scene->path, json, err)) != NULL;
    return finish_creation(scene, ok, out);
}

// --- the document --------------------------------------------------------------------------------

// Makes a document that has the model's file as its base. The document is in the folder of this
// file (see set_path()), so it names the file without a folder.
static json_t *document_of_model(const struct lampyris_scene *scene)
{
    return json_pack("{s:i, s:{s:s}}", "lampyris", 1, "base", "file", path_name(scene->path));
}

bool scene_need_document(struct lampyris_scene *scene, struct err *err)
{
    struct file_bytes bytes;
    struct arena scratch = {0};
    if (scene->document)
        return true;
    if (scene->is_model) {
        scene->document = document_of_model(scene);
        return scene->document || err_memory(err, "a document", strlen(scene->path));
    }
    if (file_read(&scratch, scene->path, 0, &bytes, err))
        scene->document = json_parse(scene->path, &bytes, JSON_REJECT_DUPLICATES, err);
    arena_finish(&scratch);
    return scene->document != NULL;
}

static void note_change(struct lampyris_scene *scene)
{
    scene->is_edited = true;
    loaded_release(scene->loaded);
    scene->loaded = NULL;
}

static char *dump(const json_t *value, struct err *err)
{
    char *dumped = json_dumps(value, JSON_ENCODE_ANY | JSON_REAL_PRECISION(17));
    char *text = dumped ? strdup(dumped) : NULL;
    json_release(dumped);
    if (!text)
        err_memory(err, "a document", 1);
    return text;
}

static bool get(struct lampyris_scene *scene, const char *pointer, char **json, struct err *err)
{
    const json_t *value;
    return scene_need_document(scene, err) &&
           (value = pointer_find(scene->document, pointer, err)) != NULL &&
           (*json = dump(value, err)) != NULL;
}

enum lampyris_status lampyris_scene_get(struct lampyris_scene *scene, const char *pointer,
                                        char **json)
{
    *json = NULL;
    if (!library_enter(scene->context))
        return LAMPYRIS_INPUT;
    return library_leave(scene->context, get(scene, pointer, json, &scene->context->err));
}

void lampyris_text_release(char *text)
{
    free(text);
}

// Returns whether the value names a file. Such a value is not repeated as an override, because a
// path on the command line is relative to the working directory, but a path in a document is
// relative to the document's folder.
static bool names_a_file(const json_t *value)
{
    const char *key;
    json_t *child;
    size_t i;
    json_object_foreach((json_t *)value, key,
                        child) if (strcmp(key, "file") == 0 || names_a_file(child)) return true;
    json_array_foreach(value, i, child) if (names_a_file(child)) return true;
    return false;
}

// Records the change for the command that repeats a render, or records that no command can make it.
static void keep_edit(struct lampyris_scene *scene, const char *pointer, const char *json,
                      bool is_override)
{
    struct arena *arena = &scene->arena;
    const char *last = strrchr(pointer, '/');
    struct scene_edit *edit = is_override && !(last && strcmp(last, "/file") == 0) &&
                                      scene->is_repeatable && !scene->is_model
                                  ? ARENA_NEW(arena, struct scene_edit, 1)
                                  : NULL;
    if (edit) {
        edit->key = pointer_key(pointer, arena);
        edit->value = arena_strdup(arena, json);
    }
    scene->is_repeatable = edit && edit->key && edit->value;
    if (!scene->is_repeatable)
        return;
    *scene->last_edit = edit;
    scene->last_edit = &edit->next;
}

static bool set(struct lampyris_scene *scene, const char *pointer, const char *json,
                struct err *err)
{
    bool is_made;
    json_t *value = parse("the value", json, err);
    if (!value || !scene_need_document(scene, err)) {
        json_decref(value);
        return false;
    }
    bool has_file = names_a_file(value);
    if (!pointer_set(&scene->document, pointer, value, &is_made, err))
        return false;
    keep_edit(scene, pointer, json, !is_made && !has_file);
    note_change(scene);
    return true;
}

enum lampyris_status lampyris_scene_set(struct lampyris_scene *scene, const char *pointer,
                                        const char *json)
{
    if (!library_enter(scene->context))
        return LAMPYRIS_INPUT;
    return library_leave(scene->context, set(scene, pointer, json, &scene->context->err));
}

enum lampyris_status lampyris_scene_remove(struct lampyris_scene *scene, const char *pointer)
{
    struct err *err = &scene->context->err;
    if (!library_enter(scene->context))
        return LAMPYRIS_INPUT;
    bool ok = scene_need_document(scene, err) && pointer_remove(scene->document, pointer, err);
    if (ok) {
        scene->is_repeatable = false;
        note_change(scene);
    }
    return library_leave(scene->context, ok);
}

// --- meshes --------------------------------------------------------------------------------------

// Copies an array with the gaps between its elements. Bytes after the last element may not belong
// to the caller, so they are not read.
static bool copy_array(struct arena *arena, const void **data, size_t *stride, uint32_t count,
                       size_t bytes, struct err *err)
{
    size_t step = *stride ? *stride : bytes, total;
    if (!*data)
        return true;
    if (count == 0)
        return true;
    if (__builtin_mul_overflow(step, count - 1, &total) ||
        __builtin_add_overflow(total, bytes, &total))
        return err_set(
            err, ERR_USAGE,
            "an array of %u elements with a stride of %zu bytes exceeds the address space", count,
            step);
    *data = arena_copy(arena, *data, total, 1);
    return *data || err_memory(err, "a mesh", total);
}

static bool copy_arrays(struct scene_mesh *mesh, struct err *err)
{
    struct scene_array *a = &mesh->array;
    struct arena *arena = &mesh->arena;
    return copy_array(arena, &a->positions, &a->position_stride, a->vertex_count, 12, err) &&
           copy_array(arena, &a->normals, &a->normal_stride, a->vertex_count, 12, err) &&
           copy_array(arena, &a->uvs, &a->uv_stride, a->vertex_count, 8, err) &&
           copy_array(arena, &a->colors, &a->color_stride, a->vertex_count, 16, err) &&
           copy_array(arena, &a->indices, &a->index_stride, a->triangle_count, 12, err);
}

static bool make_mesh(const char *name, const struct lampyris_mesh *given, struct scene_mesh *out,
                      struct err *err)
{
    if (!given->positions && given->vertex_count > 0)
        return err_set(err, ERR_USAGE, "mesh \"%s\": there are no positions", name);
    out->array = (struct scene_array){
        .name = arena_strdup(&out->arena, name),
        .vertex_count = given->vertex_count,
        .triangle_count = given->triangle_count,
        .positions = given->positions,
        .position_stride = given->position_stride,
        .normals = given->normals,
        .normal_stride = given->normal_stride,
        .uvs = given->uvs,
        .uv_stride = given->uv_stride,
        .colors = given->colors,
        .color_stride = given->color_stride,
        .indices = given->indices,
        .index_stride = given->index_stride,
    };
    if (!out->array.name)
        return err_memory(err, "a name", strlen(name) + 1);
    return given->is_borrowed || copy_arrays(out, err);
}

static bool add_shape(struct lampyris_scene *scene, const char *name, const char *material,
                      struct err *err)
{
    bool is_made;
    json_t *shapes = json_object_get(scene->document, "shapes");
    json_t *shape = json_pack("{s:s, s:s, s:s, s:s*}", "type", "mesh", "array", name, "name", name,
                              "material", material);
    if (!shape)
        return err_set(err, ERR_USAGE,
                       "mesh \"%s\": its name or its material's name is not valid UTF-8", name);
    if (!shapes && json_object_set_new(scene->document, "shapes", json_array()) != 0) {
        json_decref(shape);
        return err_memory(err, "shapes", strlen(name));
    }
    return pointer_set(&scene->document, "/shapes/-", shape, &is_made, err);
}

static struct scene_mesh *find_mesh(struct lampyris_scene *scene, const char *name)
{
    for (uint32_t i = 0; i < scene->mesh_count; i++)
        if (strcmp(scene->meshes[i].array.name, name) == 0)
            return &scene->meshes[i];
    return NULL;
}

static bool store_mesh(struct lampyris_scene *scene, const char *name,
                       const struct scene_mesh *mesh, const char *material, struct err *err)
{
    struct scene_mesh *former = find_mesh(scene, name);
    if (former) {
        arena_finish(&former->arena);
        *former = *mesh;
        return true;
    }
    struct scene_mesh *added = arena_append(&scene->arena, &scene->meshes, &scene->mesh_count,
                                            &scene->mesh_capacity, sizeof *added, NULL);
    if (!added)
        return err_memory(err, "a mesh", sizeof *added);
    if (!add_shape(scene, name, material, err)) {
        scene->mesh_count--;
        return false;
    }
    *added = *mesh;
    return true;
}

static bool add_mesh(struct lampyris_scene *scene, const char *name,
                     const struct lampyris_mesh *mesh, struct err *err)
{
    struct lampyris_mesh given;
    struct scene_mesh made = {0};
    if (!library_take(&given, sizeof given, mesh, "lampyris_mesh", err))
        return false;
    if (!scene_need_document(scene, err))
        return false;
    if (!json_is_object(scene->document))
        return err_set(err, ERR_INPUT,
                       "%s: the document is not an object; expected {\"lampyris\": 1}",
                       scene->path);
    if (json_object_get(scene->document, "base"))
        return err_set(
            err, ERR_USAGE,
            "%s: mesh \"%s\" cannot be added to a model, or to a document with a \"base\"; "
            "expected a document that has the model as a shape {\"type\": \"mesh\", \"file\": ...}",
            scene->path, name);
    if (make_mesh(name, &given, &made, err) &&
        store_mesh(scene, name, &made, given.material, err)) {
        scene->is_repeatable = false;
        note_change(scene);
        return true;
    }
    arena_finish(&made.arena);
    return false;
}

enum lampyris_status lampyris_scene_add_mesh(struct lampyris_scene *scene, const char *name,
                                             const struct lampyris_mesh *mesh)
{
    if (!library_enter(scene->context))
        return LAMPYRIS_INPUT;
    return library_leave(scene->context, add_mesh(scene, name, mesh, &scene->context->err));
}
