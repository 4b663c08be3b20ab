// The section "edits": what is changed of a scene that is complete already. Numbers are taken as
// they stand in memory, and keys that are absent change nothing.
#include "scene/json/load_json.h"

#include "scene/core/affine.h"
#include "scene/core/environment.h"
#include "scene/json/scene_edits.h"
#include <float.h>
#include <math.h>
#include <string.h>

static const char *const none[] = {NULL};

// --- what is meant -------------------------------------------------------------------------------

// Things by index or name.
struct list {
    const char *what; // one of them: "material"
    uint32_t count;
    const char *(*name)(const struct scene *scene, uint32_t index);
};

static const char *material_name(const struct scene *scene, uint32_t index)
{
    return scene->materials[index].name;
}

static const char *light_name(const struct scene *scene, uint32_t index)
{
    return scene->lights[index].name;
}

static struct list materials_of(const struct scene *scene)
{
    return (struct list){"material", scene->material_count, material_name};
}

static struct list lights_of(const struct scene *scene)
{
    return (struct list){"light", scene->light_count, light_name};
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

// The only one of that name.
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
    return node_fail(node, err, "the base has %u of the name %s; expected \"index\" instead", found,
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

// Notes that things are spoken of, in a list of flags that is made when the first is.
static bool mark(struct json_loader *loader, bool **flags, uint32_t total, uint32_t first,
                 uint32_t count, struct err *err)
{
    if (!*flags && !(*flags = ARENA_NEW(&loader->scene->arena, bool, total)))
        return err_memory(err, "what is edited", total);
    for (uint32_t i = 0; i < count; i++)
        (*flags)[first + i] = true;
    return true;
}

// A number of single precision.
static bool read_float(const struct json_node *object, const char *key, struct range range,
                       float *out, struct err *err)
{
    double value = (double)*out;
    if (!node_read_number(object, key, range, &value, err))
        return false;
    *out = (float)value;
    return true;
}

// --- materials -----------------------------------------------------------------------------------

static const char *const material_keys[] = {"index",        "name",      "type",       "alpha",
                                            "coat",         "layers",    "thin",       "unlit",
                                            "compensate",   "tint_each", "separable",  "masking",
                                            "distribution", "fresnel",   "extinction", "priority"};
#define MATERIAL_KEY_COUNT (sizeof material_keys / sizeof *material_keys)

static bool check_material_keys(const struct json_node *node, struct err *err)
{
    const char *known[PARAMETER_COUNT + MATERIAL_KEY_COUNT + 1] = {NULL};
    memcpy(known, material_keys, sizeof material_keys);
    for (uint32_t i = 0; i < material_parameter_count; i++)
        known[MATERIAL_KEY_COUNT + i] = material_parameters[i].name;
    return node_check_object(node, none, known, err);
}

const struct edit_switch edit_switches[] = {{"thin", MATERIAL_THIN},
                                            {"unlit", MATERIAL_UNLIT},
                                            {"compensate", MATERIAL_COMPENSATE},
                                            {"tint_each", MATERIAL_TINT_EACH},
                                            {"separable", MATERIAL_SEPARABLE}};
const size_t edit_switch_count = sizeof edit_switches / sizeof *edit_switches;

static bool read_switches(const struct json_node *node, uint32_t *flags, struct err *err)
{
    for (size_t i = 0; i < edit_switch_count; i++) {
        const struct edit_switch *s = &edit_switches[i];
        bool on = *flags & s->flag;
        if (!node_read_boolean(node, s->key, &on, err))
            return false;
        *flags = on ? *flags | s->flag : *flags & ~s->flag;
    }
    return true;
}

const char *const edit_alpha_names[] = {"opaque", "mask", "blend", NULL};
const char *const edit_coat_names[] = {"burley", "ggx", NULL};
const char *const edit_layers_names[] = {"burley", "gltf", NULL};
const char *const edit_distribution_names[] = {[DISTRIBUTION_GGX] = "ggx",
                                               [DISTRIBUTION_BECKMANN] = "beckmann",
                                               [DISTRIBUTION_PHONG] = "phong",
                                               NULL};
const char *const edit_masking_names[] = {[MASKING_SMITH] = "smith",
                                          [MASKING_SCHLICK_GGX] = "schlick_ggx",
                                          [MASKING_LH] = "lh",
                                          [MASKING_RATIONAL] = "rational",
                                          NULL};
const char *const edit_fresnel_names[] = {"schlick", "exact", NULL};

// A number of so many bits of the flags.
static bool read_bits(const struct json_node *node, const char *key, const char *const *names,
                      uint32_t shift, uint32_t bits, uint32_t *flags, struct err *err)
{
    const uint32_t mask = ((1u << bits) - 1u) << shift;
    uint32_t value = (*flags & mask) >> shift;
    if (!node_read_choice(node, key, names, &value, err))
        return false;
    *flags = (*flags & ~mask) | value << shift;
    return true;
}

_Static_assert(MATERIAL_ALPHA_MASK == 1u << 4 && MATERIAL_ALPHA_BLEND == 2u << 4 &&
                   MATERIAL_COAT_GGX == 1u << 7 && MATERIAL_GLTF_LAYERS == 1u << 15 &&
                   MATERIAL_EXACT_FRESNEL == 1u << 21,
               "the choices must be numbers in these bits");

static bool read_choices(const struct json_node *node, uint32_t *flags, struct err *err)
{
    return read_bits(node, "alpha", edit_alpha_names, 4, 2, flags, err) &&
           read_bits(node, "coat", edit_coat_names, 7, 1, flags, err) &&
           read_bits(node, "layers", edit_layers_names, 15, 1, flags, err) &&
           read_bits(node, "distribution", edit_distribution_names, MATERIAL_DISTRIBUTION_SHIFT, 2,
                     flags, err) &&
           read_bits(node, "masking", edit_masking_names, MATERIAL_MASKING_SHIFT, 3, flags, err) &&
           read_bits(node, "fresnel", edit_fresnel_names, 21, 1, flags, err);
}

// Three numbers, or "infinite" for one of them.
static bool read_extinction(const struct json_node *node, float out[3], struct err *err)
{
    const struct json_node list = node_member(node, "extinction");
    if (!list.value)
        return true;
    if (!node_check_array(&list, 3, 3, err))
        return false;
    for (size_t c = 0; c < 3; c++) {
        static const char *const words[] = {"infinite", NULL};
        const struct json_node element = node_element(&list, c);
        uint32_t choice;
        if (json_is_string(element.value)) {
            if (!node_choice(&element, words, &choice, err))
                return false;
            out[c] = INFINITY;
            continue;
        }
        if (!json_is_number(element.value))
            return node_unexpected(&element, "a number or \"infinite\"", err);
        double value = json_number_value(element.value);
        if (!(value >= RANGE_RADIANCE.min && value <= RANGE_RADIANCE.max))
            return node_fail(&element, err, "%.9g is outside [%.9g, %.9g]", value,
                             RANGE_RADIANCE.min, RANGE_RADIANCE.max);
        out[c] = (float)value;
    }
    return true;
}

static bool edit_material(struct json_loader *loader, const struct json_node *node, struct err *err)
{
    struct scene *scene = loader->scene;
    const struct list list = materials_of(scene);
    const char *models[MATERIAL_MODEL_COUNT + 1] = {NULL};
    memcpy(models, material_model_names, sizeof material_model_names);
    uint32_t index;
    if (!find(scene, node, &list, &index, err) || !check_material_keys(node, err))
        return false;
    struct material *material = &scene->materials[index];
    uint64_t priority = material->medium_priority;
    if (!node_read_choice(node, "type", models, &material->model, err) ||
        !load_json_parameters(node, material, err) || !read_switches(node, &material->flags, err) ||
        !read_choices(node, &material->flags, err) ||
        !read_extinction(node, material->extinction, err) ||
        !node_read_integer(node, "priority", 1, 255, &priority, err))
        return false;
    material->medium_priority = (uint32_t)priority;
    return !loader->base ||
           mark(loader, &loader->base->materials, scene->material_count, index, 1, err);
}

// --- lights --------------------------------------------------------------------------------------

const char *const edit_light_names[] = {
    [LIGHT_POINT] = "point", [LIGHT_SPOT] = "spot", [LIGHT_DIRECTIONAL] = "directional", NULL};

static bool read_unit_vector(const struct json_node *object, const char *key, bool may_be_zero,
                             double out[3], struct err *err)
{
    const struct json_node node = node_member(object, key);
    if (!node_read_vector(object, key, RANGE_COORDINATE, out, err))
        return false;
    bool is_zero = out[0] == 0 && out[1] == 0 && out[2] == 0;
    return !node.value || (is_zero && may_be_zero) || vec3_make_unit(out) ||
           node_fail(&node, err, "is zero; expected a direction");
}

static bool read_light_range(const struct json_node *node, struct light *light, struct err *err)
{
    static const char *const words[] = {"off", NULL};
    const struct json_node range = node_member(node, "range");
    uint32_t choice;
    if (!json_is_string(range.value))
        return read_float(node, "range", RANGE_RADIUS, &light->range, err);
    light->range = INFINITY;
    return node_choice(&range, words, &choice, err);
}

// What the kind calls its radiance; the other word is an error.
static bool read_radiant(const struct json_node *node, struct light *light, struct err *err)
{
    bool is_directional = light->kind == LIGHT_DIRECTIONAL;
    const struct json_node wrong = node_member(node, is_directional ? "intensity" : "irradiance");
    if (wrong.value)
        return node_fail(&wrong, err, "is not for \"type\": \"%s\"; expected \"%s\"",
                         edit_light_names[light->kind],
                         is_directional ? "irradiance" : "intensity");
    return node_read_color(node, is_directional ? "irradiance" : "intensity", RANGE_RADIANCE,
                           light->radiant, err);
}

static bool read_cone(const struct json_node *node, struct light *light, struct err *err)
{
    const struct range range = {0, 90, false};
    const struct {
        const char *key;
        float *out;
    } angles[] = {{"inner_degrees", &light->inner_angle}, {"outer_degrees", &light->outer_angle}};
    for (size_t i = 0; i < 2; i++) {
        double degrees;
        if (!node_read_number(node, angles[i].key, range, &degrees, err))
            return false;
        if (node_member(node, angles[i].key).value)
            *angles[i].out = (float)(degrees * DEGREE);
    }
    return light->kind != LIGHT_SPOT || light->inner_angle < light->outer_angle ||
           node_fail(node, err, "the inner angle, %.9g degrees, is not below the outer one, %.9g",
                     (double)light->inner_angle / DEGREE, (double)light->outer_angle / DEGREE);
}

static bool read_sun_size(const struct json_node *node, struct light *light, struct err *err)
{
    const struct range degrees = {0, ENVIRONMENT_SUN_DIAMETER_MAX, false};
    double diameter = 2 * light->angular_radius;
    const struct json_node key = node_member(node, "angular_diameter_degrees");
    if (!load_json_exactly(node, key.key, degrees, DEGREE, "angular_diameter_radians", &diameter,
                           err))
        return false;
    light->angular_radius = diameter / 2;
    if (diameter > 0 && diameter < ENVIRONMENT_SUN_DIAMETER_MIN * DEGREE)
        return node_fail(node, err, "an angular diameter of %.9g degrees is below %g and not 0",
                         diameter / DEGREE, ENVIRONMENT_SUN_DIAMETER_MIN);
    for (int c = 0; c < 3 && diameter > 0 && light->kind == LIGHT_DIRECTIONAL; c++) {
        double radiance =
            environment_sun_radiance((double)light->radiant[c], light->angular_radius);
        if (!(radiance <= SCENE_RADIANCE_MAX))
            return node_fail(node, err, "makes the sun's radiance %.9g; expected at most %g",
                             radiance, SCENE_RADIANCE_MAX);
    }
    return true;
}

// A profile may be taken away; its plane at 0 degrees may be turned.
static bool read_profile(const struct json_node *node, struct light *light, struct err *err)
{
    const struct json_node profile = node_member(node, "profile");
    const struct json_node x = node_member(node, "profile_x");
    if (profile.value && !json_is_false(profile.value))
        return node_unexpected(&profile, "false, which takes it away", err);
    if (profile.value)
        light->profile = NULL;
    if (light->profile && light->kind == LIGHT_DIRECTIONAL)
        return node_fail(node, err,
                         "a directional light has no profile; expected \"profile\": false");
    if (!read_unit_vector(node, "profile_x", true, light->profile_x, err))
        return false;
    // Kernels take both in single precision.
    double along = vec3_dot(light->profile_x, light->direction);
    return !light->profile || fabs(along) <= (double)FLT_EPSILON ||
           node_fail(x.value ? &x : node, err,
                     "profile_x is not at a right angle to the direction: their product is %.9g",
                     along);
}

static bool edit_light(struct json_loader *loader, const struct json_node *node, struct err *err)
{
    static const char *const keys[] = {"index",
                                       "name",
                                       "type",
                                       "position",
                                       "direction",
                                       "intensity",
                                       "irradiance",
                                       "range",
                                       "inner_degrees",
                                       "outer_degrees",
                                       "angular_diameter_degrees",
                                       "angular_diameter_radians",
                                       "profile",
                                       "profile_x",
                                       NULL};
    struct scene *scene = loader->scene;
    const struct list list = lights_of(scene);
    uint32_t index;
    if (!find(scene, node, &list, &index, err) || !node_check_object(node, none, keys, err))
        return false;
    struct light *light = &scene->lights[index];
    if (!node_read_choice(node, "type", edit_light_names, &light->kind, err) ||
        !node_read_vector(node, "position", RANGE_COORDINATE, light->position, err) ||
        !read_unit_vector(node, "direction", light->kind == LIGHT_POINT, light->direction, err) ||
        !read_radiant(node, light, err) || !read_light_range(node, light, err) ||
        !read_cone(node, light, err) || !read_sun_size(node, light, err) ||
        !read_profile(node, light, err))
        return false;
    bool needs_direction = light->kind != LIGHT_POINT;
    if (needs_direction && vec3_dot(light->direction, light->direction) == 0)
        return node_fail(node, err, "has no direction so far; expected \"direction\"");
    if (loader->base)
        loader->base->light_count = scene->light_count;
    return !loader->base || mark(loader, &loader->base->lights, scene->light_count, index, 1, err);
}

// --- objects -------------------------------------------------------------------------------------

// A material by index or name, or null for the mesh's own.
static bool read_material(const struct scene *scene, const struct json_node *object,
                          bool may_be_own, uint32_t *out, struct err *err)
{
    const struct json_node node = node_member(object, "material");
    const struct list list = materials_of(scene);
    if (json_is_string(node.value))
        return find_name(scene, &node, &list, out, err);
    if (json_is_null(node.value)) {
        *out = SCENE_NONE;
        return may_be_own || node_fail(&node, err,
                                       "a shape has no material of its own; expected "
                                       "an index or a name");
    }
    return find_index(&node, list.what, list.count, out, err);
}

// The first object, and how many there are from it on.
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
        return node_fail(&count_node, err, "there are %u objects from index %u on", total - *first,
                         *first);
    *count = (uint32_t)number;
    return true;
}

// Objects are numbered as in renders: instances, then shapes.
static bool edit_object(struct json_loader *loader, const struct json_node *node, struct err *err)
{
    static const char *const required[] = {"index", NULL};
    static const char *const optional[] = {"count", "visible", "material", NULL};
    struct scene *scene = loader->scene;
    uint32_t first, count, material = SCENE_NONE,
                           total = scene->instance_count + scene->shape_count;
    bool visible = true;
    if (!node_check_object(node, required, optional, err) ||
        !read_span(node, total, &first, &count, err) ||
        !node_read_boolean(node, "visible", &visible, err))
        return false;
    bool has_visible = node_member(node, "visible").value != NULL;
    bool has_material = node_member(node, "material").value != NULL;
    bool are_instances = first + count <= scene->instance_count;
    if (has_material && !read_material(scene, node, are_instances, &material, err))
        return false;
    for (uint32_t i = first; i < first + count; i++) {
        struct instance *instance = i < scene->instance_count ? &scene->instances[i] : NULL;
        struct shape *shape = instance ? NULL : &scene->shapes[i - scene->instance_count];
        bool *hidden = instance ? &instance->hidden : &shape->hidden;
        uint32_t *its = instance ? &instance->material : &shape->material;
        *hidden = has_visible ? !visible : *hidden;
        *its = has_material ? material : *its;
    }
    struct scene_base *base = loader->base;
    return !base || mark(loader, &base->objects, total, first, count, err);
}

// --- environment ---------------------------------------------------------------------------------

static bool edit_environment(struct json_loader *loader, const struct json_node *node,
                             struct err *err)
{
    static const char *const keys[] = {"radiance", "rotation_degrees", "rotation_radians", NULL};
    const struct range rotations = {-1e6, 1e6, false};
    struct environment *environment = &loader->scene->environment;
    if (!environment->present)
        return node_fail(node, err,
                         "there is no environment; \"environment\" beside \"base\" "
                         "gives one");
    if (!node_check_object(node, none, keys, err) ||
        !node_read_color(node, "radiance", RANGE_RADIANCE, environment->radiance, err) ||
        !load_json_exactly(node, "rotation_degrees", rotations, DEGREE, "rotation_radians",
                           &environment->rotation, err))
        return false;
    const struct json_node radiance = node_member(node, "radiance");
    double greatest = radiance.value ? (double)environment_greatest(environment) : 0;
    if (!(greatest <= (double)(float)SCENE_RADIANCE_MAX))
        return node_fail(&radiance, err, "makes the radiance %.9g; expected at most %g", greatest,
                         SCENE_RADIANCE_MAX);
    if (loader->base)
        loader->base->environment = true;
    return true;
}

// --- all of them ---------------------------------------------------------------------------------

typedef bool (*edit_fn)(struct json_loader *loader, const struct json_node *node, struct err *err);

// Calls `edit` of each element, in their order: later ones go on where earlier ones ended.
static bool edit_each(struct json_loader *loader, const struct json_node *list, edit_fn edit,
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

bool load_json_edits(struct json_loader *loader, const struct json_node *edits, struct err *err)
{
    static const char *const keys[] = {"environment", "materials", "lights", "objects", NULL};
    if (!node_check_object(edits, none, keys, err))
        return false;
    const struct json_node environment = node_member(edits, "environment");
    const struct json_node materials = node_member(edits, "materials");
    const struct json_node lights = node_member(edits, "lights");
    const struct json_node objects = node_member(edits, "objects");
    return (!environment.value || edit_environment(loader, &environment, err)) &&
           edit_each(loader, &materials, edit_material, err) &&
           edit_each(loader, &lights, edit_light, err) &&
           edit_each(loader, &objects, edit_object, err);
}
