// The section "camera" of a scene file.
#include "scene/json/load_json.h"

#include "json/field_json.h"
#include "scene/json/scene_fields.h"

#include "scene/core/affine.h"
#include <float.h>
#include <math.h>
#include <string.h>

// In this range of millimetres the field of view is neither 0 nor 180 degrees in double precision.
static const struct range RANGE_MILLIMETRES = {1e-6, 1e6, false};
static const struct range RANGE_F_NUMBER = {1e-3, 1e6, false};

// The keys of every camera, then those of perspective cameras only, then those of a lens.
static const char *const optional_keys[] = {
    "name",
    "type",
    "target",
    "direction",
    "up",
    "height",
    "fov_degrees",
    "fov_radians",
    "focal_length_mm",
    "sensor_height_mm",
    "aperture_radius_mm",
    "aperture_radius",
    "f_number",
    "focus",
    "focus_distance",
    "blades",
    "blade_rotation_degrees",
    "blade_rotation_radians",
    NULL,
};
enum { PERSPECTIVE_KEYS = 6, LENS_KEYS = 13 }; // index of the first key of each group

bool load_json_direction(const struct json_node *node, const double position[3],
                         double direction[3], struct err *err)
{
    double target[3];
    if ((position && !node_check_either(node, "target", "direction", err)) ||
        !node_read_vector(node, "direction", RANGE_COORDINATE, direction, err))
        return false;
    const struct json_node target_node = node_member(node, "target");
    if (position && target_node.value) {
        if (!node_read_vector(node, "target", RANGE_COORDINATE, target, err))
            return false;
        vec3_subtract(target, position, direction);
        return vec3_normalize(direction) ||
               node_fail(&target_node, err, "is the position itself; expected another point");
    }
    const struct json_node direction_node = node_member(node, "direction");
    return vec3_make_unit(direction) ||
           node_fail(&direction_node, err, "is zero; expected a direction");
}

// Reads "up". The camera's basis is accurate in single precision if `up` deviates from the line of
// sight by more than that precision resolves.
static bool read_up(const struct json_node *node, struct camera *camera, struct err *err)
{
    if (!node_read_vector(node, "up", RANGE_COORDINATE, camera->up, err))
        return false;
    double unit[3] = {camera->up[0], camera->up[1], camera->up[2]}, right[3];
    if (vec3_normalize(unit)) {
        vec3_cross(camera->direction, unit, right);
        if (vec3_length(right) > (double)FLT_EPSILON)
            return true;
    }
    const struct json_node up_node = node_member(node, "up");
    return node_fail(up_node.value ? &up_node : node, err,
                     "up (%.9g, %.9g, %.9g) is zero or parallel to the line of sight",
                     camera->up[0], camera->up[1], camera->up[2]);
}

static bool read_field_of_view(const struct json_node *node, struct camera *camera, struct err *err)
{
    double focal_length = 0, sensor_height = 24;
    bool is_exact = node_member(node, "fov_radians").value != NULL;
    if (!node_check_either(node, is_exact ? "fov_radians" : "fov_degrees", "focal_length_mm",
                           err) ||
        !field_read(&scene_fov_field, node, camera, err) ||
        !node_read_number(node, "focal_length_mm", RANGE_MILLIMETRES, &focal_length, err) ||
        !node_read_number(node, "sensor_height_mm", RANGE_MILLIMETRES, &sensor_height, err))
        return false;
    const struct json_node sensor = node_member(node, "sensor_height_mm");
    if (sensor.value && camera->fov_y > 0)
        return node_fail(&sensor, err, "requires \"focal_length_mm\" instead of \"fov_degrees\"");
    if (focal_length > 0)
        camera->fov_y = 2 * atan(sensor_height / (2 * focal_length));
    return true;
}

// Reads the focus distance, or computes it as the distance along the viewing direction of the point
// in focus.
static bool read_focus(const struct json_node *node, struct camera *camera, struct err *err)
{
    double point[3], to_point[3];
    if (!node_check_either(node, "focus", "focus_distance", err) ||
        !node_read_number(node, "focus_distance", RANGE_RADIUS, &camera->focus_distance, err) ||
        !node_read_vector(node, "focus", RANGE_COORDINATE, point, err))
        return false;
    const struct json_node focus = node_member(node, "focus");
    if (!focus.value)
        return true;
    vec3_subtract(point, camera->position, to_point);
    camera->focus_distance = vec3_dot(to_point, camera->direction);
    if (camera->focus_distance >= RANGE_RADIUS.min && camera->focus_distance <= RANGE_RADIUS.max)
        return true;
    return node_fail(&focus, err,
                     "lies %g m in front of the camera; expected a distance within [%g, %g]",
                     camera->focus_distance, RANGE_RADIUS.min, RANGE_RADIUS.max);
}

