// Sections of a scene file without lists: camera, film, settings, environment.
#include "load_json.h"

#include "affine.h"
#include "environment.h"
#include <float.h>
#include <math.h>
#include <string.h>

static const char *const none[] = {NULL};

static double radians(double degrees)
{
    return degrees * (M_PI / 180);
}

// --- camera --------------------------------------------------------------------------------------

// The millimetres' range leaves fields of view that are neither 0 nor 180 degrees in double.
static const struct range RANGE_MILLIMETRES = {1e-6, 1e6, false};

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
        return vec3_normalize(direction) || node_fail(&target_node, err, "is its own position");
    }
    const struct json_node direction_node = node_member(node, "direction");
    return vec3_normalize(direction) ||
           node_fail(&direction_node, err, "is zero; expected a direction");
}

// The basis that the kernels take in single precision keeps its digits as long as up deviates from
// the line of sight by more than that precision resolves.
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
    const struct range degrees = {0, 180, true};
    double fov_degrees = 0, focal_length = 0, sensor_height = 24;
    if (!node_check_either(node, "fov_degrees", "focal_length_mm", err) ||
        !node_read_number(node, "fov_degrees", degrees, &fov_degrees, err) ||
        !node_read_number(node, "focal_length_mm", RANGE_MILLIMETRES, &focal_length, err) ||
        !node_read_number(node, "sensor_height_mm", RANGE_MILLIMETRES, &sensor_height, err))
        return false;
    const struct json_node sensor = node_member(node, "sensor_height_mm");
    if (sensor.value && fov_degrees > 0)
        return node_fail(&sensor, err, "goes with \"focal_length_mm\", not with \"fov_degrees\"");
    camera->fov_y =
        fov_degrees > 0 ? radians(fov_degrees) : 2 * atan(sensor_height / (2 * focal_length));
    return true;
}

bool load_json_camera(struct scene *scene, const struct json_node *node, struct err *err)
{
    static const char *const required[] = {"position", NULL};
    static const char *const optional[] = {
        "name",        "target",          "direction",        "up",
        "fov_degrees", "focal_length_mm", "sensor_height_mm", NULL};
    const char *name = "";
    struct camera camera = {.up = {0, 1, 0}};
    if (!node_check_object(node, required, optional, err) ||
        !node_read_string(node, "name", &name, err) ||
        !node_read_vector(node, "position", RANGE_COORDINATE, camera.position, err) ||
        !load_json_direction(node, camera.position, camera.direction, err) ||
        !read_up(node, &camera, err) || !read_field_of_view(node, &camera, err))
        return false;
    struct camera *added = scene_add_camera(scene, NULL);
    camera.name = arena_strdup(&scene->arena, name);
    if (!added || !camera.name)
        return err_memory(err, "a camera", sizeof camera);
    *added = camera;
    return true;
}

// --- film and settings ---------------------------------------------------------------------------

static bool read_uint32(const struct json_node *object, const char *key, uint32_t min, uint32_t max,
                        uint32_t *out, struct err *err)
{
    uint64_t value = *out;
    if (!node_read_integer(object, key, min, max, &value, err))
        return false;
    *out = (uint32_t)value;
    return true;
}

bool load_json_film(struct scene *scene, const struct json_node *node, struct err *err)
{
    static const char *const optional[] = {"width", "height", "exposure", "tone", NULL};
    static const char *const tones[] = {[TONE_NONE] = "none",
                                        [TONE_REINHARD] = "reinhard",
                                        [TONE_ACES] = "aces",
                                        [TONE_AGX] = "agx",
                                        NULL};
    const struct range stops = {-SETTINGS_EXPOSURE_MAX, SETTINGS_EXPOSURE_MAX, false};
    struct settings *settings = &scene->settings;
    double exposure = (double)settings->exposure;
    uint32_t tone = settings->tone_curve;
    if (!node_check_object(node, none, optional, err) ||
        !read_uint32(node, "width", 1, SETTINGS_SIZE_MAX, &settings->width, err) ||
        !read_uint32(node, "height", 1, SETTINGS_SIZE_MAX, &settings->height, err) ||
        !node_read_number(node, "exposure", stops, &exposure, err) ||
        !node_read_choice(node, "tone", tones, &tone, err))
        return false;
    settings->exposure = (float)exposure;
    settings->tone_curve = (enum tone_curve)tone;
    if ((uint64_t)settings->width * settings->height > SETTINGS_PIXELS_MAX)
        return node_fail(node, err, "%u x %u pixels; expected at most %llu in all", settings->width,
                         settings->height, (unsigned long long)SETTINGS_PIXELS_MAX);
    return true;
}

static bool read_roulette(const struct json_node *settings, uint32_t *out, struct err *err)
{
    const struct json_node node = node_member(settings, "roulette_min_bounces");
    if (!json_is_string(node.value))
        return read_uint32(settings, node.key, 0, SETTINGS_BOUNCES_MAX, out, err);
    static const char *const words[] = {"off", NULL};
    uint32_t off;
    if (!node_read_choice(settings, node.key, words, &off, err))
        return false;
    *out = UINT32_MAX;
    return true;
}

bool load_json_settings(struct scene *scene, const struct json_node *node, struct err *err)
{
    static const char *const optional[] = {
        "spp",    "seed",         "max_bounces", "roulette_min_bounces",
        "filter", "pixel_jitter", "estimator",   NULL};
    static const char *const estimators[] = {
        [ESTIMATOR_MIS] = "mis", [ESTIMATOR_NEE] = "nee", [ESTIMATOR_BSDF] = "bsdf", NULL};
    static const char *const filters[] = {[FILTER_BOX] = "box", NULL};
    struct settings *settings = &scene->settings;
    uint32_t estimator = settings->estimator, filter = settings->filter;
    if (!node_check_object(node, none, optional, err) ||
        !node_read_integer(node, "spp", 1, SETTINGS_SPP_MAX, &settings->spp, err) ||
        !read_uint32(node, "seed", 0, UINT32_MAX, &settings->seed, err) ||
        !read_uint32(node, "max_bounces", 0, SETTINGS_BOUNCES_MAX, &settings->max_bounces, err) ||
        !read_roulette(node, &settings->roulette_min_bounces, err) ||
        !node_read_choice(node, "estimator", estimators, &estimator, err) ||
        !node_read_choice(node, "filter", filters, &filter, err) ||
        !node_read_boolean(node, "pixel_jitter", &settings->pixel_jitter, err))
        return false;
    settings->estimator = (enum light_estimator)estimator;
    settings->filter = (enum pixel_filter)filter;
    return true;
}

// --- environment ---------------------------------------------------------------------------------

bool load_json_environment(struct json_loader *loader, const struct json_node *node,
                           struct err *err)
{
    static const char *const optional[] = {"radiance", "file", NULL};
    float radiance[3] = {1, 1, 1};
    const char *file = NULL;
    if (!node_check_object(node, none, optional, err))
        return false;
    if (!node_member(node, "radiance").value && !node_member(node, "file").value)
        return node_fail(node, err, "\"radiance\" or \"file\" is missing");
    if (!node_read_color(node, "radiance", RANGE_RADIANCE, radiance, err))
        return false;
    const struct json_node file_node = node_member(node, "file");
    if (file_node.value && !(file = load_json_path(loader, node, "file", err)))
        return false;
    return scene_set_environment(loader->scene, file, radiance, err) ||
           node_prepend(file ? &file_node : node, err);
}
