// The environment of a scene file: constant, an image, a gradient, or a sky.
#include "scene/json/load_json.h"

#include "json/field_json.h"
#include "scene/json/scene_fields.h"

#include "scene/core/affine.h"
#include "scene/core/environment.h"
#include "scene/sky/sky.h"
#include <math.h>

enum { TYPE_CONSTANT, TYPE_IMAGE, TYPE_GRADIENT, TYPE_SKY, TYPE_NONE };
static const char *const type_names[] = {"constant", "image", "gradient", "sky", "none", NULL};

static const struct {
    const char *required[5], *optional[12];
} type_keys[] = {
    [TYPE_CONSTANT] = {{"radiance"}, {"type", "strength", "rotation_degrees"}},
    [TYPE_IMAGE] = {{"file"}, {"type", "radiance", "strength", "rotation_degrees"}},
    [TYPE_NONE] = {{"type"}, {NULL}},
    [TYPE_GRADIENT] = {{"type", "zenith", "horizon", "nadir"}, {"strength", "rotation_degrees"}},
    [TYPE_SKY] = {{"type"},
                  {"turbidity", "elevation_degrees", "azimuth_degrees", "sun_direction",
                   "ground_albedo", "sun", "sun_diameter_degrees", "sun_diameter_radians",
                   "strength", "rotation_degrees"}},
};

static const struct range RANGE_STRENGTH = {0, SCENE_RADIANCE_MAX, false};
static const struct range RANGE_ROTATION = {-SCENE_TURN_MAX, SCENE_TURN_MAX, false};

static bool read_image(struct json_loader *loader, const struct json_node *node, struct err *err)
{
    float radiance[3] = {1, 1, 1};
    const char *file = NULL;
    if (!node_read_color(node, "radiance", RANGE_RADIANCE, radiance, err))
        return false;
    const struct json_node file_node = node_member(node, "file");
    if (file_node.value && !(file = load_json_path(loader, node, "file", err)))
        return false;
    return scene_set_environment(loader->scene, file, radiance, err) ||
           node_prepend(file ? &file_node : node, err);
}

static bool read_gradient(struct json_loader *loader, const struct json_node *node, struct err *err)
{
    struct environment_gradient gradient;
    return fields_read(scene_gradient_fields, 3, node, &gradient, err) &&
           (scene_set_gradient(loader->scene, &gradient, err) || node_prepend(node, err));
}

// Reads the sun's direction, given as a vector or as two angles.
static bool read_sun(const struct json_node *node, struct sky *sky, struct err *err)
{
    const struct range elevations = {0, 90, false}, azimuths = {-360, 360, false};
    const struct json_node direction = node_member(node, "sun_direction");
    double elevation = 45, azimuth = 0;
    if (!direction.value) {
        if (!node_read_number(node, "elevation_degrees", elevations, &elevation, err) ||
            !node_read_number(node, "azimuth_degrees", azimuths, &azimuth, err))
            return false;
        sky_place_sun(sky, elevation, azimuth);
        return true;
    }
    if (node_member(node, "elevation_degrees").value || node_member(node, "azimuth_degrees").value)
        return node_fail(&direction, err,
                         "cannot be combined with \"elevation_degrees\" and \"azimuth_degrees\"");
    return vec3_make_unit(sky->sun_direction) ||
           node_fail(&direction, err, "is zero; expected a direction");
}

static bool read_sky(struct json_loader *loader, const struct json_node *node, struct err *err)
{
    struct sky sky = sky_default();
    if (!fields_read(scene_sky_fields, 5, node, &sky, err) || !read_sun(node, &sky, err))
        return false;
    return scene_set_sky(loader->scene, &sky, err) || node_prepend(node, err);
}

// Reads the type. Without "type" the environment is an image if there is a file, else constant.
static bool read_type(const struct json_node *node, uint32_t *type, struct err *err)
{
    *type = node_member(node, "file").value ? TYPE_IMAGE : TYPE_CONSTANT;
    if (!json_is_object(node->value))
        return node_unexpected(node, "an object", err);
    const struct json_node type_node = node_member(node, "type");
    if (!type_node.value && *type == TYPE_CONSTANT && !node_member(node, "radiance").value)
        return node_fail(node, err, "\"radiance\" or \"file\" is missing");
    return node_read_choice(node, "type", type_names, type, err);
}

bool load_json_environment(struct json_loader *loader, const struct json_node *node,
                           struct err *err)
{
    uint32_t type;
    double strength = 1, rotation_degrees = 0;
    if (!read_type(node, &type, err) ||
        !node_check_object(node, type_keys[type].required, type_keys[type].optional, err) ||
        !node_read_number(node, "strength", RANGE_STRENGTH, &strength, err) ||
        !node_read_number(node, "rotation_degrees", RANGE_ROTATION, &rotation_degrees, err))
        return false;
    if (type == TYPE_NONE) {
        loader->scene->environment = (struct environment){0};
        return loader->base || node_fail(node, err,
                                         "\"none\" requires a \"base\"; any other scene "
                                         "has no environment unless it names one");
    }
    bool ok = type == TYPE_SKY        ? read_sky(loader, node, err)
              : type == TYPE_GRADIENT ? read_gradient(loader, node, err)
                                      : read_image(loader, node, err);
    return ok &&
           (scene_adjust_environment(loader->scene, rotation_degrees * DEGREE, strength, err) ||
            node_prepend(node, err));
}
