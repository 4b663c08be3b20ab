// The list of shapes of a scene file: mesh files, instances, and their placement.
#include "scene/json/load_json.h"

#include "base/file.h"
#include "scene/core/affine.h"
#include "scene/core/bounds.h"
#include <math.h>
#include <string.h>

// The part of the scene that each element of the list became, for instances of it.
struct shape_list {
    struct json_loader *loader;
    struct scene_part *parts;
    bool *hidden; // for each element, whether only its instances are visible
};

static bool transform_part(struct scene *scene, const struct scene_part *part,
                           const struct json_node *node, const double m[3][4], struct err *err)
{
    for (uint32_t i = 0; i < part->instance_count; i++) {
        struct instance *instance = &scene->instances[part->first_instance + i];
        affine_multiply(m, instance->transform, instance->transform);
    }
    for (uint32_t i = 0; i < part->shape_count; i++)
        if (!load_json_move_shape(node, m, &scene->shapes[part->first_shape + i], err))
            return false;
    return true;
}

// --- mesh files ----------------------------------------------------------------------------------

static bool load_file(struct json_loader *loader, const char *path, uint32_t material,
                      struct err *err)
{
    struct scene *scene = loader->scene;
    bool allow_outside = loader->params->allow_outside_paths;
    uint32_t mesh;
    if (path_has_extension(path, "gltf") || path_has_extension(path, "glb"))
        return load_gltf_into(scene, path, AFFINE_IDENTITY, allow_outside, err);
    if (!is_mesh_file(path))
        return err_set(err, ERR_INPUT,
                       "%s: extension \"%s\" is unknown; expected obj, ply, stl, gltf or glb%s",
                       path, path_extension(path), mesh_file_hint(path));
    return load_mesh_by_extension(scene, path, material, allow_outside, &mesh, err) &&
           scene_place_meshes(scene, mesh, 1, err);
}

// Places a mesh that the calling program provides in arrays.
static bool load_named_array(struct json_loader *loader, const struct json_node *node,
                             uint32_t material, struct err *err)
{
    const struct scene_load_params *params = loader->params;
    const char *name = "";
    const struct json_node array = node_member(node, "array");
    if (!node_read_string(node, "array", &name, err))
        return false;
    uint32_t i = 0, mesh;
    while (i < params->array_count && strcmp(params->arrays[i].name, name) != 0)
        i++;
    if (i == params->array_count)
        return node_fail(
            &array, err,
            "there are no arrays for a mesh \"%s\"; only a program that loads the scene can "
            "provide arrays; expected \"file\"",
            name);
    if (!load_array(loader->scene, &params->arrays[i], material, &mesh, err))
        return node_prepend(&array, err);
    return scene_place_meshes(loader->scene, mesh, 1, err);
}

static bool load_mesh(struct json_loader *loader, const struct json_node *node, uint32_t material,
                      struct err *err)
{
    struct scene *scene = loader->scene;
    uint32_t first_instance = scene->instance_count;
    if (!node_check_either(node, "file", "array", err))
        return false;
    if (node_member(node, "array").value)
        return load_named_array(loader, node, material, err);
    const struct json_node file = node_member(node, "file");
    const char *path = load_json_path(loader, node, "file", err);
    if (!path)
        return false;
    if (!load_file(loader, path, material, err))
        return node_prepend(&file, err);
    if (material != SCENE_NONE)
        for (uint32_t i = first_instance; i < scene->instance_count; i++)
            scene->instances[i].material = material;
    return true;
}