// Reads the radius of the aperture, or computes it from the f-number, which is the focal length
// divided by the diameter.
static bool read_aperture(const struct json_node *node, struct camera *camera, struct err *err)
{
    double f_number = 0, focal_length = 0;
    bool is_exact = node_member(node, "aperture_radius").value != NULL;
    if (!node_check_either(node, is_exact ? "aperture_radius" : "aperture_radius_mm", "f_number",
                           err) ||
        !field_read(&scene_aperture_field, node, camera, err) ||
        !node_read_number(node, "f_number", RANGE_F_NUMBER, &f_number, err))
        return false;
    const struct json_node f_node = node_member(node, "f_number");
    if (f_node.value) {
        if (!node_member(node, "focal_length_mm").value)
            return node_fail(&f_node, err, "requires \"focal_length_mm\"");
        if (!node_read_number(node, "focal_length_mm", RANGE_MILLIMETRES, &focal_length, err))
            return false;
        camera->lens_radius = focal_length / (2 * f_number) * 1e-3;
    }
    return true;
}

static bool read_blades(const struct json_node *node, struct camera *camera, struct err *err)
{
    uint64_t blades = 0;
    if (!node_read_integer(node, "blades", 0, SCENE_LENS_BLADES_MAX, &blades, err) ||
        !field_read(&scene_blade_rotation_field, node, camera, err))
        return false;
    const struct json_node blades_node = node_member(node, "blades");
    if (blades == 1 || blades == 2)
        return node_fail(&blades_node, err, "%u; expected at least 3, or 0 for a round aperture",
                         (unsigned)blades);
    camera->lens_blades = (uint32_t)blades;
    return true;
}

// Fails if one of the keys is present. The list ends with NULL.
static bool check_absent(const struct json_node *node, const char *const *keys, const char *reason,
                         struct err *err)
{
    for (; *keys; keys++) {
        const struct json_node member = node_member(node, *keys);
        if (member.value)
            return node_fail(&member, err, "%s", reason);
    }
    return true;
}

static bool read_lens(const struct json_node *node, struct camera *camera, struct err *err)
{
    if (!node_member(node, "aperture_radius_mm").value &&
        !node_member(node, "aperture_radius").value && !node_member(node, "f_number").value)
        return check_absent(node, &optional_keys[LENS_KEYS],
                            "requires \"aperture_radius_mm\" or \"f_number\": a pinhole has no "
                            "focus",
                            err);
    return read_aperture(node, camera, err) && read_focus(node, camera, err) &&
           read_blades(node, camera, err);
}

// Reads the keys of one kind of camera, and rejects the keys of other kinds.
static bool read_kind(const struct json_node *node, struct camera *camera, struct err *err)
{
    static const char *const of_orthographic[] = {"height", NULL};
    if (!node_read_choice(node, "type", camera_names, &camera->kind, err))
        return false;
    if (camera->kind != CAMERA_PERSPECTIVE && !check_absent(node, &optional_keys[PERSPECTIVE_KEYS],
                                                            "is only for perspective cameras", err))
        return false;
    if (camera->kind != CAMERA_ORTHOGRAPHIC &&
        !check_absent(node, of_orthographic, "is only for orthographic cameras", err))
        return false;
    if (camera->kind == CAMERA_PERSPECTIVE)
        return read_field_of_view(node, camera, err) && read_lens(node, camera, err);
    if (camera->kind == CAMERA_PANORAMIC)
        return true;
    if (!node_member(node, "height").value)
        return node_fail(
            node, err,
            "\"height\" is missing; expected the height of the visible region in metres");
    return node_read_number(node, "height", RANGE_RADIUS, &camera->height, err);
}

bool load_json_camera(struct json_loader *loader, const struct json_node *node, struct err *err)
{
    struct scene *scene = loader->scene;
    static const char *const required[] = {"position", NULL};
    const char *name = "";
    struct camera camera = {.up = {0, 1, 0}};
    if (!node_check_object(node, required, optional_keys, err) ||
        !node_read_string(node, "name", &name, err) ||
        !node_read_vector(node, "position", RANGE_COORDINATE, camera.position, err) ||
        !load_json_direction(node, camera.position, camera.direction, err) ||
        !read_up(node, &camera, err) || !read_kind(node, &camera, err))
        return false;
    struct camera *added = scene_add_camera(scene, NULL);
    camera.name = arena_strdup(&scene->arena, name);
    if (!added || !camera.name)
        return err_memory(err, "a camera", sizeof camera);
    *added = camera;
    return true;
}
