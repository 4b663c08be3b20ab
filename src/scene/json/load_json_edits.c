// The section "edits": changes of a complete scene. Numbers are written as they are in memory,
// without rounding. Absent keys change nothing.
#include "scene/json/load_json.h"

#include "base/maths.h"
#include "json/field_json.h"
#include "scene/core/environment.h"
#include "scene/core/light.h"
#include "scene/core/placement.h"
#include "scene/json/scene_edits.h"
#include "scene/json/scene_fields.h"
#include <float.h>
#include <string.h>

static const char *const none[] = {NULL};

// --- references ----------------------------------------------------------------------------------

// A list of the scene whose elements have indices and names.
struct list {
    const char *what; // name of one element for messages, such as "material"
    uint32_t count;
    const char *(*name)(const struct scene *scene, uint32_t index);
};

static struct list materials_of(const struct scene *scene)
{
    return (struct list){"material", scene->material_count, scene_material_name};
}

static bool find_index(const struct json_node *node, const char *what, uint32_t count,
                       uint32_t *index, struct err *err)
{
    if (!json_is_integer(node->value))
        return node_unexpected(node, "a whole number", err);
    json_int_t value = json_integer_value(node->value);
    if (value < 0 || value >= (json_int_t)count)
        return node_fail(node, err, "there is no %s %lld; expected an index below %u", what,
                         (long long)value, count);
    *index = (uint32_t)value;
    return true;
}

// Finds the element with the name `node`, which must be unique.
static bool find_name(const struct scene *scene, const struct json_node *node,
                      const struct list *list, uint32_t *index, struct err *err)
{
    const char *wanted = json_string_value(node->value);
    uint32_t found = 0;
    if (!wanted)
        return node_unexpected(node, "a string", err);
    for (uint32_t i = 0; i < list->count; i++) {
        const char *name = list->name(scene, i);
        if (name && strcmp(name, wanted) == 0 && found++ == 0)
            *index = i;
    }
    if (found == 1)
        return true;
    if (found == 0)
        return node_fail(node, err, "the base has no %s %s", list->what,
                         node_describe(node->value).text);
    return node_fail(node, err, "the base has %u elements named %s; expected \"index\"", found,
                     node_describe(node->value).text);
}

static bool find(const struct scene *scene, const struct json_node *node, const struct list *list,
                 uint32_t *index, struct err *err)
{
    const struct json_node by_index = node_member(node, "index");
    const struct json_node by_name = node_member(node, "name");
    if (!json_is_object(node->value))
        return node_unexpected(node, "an object", err);
    if (!node_check_either(node, "index", "name", err))
        return false;
    return by_index.value ? find_index(&by_index, list->what, list->count, index, err)
                          : find_name(scene, &by_name, list, index, err);
}

// Checks that the object has no keys except those of the fields, and `others`.
static bool check_keys(const struct json_node *node, const char *const *others,
                       const struct scene_fields *fields, struct err *err)
{
    const char *known[2 * SCENE_FIELDS_MAX + 8] = {NULL};
    size_t count = 0;
    while (*others)
        known[count++] = *others++;
    for (size_t i = 0; i < fields->count; i++) {
        known[count++] = fields->list[i].key;
        if (fields->list[i].exact_key)
            known[count++] = fields->list[i].exact_key;
    }
    return node_check_object(node, none, known, err);
}

// --- additions -----------------------------------------------------------------------------------

// Reads whether the element is an addition rather than a change of an existing one.
static bool read_is_new(const struct json_node *node, bool *out, struct err *err)
{
    const struct json_node index = node_member(node, "index");
    if (!json_is_object(node->value))
        return node_unexpected(node, "an object", err);
    return node_read_boolean(node, "added", out, err) &&
           (!*out || !index.value ||
            node_fail(&index, err,
                      "cannot be combined with \"added\": additions follow all others"));
}

static bool read_new_name(struct scene *scene, const struct json_node *node, const char **out,
                          struct err *err)
{
    const char *name = "";
    if (!node_read_string(node, "name", &name, err))
        return false;
    *out = arena_strdup(&scene->arena, name);
    return *out || err_memory(err, "a name", strlen(name) + 1);
}

// --- materials -----------------------------------------------------------------------------------