// Scales the part uniformly to the largest size that fits into the box, centres it in x and z, and
// puts it on the floor of the box.
static bool fit_part(struct scene *scene, const struct scene_part *part,
                     const struct json_node *node, struct err *err)
{
    static const char *const required[] = {"min", "max", NULL};
    static const char *const optional[] = {NULL};
    double low[3], high[3];
    if (!node_check_object(node, required, optional, err) ||
        !node_read_vector(node, "min", RANGE_COORDINATE, low, err) ||
        !node_read_vector(node, "max", RANGE_COORDINATE, high, err))
        return false;
    const struct bounds bounds = bounds_of_part(scene, part);
    double scale = INFINITY;
    for (int i = 0; i < 3; i++) {
        if (!(low[i] < high[i]))
            return node_fail(node, err, "max[%d] %.9g is not above min[%d] %.9g", i, high[i], i,
                             low[i]);
        if (bounds.max[i] > bounds.min[i])
            scale = fmin(scale, (high[i] - low[i]) / (bounds.max[i] - bounds.min[i]));
    }
    if (!isfinite(scale) || !(scale > 0))
        return node_fail(node, err, "the mesh has no size; expected one that can be scaled");
    double fit[3][4] = {{scale, 0, 0, 0}, {0, scale, 0, 0}, {0, 0, scale, 0}};
    for (int i = 0; i < 3; i++)
        fit[i][3] = (low[i] + high[i] - scale * (bounds.min[i] + bounds.max[i])) / 2;
    fit[1][3] = low[1] - scale * bounds.min[1];
    return transform_part(scene, part, node, fit, err);
}

// --- instances -----------------------------------------------------------------------------------

static bool load_instance(struct shape_list *list, const struct json_node *node, uint32_t material,
                          struct err *err)
{
    struct scene *scene = list->loader->scene;
    const struct json_node of = node_member(node, "of");
    struct scene_part original;
    if (!load_json_find_part(list->loader, &of, list->parts, &original, err))
        return false;
    for (uint32_t i = 0; i < original.instance_count; i++) {
        struct instance *copy = scene_add_instance(scene, NULL);
        if (!copy)
            return err_memory(err, "an instance", sizeof *copy);
        *copy = scene->instances[original.first_instance + i];
        if (material != SCENE_NONE)
            copy->material = material;
    }
    for (uint32_t i = 0; i < original.shape_count; i++) {
        struct shape *copy = scene_add_shape(scene, NULL);
        if (!copy)
            return err_memory(err, "a shape", sizeof *copy);
        *copy = scene->shapes[original.first_shape + i];
        if (material != SCENE_NONE)
            copy->material = material;
    }
    return true;
}

// --- the list ------------------------------------------------------------------------------------

static bool register_name(struct json_loader *loader, const struct json_node *shape, size_t index,
                          struct err *err)
{
    const char *name = NULL;
    if (!node_read_string(shape, "name", &name, err))
        return false;
    if (!name)
        return true;
    const struct json_node node = node_member(shape, "name");
    if (!node_check_name(&node, name, err))
        return false;
    if (json_object_get(loader->shape_names, name))
        return node_fail(&node, err, "another shape is already named \"%s\"", name);
    return json_object_set_new(loader->shape_names, name, json_integer((json_int_t)index)) == 0 ||
           err_memory(err, "a name", strlen(name));
}

static bool add_in_own_space(struct shape_list *list, const struct json_node *node,
                             enum shape_type type, struct err *err)
{
    static load_json_shape_fn *const loaders[SHAPE_TYPE_COUNT] = {
        [SHAPE_TYPE_QUAD] = load_json_quad,
        [SHAPE_TYPE_BOX] = load_json_box,
        [SHAPE_TYPE_SPHERE] = load_json_sphere,
        [SHAPE_TYPE_DISC] = load_json_disc,
        [SHAPE_TYPE_PLANE] = load_json_plane,
        [SHAPE_TYPE_CYLINDER] = load_json_cylinder,
        [SHAPE_TYPE_GENERATED] = load_json_generated,
        [SHAPE_TYPE_TORUS] = load_json_torus,
        [SHAPE_TYPE_STADIUM] = load_json_stadium,
        [SHAPE_TYPE_TEAPOT] = load_json_teapot,
        [SHAPE_TYPE_SDF] = load_json_sdf,
        [SHAPE_TYPE_PHONG_SPHERES] = load_json_phong_spheres,
        [SHAPE_TYPE_FIGURE] = load_json_figure,
    };
    uint32_t material;
    if (!load_json_material_name(list->loader, node, &material, err))
        return false;
    if (loaders[type])
        return loaders[type](list->loader->scene, node, material, err);
    switch (type) {
    case SHAPE_TYPE_MESH:
        return load_mesh(list->loader, node, material, err);
    case SHAPE_TYPE_SCATTER:
        return load_json_scatter(list->loader, node, err);
    case SHAPE_TYPE_INSTANCE:
        return load_instance(list, node, material, err);
    case SHAPE_TYPE_STREW:
        return load_json_strew(list->loader, node, list->parts, err);
    default:
        break;
    }
    return err_set(err, ERR_BUG, "shape type %d has no loader", (int)type);
}

