// Lights of KHR_lights_punctual. Intensities are in candela and illuminances in lux in the file,
// and in W/sr and W/m^2 in the scene. As with emission, the numbers are not converted, because
// exporters disagree on whether they include 683 lm/W, and the spectrum is not specified.
#include "scene/gltf/gltf_load.h"

#include "scene/core/affine.h"
#include <math.h>

#define EXTENSION "KHR_lights_punctual"

// Reads the half-angles of a spot light's cone. The specification requires them to differ, but
// exporters make them equal for a sharp edge. The falloff has a minimum width in either case.
static bool read_cone(const struct json_node *node, struct light *light, struct err *err)
{
    const struct range right_angle = {0, M_PI / 2, false};
    struct json_node spot;
    double inner = 0, outer = M_PI / 4;
    if (!gltf_read_object(node, "spot", &spot, err) ||
        !node_read_number(&spot, "innerConeAngle", right_angle, &inner, err) ||
        !node_read_number(&spot, "outerConeAngle", right_angle, &outer, err))
        return false;
    // The angles are compared in single precision, as the kernels use them.
    light->inner_angle = (float)inner;
    light->outer_angle = (float)outer;
    if (light->inner_angle == light->outer_angle)
        light->inner_angle = nextafterf(light->outer_angle, 0);
    return light->inner_angle < light->outer_angle ||
           node_fail(node, err, "innerConeAngle %.9g is not below outerConeAngle %.9g", inner,
                     outer);
}

static bool read_light(struct gltf_load *load, const struct json_node *node, struct light *light,
                       struct err *err)
{
    static const char *const types[] = {
        [LIGHT_POINT] = "point", [LIGHT_SPOT] = "spot", [LIGHT_DIRECTIONAL] = "directional", NULL};
    const struct range intensities = {0, SCENE_RADIANCE_MAX, false};
    const struct range ranges = {0, SCENE_COORDINATE_MAX, true}, unit = {0, 1, false};
    float color[3] = {1, 1, 1};
    double intensity = 1, range = INFINITY;
    *light = (struct light){0};
    if (!gltf_require(node, "type", err) ||
        !node_read_choice(node, "type", types, &light->kind, err) ||
        !gltf_read_name(node, &load->scene->arena, &light->name, err) ||
        !node_read_color(node, "color", unit, color, err) ||
        !node_read_number(node, "intensity", intensities, &intensity, err) ||
        !node_read_number(node, "range", ranges, &range, err))
        return false;
    light->range = light->kind == LIGHT_DIRECTIONAL ? INFINITY : (float)range;
    for (int c = 0; c < 3; c++)
        light->radiant[c] = color[c] * (float)intensity;
    return light->kind != LIGHT_SPOT || read_cone(node, light, err);
}

// Places a light at its node's origin, shining along the node's -Z axis. The node's scale does not
// change the intensity. *has_direction becomes false if the axis has length 0.
static bool place_light(const struct json_node *holder, const double world[3][4],
                        struct light *light, bool *has_direction, struct err *err)
{
    for (int i = 0; i < 3; i++) {
        light->position[i] = world[i][3];
        light->direction[i] = -world[i][2];
        if (fabs(world[i][3]) > SCENE_COORDINATE_MAX)
            return node_fail(holder, err,
                             "the light's coordinate is %g; expected at most %g metres",
                             world[i][3], SCENE_COORDINATE_MAX);
    }
    *has_direction = vec3_normalize(light->direction);
    return true;
}

// The document's list of lights. `extensions` and `extension` are its parents, for messages.
struct light_list {
    struct json_node extensions, extension, lights;
};

static bool open_list(const struct gltf_document *document, struct light_list *list,
                      struct err *err)
{
    return gltf_read_extension(&document->root, EXTENSION, &list->extensions, &list->extension,
                               err) &&
           gltf_read_array(&list->extension, "lights", &list->lights, err);
}

bool gltf_light_load(struct gltf_load *load, const struct json_node *holder,
                     const double world[3][4], struct err *err)
{
    struct json_node extensions, extension;
    struct light_list list;
    struct light light;
    uint32_t index;
    bool has_direction;
    if (!gltf_read_extension(holder, EXTENSION, &extensions, &extension, err))
        return false;
    if (!extension.value)
        return true;
    if (!open_list(&load->document, &list, err) || !gltf_require(&extension, "light", err) ||
        !gltf_read_index(&extension, "light", (uint32_t)json_array_size(list.lights.value), &index,
                         err))
        return false;
    const struct json_node node = node_element(&list.lights, index);
    if (!json_is_object(node.value))
        return node_unexpected(&node, "an object", err);
    if (!read_light(load, &node, &light, err) ||
        (!*light.name && !gltf_read_name(holder, &load->scene->arena, &light.name, err)) ||
        !place_light(holder, world, &light, &has_direction, err))
        return false;
    if (light.kind != LIGHT_POINT && !has_direction) {
        load->tally.singular_lights++;
        return true;
    }
    struct light *added = scene_add_light(load->scene, NULL);
    if (!added)
        return gltf_no_memory(&load->document, "lights", sizeof *added, err);
    *added = light;
    return true;
}