static bool add_material(struct scene *scene, const struct json_node *node, uint32_t *index,
                         struct err *err)
{
    struct material *added = scene_add_material(scene, index);
    return (added || err_memory(err, "a material", sizeof *added)) &&
           read_new_name(scene, node, &added->name, err);
}

static bool edit_material(struct json_loader *loader, const struct json_node *node, struct err *err)
{
    static const char *const others[] = {"index", "name", "added", NULL};
    struct scene *scene = loader->scene;
    const struct list list = materials_of(scene);
    struct scene_fields fields;
    uint32_t index;
    bool is_new = false;
    scene_material_fields(&fields);
    return read_is_new(node, &is_new, err) &&
           (is_new ? add_material(scene, node, &index, err)
                   : find(scene, node, &list, &index, err)) &&
           check_keys(node, others, &fields, err) &&
           fields_read(fields.list, fields.count, node, &scene->materials[index], err);
}

// --- lights --------------------------------------------------------------------------------------

// Normalizes a vector that the file gives.
static bool make_unit(const struct json_node *object, const char *key, bool may_be_zero,
                      double vector[3], struct err *err)
{
    const struct json_node node = node_member(object, key);
    bool is_zero = vector[0] == 0 && vector[1] == 0 && vector[2] == 0;
    return !node.value || (is_zero && may_be_zero) || vec3_make_unit(vector) ||
           node_fail(&node, err, "is zero; expected a direction");
}

// Rejects "intensity" for directional lights, and "irradiance" for all others.
static bool check_radiant(const struct json_node *node, const struct light *light, struct err *err)
{
    bool is_directional = light->kind == LIGHT_DIRECTIONAL;
    const struct json_node wrong = node_member(node, is_directional ? "intensity" : "irradiance");
    return !wrong.value ||
           node_fail(&wrong, err, "is not for \"type\": \"%s\"; expected \"%s\"",
                     light_kind_names[light->kind], is_directional ? "irradiance" : "intensity");
}

// Edits a light's profile: it may be removed, and its plane at 0 degrees may be rotated.
static bool read_profile(const struct json_node *node, struct light *light, struct err *err)
{
    const struct json_node profile = node_member(node, "profile");
    const struct json_node x = node_member(node, "profile_x");
    if (profile.value && !json_is_false(profile.value))
        return node_unexpected(&profile, "false, which removes it", err);
    if (profile.value)
        light->profile = NULL;
    if (light->profile && light->kind == LIGHT_DIRECTIONAL)
        return node_fail(node, err,
                         "a directional light has no profile; expected \"profile\": false");
    // The kernels use both vectors in single precision.
    double along = vec3_dot(light->profile_x, light->direction);
    return !light->profile || fabs(along) <= (double)FLT_EPSILON ||
           node_fail(x.value ? &x : node, err,
                     "profile_x is not at a right angle to the direction; the dot product is %.9g",
                     along);
}

// Inserts a light with the defaults of a scene file before the sky's sun, which is the last light.
static bool add_light(struct scene *scene, const struct json_node *node, uint32_t *index,
                      struct err *err)
{
    struct light *added = scene_insert_light(scene, index);
    if (!added)
        return err_memory(err, "a light", sizeof *added);
    light_init(added);
    return read_new_name(scene, node, &added->name, err);
}

static bool edit_light(struct json_loader *loader, const struct json_node *node, struct err *err)
{
    static const char *const others[] = {"index",   "name",  "intensity", "irradiance",
                                         "profile", "added", "visible",   NULL};
    struct scene *scene = loader->scene;
    const struct list list = {"light", scene->light_count, scene_light_name};
    struct scene_fields fields;
    uint32_t index;
    bool is_new = false;
    scene_light_fields(LIGHT_POINT, &fields);
    if (!read_is_new(node, &is_new, err) || !check_keys(node, others, &fields, err) ||
        !(is_new ? add_light(scene, node, &index, err) : find(scene, node, &list, &index, err)))
        return false;
    struct light *light = &scene->lights[index];
    bool visible = !light->hidden;
    if (!node_read_boolean(node, "visible", &visible, err))
        return false;
    light->hidden = !visible;
    if (!field_read(&fields.list[0], node, light, err))
        return false;
    scene_light_fields(light->kind, &fields);
    if (!check_radiant(node, light, err) ||
        !fields_read(fields.list, fields.count, node, light, err) ||
        !make_unit(node, "direction", light->kind == LIGHT_POINT, light->direction, err) ||
        !make_unit(node, "profile_x", true, light->profile_x, err) ||
        !load_json_check_light(node, light, err) || !read_profile(node, light, err))
        return false;
    return light->kind == LIGHT_POINT || vec3_dot(light->direction, light->direction) != 0 ||
           node_fail(node, err, "has no direction so far; expected \"direction\"");
}