// Makes a part visible or hidden. An instance of a hidden part is visible unless its own "visible"
// is false.
static void set_visible(struct scene *scene, const struct scene_part *part, bool visible)
{
    for (uint32_t i = 0; i < part->instance_count; i++)
        scene->instances[part->first_instance + i].hidden = !visible;
    for (uint32_t i = 0; i < part->shape_count; i++)
        scene->shapes[part->first_shape + i].hidden = !visible;
}

static bool load_shape(struct shape_list *list, const struct json_node *node, struct err *err)
{
    struct scene *scene = list->loader->scene;
    struct scene_part *part = &list->parts[node->index];
    uint32_t type;
    *part = (struct scene_part){scene->instance_count, 0, scene->shape_count, 0};
    if (!load_json_shape_type(node, &type, err) ||
        !add_in_own_space(list, node, (enum shape_type)type, err))
        return false;
    part->instance_count = scene->instance_count - part->first_instance;
    part->shape_count = scene->shape_count - part->first_shape;

    const struct json_node transform = node_member(node, "transform");
    const struct json_node fit = node_member(node, "fit");
    double m[3][4];
    if (transform.value && (!load_json_transform(&transform, m, err) ||
                            !transform_part(scene, part, &transform, m, err)))
        return false;
    if (fit.value && !fit_part(scene, part, &fit, err))
        return false;
    bool visible = true;
    if (!node_read_boolean(node, "hidden", &list->hidden[node->index], err) ||
        !node_read_boolean(node, "visible", &visible, err))
        return false;
    set_visible(scene, part, visible);
    return register_name(list->loader, node, node->index, err);
}

// Removes the parts of hidden shapes from the scene's arrays.
static void remove_hidden(struct shape_list *list, size_t count)
{
    struct scene *scene = list->loader->scene;
    uint32_t instances = count ? list->parts[0].first_instance : scene->instance_count;
    uint32_t shapes = count ? list->parts[0].first_shape : scene->shape_count;
    for (size_t i = 0; i < count; i++) {
        const struct scene_part *part = &list->parts[i];
        if (list->hidden[i])
            continue;
        if (part->instance_count > 0)
            memmove(&scene->instances[instances], &scene->instances[part->first_instance],
                    part->instance_count * sizeof *scene->instances);
        if (part->shape_count > 0)
            memmove(&scene->shapes[shapes], &scene->shapes[part->first_shape],
                    part->shape_count * sizeof *scene->shapes);
        instances += part->instance_count;
        shapes += part->shape_count;
    }
    scene->instance_count = instances;
    scene->shape_count = shapes;
}

bool load_json_shapes(struct json_loader *loader, const struct json_node *shapes, struct err *err)
{
    if (!node_check_array(shapes, 0, UINT32_MAX, err) || !load_json_check_memory(shapes, err))
        return false;
    size_t count = json_array_size(shapes->value);
    struct arena *arena = &loader->scene->arena;
    struct shape_list list = {loader, ARENA_NEW(arena, struct scene_part, count),
                              ARENA_NEW(arena, bool, count)};
    if (!list.parts || !list.hidden)
        return err_memory(err, "the list of shapes", count * sizeof *list.parts);
    for (size_t i = 0; i < count; i++) {
        const struct json_node shape = node_element(shapes, i);
        if (!scene_goes_on(loader->scene, 0, err) || !load_shape(&list, &shape, err))
            return false;
    }
    remove_hidden(&list, count);
    return true;
}
