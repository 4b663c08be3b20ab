// Lights of a scene file that are not surfaces.
#include "scene/json/load_json.h"

#include "json/field_json.h"
#include "scene/json/scene_fields.h"

#include "scene/core/affine.h"
#include "scene/core/environment.h"
#include "scene/core/light.h"
#include "scene/sky/ies.h"
#include "shared/types.h"
#include <math.h>

static const struct {
    const char *required[4], *optional[11];
} type_keys[] = {
    [LIGHT_POINT] = {{"type", "position"},
                     {"name", "intensity", "power", "range", "profile", "direction", "target",
                      "rotation_degrees"}},
    [LIGHT_SPOT] = {{"type", "position"},
                    {"name", "intensity", "power", "range", "direction", "target", "inner_degrees",
                     "outer_degrees", "profile", "rotation_degrees"}},
    [LIGHT_DIRECTIONAL] = {{"type", "direction", "irradiance"},
                           {"name", "angular_diameter_degrees"}},
};

// The default outer angle of a spot light, as in glTF.
#define SPOT_OUTER_DEGREES 45

bool load_json_check_light(const struct json_node *node, const struct light *light, struct err *err)
{
    const double inner = (double)light->inner_angle / DEGREE;
    const double outer = (double)light->outer_angle / DEGREE;
    const double degrees = 2 * light->angular_radius / DEGREE;
    const struct json_node member = node_member(node, "angular_diameter_degrees");
    const struct json_node *diameter = member.value ? &member : node;
    if (light->kind == LIGHT_SPOT && !(light->inner_angle < light->outer_angle))
        return node_fail(node, err, "inner_degrees %.6g is not below outer_degrees %.6g", inner,
                         outer);
    if (degrees > 0 && degrees < ENVIRONMENT_SUN_DIAMETER_MIN)
        return node_fail(diameter, err,
                         "%.9g is below %g; expected 0 for a delta light, or at least that",
                         degrees, ENVIRONMENT_SUN_DIAMETER_MIN);
    for (int c = 0; c < 3 && degrees > 0 && light->kind == LIGHT_DIRECTIONAL; c++) {
        double radiance =
            environment_sun_radiance((double)light->radiant[c], light->angular_radius);
        if (!(radiance <= SCENE_RADIANCE_MAX))
            return node_fail(diameter, err, "makes the sun's radiance %.9g; expected at most %g",
                             radiance, SCENE_RADIANCE_MAX);
    }
    return true;
}

// Places the half-plane in which the profile's horizontal angle is 0. It contains the projection of
// the world's x axis, or of the z axis if light travels along the x axis. Then it is rotated
// counter-clockwise as seen against the direction of the light.
static void place_profile(struct light *light, double rotation_degrees)
{
    const double *d = light->direction;
    double x[3] = {1, 0, 0}, y[3], angle = rotation_degrees * DEGREE;
    if (fabs(d[0]) > 0.999) {
        x[0] = 0;
        x[2] = 1;
    }
    double along = vec3_dot(d, x);
    for (int c = 0; c < 3; c++)
        x[c] -= along * d[c];
    vec3_normalize(x);
    vec3_cross(x, d, y); // "up" is opposite to the direction
    for (int c = 0; c < 3; c++)
        light->profile_x[c] = cos(angle) * x[c] + sin(angle) * y[c];
}

static bool read_profile(struct json_loader *loader, const struct json_node *node,
                         struct light *light, struct err *err)
{
    static const char *const only_with_it[] = {"direction", "target", "rotation_degrees"};
    const struct json_node file = node_member(node, "profile");
    const struct range rotations = {-1e6, 1e6, false};
    double rotation = 0;
    for (int i = light->kind == LIGHT_SPOT ? 2 : 0; i < 3 && !file.value; i++) {
        const struct json_node member = node_member(node, only_with_it[i]);
        if (member.value)
            return node_fail(&member, err, "requires \"profile\"");
    }
    if (!file.value)
        return true;
    if (light->kind == LIGHT_POINT) {
        light->direction[1] = -1;
        bool is_placed = node_member(node, "direction").value || node_member(node, "target").value;
        if (is_placed && !load_json_direction(node, light->position, light->direction, err))
            return false;
    }
    if (!node_read_number(node, "rotation_degrees", rotations, &rotation, err))
        return false;
    place_profile(light, rotation);
    const char *path = load_json_path(loader, node, "profile", err);
    return path &&
           (ies_load(loader->scene, path, &light->profile, err) || node_prepend(&file, err));
}

// Reads "intensity", or "power", which is divided by the solid angle into which it is emitted.
static bool read_intensity(const struct json_node *node, struct light *light, struct err *err)
{
    double solid_angle = 4 * M_PI;
    if (light->profile)
        solid_angle = light->profile->solid_angle;
    else if (light->kind == LIGHT_SPOT)
        solid_angle = spot_solid_angle(light);
    bool is_told = light->profile && !node_member(node, "power").value;
    if (!is_told && !node_check_either(node, "intensity", "power", err))
        return false;
    // Without "intensity", the intensity is that of the profile's file.
    for (int c = 0; c < 3 && light->profile && !node_member(node, "intensity").value; c++)
        light->radiant[c] = (float)light->profile->greatest;
    const struct json_node power_node = node_member(node, "power");
    double power[3];
    if (!power_node.value)
        return true;
    if (!node_read_vector(node, "power", RANGE_RADIANCE, power, err))
        return false;
    for (int c = 0; c < 3; c++) {
        double intensity = power[c] / solid_angle;
        if (!(intensity <= RANGE_RADIANCE.max))
            return node_fail(&power_node, err, "makes the intensity %.9g; expected at most %g",
                             intensity, RANGE_RADIANCE.max);
        light->radiant[c] = (float)intensity;
    }
    return true;
}

static bool read_light(struct json_loader *loader, const struct json_node *node,
                       struct light *light, struct err *err)
{
    struct scene_fields fields;
    if (!json_is_object(node->value))
        return node_unexpected(node, "an object", err);
    if (!node_member(node, "type").value)
        return node_fail(node, err, "\"type\" is missing");
    light->range = INFINITY;
    if (!node_read_choice(node, "type", light_kind_names, &light->kind, err) ||
        !node_check_object(node, type_keys[light->kind].required, type_keys[light->kind].optional,
                           err) ||
        !node_read_string(node, "name", &light->name, err))
        return false;
    if (light->kind == LIGHT_SPOT)
        light->outer_angle = (float)(SPOT_OUTER_DEGREES * DEGREE);
    scene_light_fields(light->kind, &fields);
    bool is_directional = light->kind == LIGHT_DIRECTIONAL;
    return fields_read(fields.list, fields.count, node, light, err) &&
           (light->kind == LIGHT_POINT ||
            load_json_direction(node, is_directional ? NULL : light->position, light->direction,
                                err)) &&
           load_json_check_light(node, light, err) &&
           (is_directional ||
            (read_profile(loader, node, light, err) && read_intensity(node, light, err)));
}

bool load_json_lights(struct json_loader *loader, const struct json_node *lights, struct err *err)
{
    struct scene *scene = loader->scene;
    if (!node_check_array(lights, 0, UINT32_MAX, err))
        return false;
    for (size_t i = 0; i < json_array_size(lights->value); i++) {
        const struct json_node node = node_element(lights, i);
        struct light *light = scene_add_light(scene, NULL);
        if (!light)
            return err_memory(err, "a light", sizeof *light);
        if (!read_light(loader, &node, light, err))
            return false;
        light->name = arena_strdup(&scene->arena, light->name);
        if (!light->name)
            return err_memory(err, "a name", 1);
    }
    return true;
}