// --- objects -------------------------------------------------------------------------------------

// Reads a material by index or name, or null for the mesh's own material.
static bool read_material(const struct scene *scene, const struct json_node *node, bool may_be_own,
                          uint32_t *out, struct err *err)
{
    const struct list list = materials_of(scene);
    if (!node->value)
        return true;
    if (json_is_string(node->value))
        return find_name(scene, node, &list, out, err);
    if (!json_is_null(node->value))
        return find_index(node, list.what, list.count, out, err);
    *out = SCENE_NONE;
    return may_be_own || node_fail(node, err,
                                   "a shape has no material of its own; expected "
                                   "an index or a name");
}

// Reads the index of the first object, and the number of objects from it on.
static bool read_span(const struct json_node *node, uint32_t total, uint32_t *first,
                      uint32_t *count, struct err *err)
{
    const struct json_node index = node_member(node, "index");
    const struct json_node count_node = node_member(node, "count");
    uint64_t number = 1;
    if (!find_index(&index, "object", total, first, err) ||
        !node_read_integer(node, "count", 1, UINT32_MAX, &number, err))
        return false;
    if (number > total - *first)
        return node_fail(&count_node, err, "exceeds the %u objects from index %u on",
                         total - *first, *first);
    *count = (uint32_t)number;
    return true;
}

// Adds a quad, the only kind of shape that can be added: a lamp that a user places in an editor.
static bool add_shape(struct scene *scene, const struct json_node *node, struct err *err)
{
    static const char *const kinds[] = {"quad", NULL};
    static const char *const required[] = {"added", "center", "half_u", "half_v", "material", NULL};
    static const char *const optional[] = {"visible",      "about", "move",
                                           "turn_degrees", "scale", NULL};
    uint32_t kind = 0;
    double normal[3];
    struct shape shape = {.kind = SHAPE_QUAD};
    if (!node_check_object(node, required, optional, err) ||
        !node_read_choice(node, "added", kinds, &kind, err) ||
        !fields_read(scene_quad_fields, 3, node, &shape, err))
        return false;
    vec3_cross(shape.axes[0], shape.axes[1], normal);
    if (!(vec3_length(normal) > 0))
        return node_fail(node, err, "half_u and half_v span no area");
    struct shape *added = scene_add_shape(scene, NULL);
    if (!added)
        return err_memory(err, "a shape", sizeof *added);
    *added = shape;
    return true;
}

static bool place_object(struct scene *scene, const struct json_node *node, uint32_t object,
                         struct err *err)
{
    const struct placement former = scene_placement(scene, object);
    struct placement placement = former;
    struct err problem = {0};
    if (!fields_read(scene_placement_fields, 4, node, &placement, err))
        return false;
    if (fields_same(scene_placement_fields, 4, &former, &placement) ||
        scene_place(scene, object, &placement, &problem))
        return true;
    return problem.code == ERR_INPUT ? node_fail(node, err, "%s", problem.msg)
                                     : (*err = problem, false);
}

