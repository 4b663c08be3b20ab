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
    const struct range stops = {-SETTINGS_EXPOSURE_MAX, SETTINGS_EXPOSURE_MAX, false};
    struct settings *settings = &scene->settings;
    double exposure = (double)settings->exposure;
    uint32_t tone = settings->tone_curve;
    if (!node_check_object(node, none, optional, err) ||
        !read_uint32(node, "width", 1, SETTINGS_SIZE_MAX, &settings->width, err) ||
        !read_uint32(node, "height", 1, SETTINGS_SIZE_MAX, &settings->height, err) ||
        !node_read_number(node, "exposure", stops, &exposure, err) ||
        !node_read_choice(node, "tone", tone_names, &tone, err))
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

static const struct range RANGE_AO = {0, FLT_MAX, true};
static const struct range RANGE_FALLOFF = {0, FLT_MAX, false};
static const struct range RANGE_CLAMP = {0, FLT_MAX, true};
static const struct range RANGE_FILTER_RADIUS = {0, SETTINGS_FILTER_RADIUS_MAX, false};
static const struct range RANGE_EXPONENT = {0, SETTINGS_EXPONENT_MAX, false};
static const struct range RANGE_SURVIVAL = {0.01, 1, false};

static bool read_float(const struct json_node *object, const char *key, struct range range,
                       float *out, struct err *err)
{
    double value = (double)*out;
    if (!node_read_number(object, key, range, &value, err))
        return false;
    *out = (float)value;
    return true;
}

static bool read_choices(const struct json_node *node, struct settings *settings, struct err *err)
{
    return node_read_choice(node, "integrator", integrator_names, &settings->integrator, err) &&
           node_read_choice(node, "sampler", sampler_names, &settings->sampler, err) &&
           node_read_choice(node, "halves", halves_names, &settings->halves, err) &&
           node_read_choice(node, "filter", filter_names, &settings->filter, err) &&
           node_read_choice(node, "light_choice", light_choice_names, &settings->light_choice,
                            err) &&
           node_read_choice(node, "mis", mis_names, &settings->mis, err) &&
           node_read_choice(node, "directions", directions_names, &settings->directions, err) &&
           node_read_choice(node, "roulette", roulette_names, &settings->roulette, err);
}

static bool read_parameters(const struct json_node *node, struct settings *settings,
                            struct err *err)
{
    return read_float(node, "ao_distance", RANGE_AO, &settings->ao_distance, err) &&
           read_float(node, "falloff", RANGE_FALLOFF, &settings->falloff, err) &&
           read_float(node, "filter_radius", RANGE_FILTER_RADIUS, &settings->filter_radius, err) &&
           read_uint32(node, "nee_depth", 0, SETTINGS_BOUNCES_MAX, &settings->nee_depth, err) &&
           read_float(node, "direction_exponent", RANGE_EXPONENT, &settings->direction_exponent,
                      err) &&
           read_float(node, "clamp", RANGE_CLAMP, &settings->clamp_limit, err) &&
           read_uint32(node, "roulette_max_bounces", 0, SETTINGS_BOUNCES_MAX,
                       &settings->roulette_max_bounces, err) &&
           read_float(node, "roulette_survival", RANGE_SURVIVAL, &settings->roulette_survival, err);
}

bool load_json_settings(struct scene *scene, const struct json_node *node, struct err *err)
{
    static const char *const optional[] = {"spp",
                                           "seed",
                                           "max_bounces",
                                           "integrator",
                                           "ao_distance",
                                           "falloff",
                                           "sampler",
                                           "halves",
                                           "filter",
                                           "filter_radius",
                                           "pixel_jitter",
                                           "light_choice",
                                           "nee",
                                           "nee_depth",
                                           "mis",
                                           "directions",
                                           "direction_exponent",
                                           "clamp",
                                           "roulette",
                                           "roulette_min_bounces",
                                           "roulette_max_bounces",
                                           "roulette_survival",
                                           NULL};
    struct settings *settings = &scene->settings;
    return node_check_object(node, none, optional, err) &&
           node_read_integer(node, "spp", 1, SETTINGS_SPP_MAX, &settings->spp, err) &&
           read_uint32(node, "seed", 0, UINT32_MAX, &settings->seed, err) &&
           read_uint32(node, "max_bounces", 0, SETTINGS_BOUNCES_MAX, &settings->max_bounces, err) &&
           read_roulette(node, &settings->roulette_min_bounces, err) &&
           node_read_boolean(node, "pixel_jitter", &settings->pixel_jitter, err) &&
           node_read_boolean(node, "nee", &settings->nee, err) &&
           read_choices(node, settings, err) && read_parameters(node, settings, err);
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