// Objects are numbered as in renders: instances, then shapes.
static bool edit_object(struct json_loader *loader, const struct json_node *node, struct err *err)
{
    static const char *const required[] = {"index", NULL};
    static const char *const optional[] = {"count", "visible",      "material", "about",
                                           "move",  "turn_degrees", "scale",    NULL};
    struct scene *scene = loader->scene;
    const struct json_node of_visible = node_member(node, "visible");
    const struct json_node of_material = node_member(node, "material");
    uint32_t first = scene->instance_count + scene->shape_count, count = 1, material = SCENE_NONE;
    bool visible = true, is_new = json_is_object(node->value) && node_member(node, "added").value;
    if (!(is_new ? add_shape(scene, node, err)
                 : node_check_object(node, required, optional, err) &&
                       read_span(node, first, &first, &count, err)) ||
        !node_read_boolean(node, "visible", &visible, err) ||
        !read_material(scene, &of_material, first + count <= scene->instance_count, &material, err))
        return false;
    for (uint32_t i = first; i < first + count; i++) {
        struct instance *instance = i < scene->instance_count ? &scene->instances[i] : NULL;
        struct shape *shape = instance ? NULL : &scene->shapes[i - scene->instance_count];
        if (of_visible.value)
            *(instance ? &instance->hidden : &shape->hidden) = !visible;
        if (of_material.value)
            *(instance ? &instance->material : &shape->material) = material;
        if (!place_object(scene, node, i, err))
            return false;
    }
    return true;
}

// --- environment ---------------------------------------------------------------------------------

static bool edit_environment(struct json_loader *loader, const struct json_node *node,
                             struct err *err)
{
    static const char *const keys[] = {"radiance", "rotation_degrees", "rotation_radians", NULL};
    struct environment *environment = &loader->scene->environment;
    if (!environment->present)
        return node_fail(node, err,
                         "there is no environment to edit; expected \"environment\" beside "
                         "\"base\"");
    if (!node_check_object(node, none, keys, err) ||
        !fields_read(scene_environment_fields, 2, node, environment, err))
        return false;
    const struct json_node radiance = node_member(node, "radiance");
    double greatest = radiance.value ? (double)environment_greatest(environment) : 0;
    return greatest <= (double)(float)SCENE_RADIANCE_MAX ||
           node_fail(&radiance, err, "makes the radiance %.9g; expected at most %g", greatest,
                     SCENE_RADIANCE_MAX);
}

// --- the whole section ---------------------------------------------------------------------------

// Calls `edit` for each element in order, so that later edits continue from earlier ones.
static bool edit_each(struct json_loader *loader, const struct json_node *list, load_json_fn *edit,
                      struct err *err)
{
    if (!list->value)
        return true;
    if (!node_check_array(list, 0, UINT32_MAX, err))
        return false;
    for (size_t i = 0; i < json_array_size(list->value); i++) {
        const struct json_node node = node_element(list, i);
        if (!edit(loader, &node, err))
            return false;
    }
    return true;
}

// Copies the materials and objects before they are edited, so that differences can be found later.
static bool keep_former(struct json_loader *loader, bool has_materials, bool has_objects,
                        struct err *err)
{
    struct scene *scene = loader->scene;
    struct scene_base *base = loader->base;
    struct arena *arena = &scene->arena;
    if (!base)
        return true;
    base->material_count = scene->material_count;
    base->shape_count = scene->shape_count;
    if (has_materials)
        base->materials =
            arena_copy(arena, scene->materials, scene->material_count, sizeof *scene->materials);
    if (has_objects) {
        base->instances =
            arena_copy(arena, scene->instances, scene->instance_count, sizeof *scene->instances);
        base->shapes = arena_copy(arena, scene->shapes, scene->shape_count, sizeof *scene->shapes);
    }
    return ((base->materials || !has_materials) &&
            ((base->instances && base->shapes) || !has_objects)) ||
           err_memory(err, "the objects that are edited",
                      scene->instance_count * sizeof *scene->instances);
}

bool load_json_edits(struct json_loader *loader, const struct json_node *edits, struct err *err)
{
    static const char *const keys[] = {"environment", "materials", "lights", "objects", NULL};
    if (!node_check_object(edits, none, keys, err))
        return false;
    const struct json_node environment = node_member(edits, "environment");
    const struct json_node materials = node_member(edits, "materials");
    const struct json_node lights = node_member(edits, "lights");
    const struct json_node objects = node_member(edits, "objects");
    return keep_former(loader, materials.value, objects.value, err) &&
           (!environment.value || edit_environment(loader, &environment, err)) &&
           edit_each(loader, &materials, edit_material, err) &&
           edit_each(loader, &lights, edit_light, err) &&
           edit_each(loader, &objects, edit_object, err);
}
