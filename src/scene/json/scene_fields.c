#include "scene/json/scene_fields.h"

#include "base/maths.h"
#include "scene/core/environment.h"
#include "scene/core/light.h"
#include "scene/core/placement.h"
#include "scene/core/settings.h"
#include "scene/sky/sky.h"
#include "shared/types.h"
#include <float.h>
#include <stdio.h>
#include <stdlib.h>

#define REAL(least, most) .type = FIELD_REAL, .min = least, .max = most
#define VECTOR(least, most) REAL(least, most), .count = 3
#define COORDINATES VECTOR(-SCENE_COORDINATE_MAX, SCENE_COORDINATE_MAX)
#define RADIANCE VECTOR(0, SCENE_RADIANCE_MAX)
#define DEGREES(exact) .unit = DEGREE, .exact_key = exact

#define FIELDS(list) list, sizeof list / sizeof *list
static void add(struct scene_fields *out, const struct field *fields, size_t count)
{
    for (size_t i = 0; i < count; i++)
        out->list[out->count++] = fields[i];
}

// --- materials -----------------------------------------------------------------------------------

// Returns the decimal number from which a bound of the table was rounded. Single precision
// preserves up to FLT_DIG digits (0.001f itself is slightly above 0.001).
static double as_written(float bound)
{
    char text[32];
    snprintf(text, sizeof text, "%.*g", FLT_DIG, (double)bound);
    return strtod(text, NULL);
}

struct field scene_parameter_field(uint32_t parameter)
{
    const struct material_parameter *p = &material_parameters[parameter];
    return (struct field){
        .key = p->name,
        .type = FIELD_REAL,
        .offset = offsetof(struct material, parameters) + p->first * sizeof(float),
        .size = p->count * sizeof(float),
        .count = p->count > 1 ? p->count : 0,
        .min = as_written(p->min),
        .max = as_written(p->max),
    };
}

void scene_material_fields(struct scene_fields *out)
{
    static const struct field type = {.key = "type",
                                      .type = FIELD_CHOICE,
                                      FIELD_OF(material, model),
                                      .words = material_model_names};
    static const struct field inside[] = {
        {.key = "extinction",
         FIELD_OF(material, extinction),
         RADIANCE,
         .word = "infinite",
         .word_value = INFINITY},
        {.key = "priority",
         .type = FIELD_COUNT,
         FIELD_OF(material, medium_priority),
         .min = 1,
         .max = 255},
    };
    out->count = 0;
    add(out, &type, 1);
    for (uint32_t i = 0; i < material_parameter_count; i++)
        out->list[out->count++] = scene_parameter_field(i);
    add(out, material_flags, material_flag_count);
    add(out, FIELDS(inside));
}

const char *scene_material_name(const struct scene *scene, uint32_t material)
{
    return scene->materials[material].name;
}

// --- lights --------------------------------------------------------------------------------------

void scene_light_fields(uint32_t kind, struct scene_fields *out)
{
    static const struct field first[] = {
        {.key = "type", .type = FIELD_CHOICE, FIELD_OF(light, kind), .words = light_kind_names},
        {.key = "position", FIELD_OF(light, position), COORDINATES},
        {.key = "direction", FIELD_OF(light, direction), COORDINATES},
    };
    const struct field radiant = {.key = kind == LIGHT_DIRECTIONAL ? "irradiance" : "intensity",
                                  FIELD_OF(light, radiant),
                                  RADIANCE};
    static const struct field others[] = {
        {.key = "range",
         FIELD_OF(light, range),
         REAL(SCENE_LENGTH_MIN, SCENE_COORDINATE_MAX),
         .word = "off",
         .word_value = INFINITY},
        {.key = "inner_degrees", FIELD_OF(light, inner_angle), REAL(0, 90), DEGREES(NULL)},
        {.key = "outer_degrees", FIELD_OF(light, outer_angle), REAL(0, 90), DEGREES(NULL)},
        {.key = "angular_diameter_degrees",
         FIELD_OF(light, angular_radius),
         REAL(0, ENVIRONMENT_SUN_DIAMETER_MAX),
         .unit = DEGREE / 2,
         .exact_unit = 0.5,
         .exact_key = "angular_diameter_radians"},
        {.key = "profile_x", FIELD_OF(light, profile_x), COORDINATES},
    };
    out->count = 0;
    add(out, FIELDS(first));
    add(out, &radiant, 1);
    add(out, FIELDS(others));
}

const char *scene_light_name(const struct scene *scene, uint32_t light)
{
    return scene->lights[light].name;
}

// --- objects -------------------------------------------------------------------------------------

// Scales outside these bounds would move a shape out of the permitted range of a scene.
#define SCALE_MIN 1e-30
#define SCALE_MAX 1e30

const struct field scene_placement_fields[4] = {
    {.key = "about", FIELD_OF(placement, about), COORDINATES},
    {.key = "move",
     FIELD_OF(placement, move),
     VECTOR(-2 * SCENE_COORDINATE_MAX, 2 * SCENE_COORDINATE_MAX)},
    {.key = "turn_degrees", FIELD_OF(placement, turn_degrees), VECTOR(-1e6, 1e6)},
    {.key = "scale", FIELD_OF(placement, scale), VECTOR(SCALE_MIN, SCALE_MAX)},
};

const struct field scene_quad_fields[3] = {
    {.key = "center", FIELD_OF(shape, center), COORDINATES},
    {.key = "half_u",
     .type = FIELD_REAL,
     .offset = offsetof(struct shape, axes[0]),
     .size = sizeof(double[3]),
     .count = 3,
     .min = -SCENE_COORDINATE_MAX,
     .max = SCENE_COORDINATE_MAX},
    {.key = "half_v",
     .type = FIELD_REAL,
     .offset = offsetof(struct shape, axes[1]),
     .size = sizeof(double[3]),
     .count = 3,
     .min = -SCENE_COORDINATE_MAX,
     .max = SCENE_COORDINATE_MAX},
};

// --- cameras -------------------------------------------------------------------------------------

const struct field scene_fov_field = {.key = "fov_degrees",
                                      FIELD_OF(camera, fov_y),
                                      REAL(0, 180),
                                      .open = true,
                                      DEGREES("fov_radians")};
const struct field scene_aperture_field = {.key = "aperture_radius_mm",
                                           FIELD_OF(camera, lens_radius),
                                           REAL(0, SCENE_LENS_MAX_MM),
                                           .unit = 1e-3,
                                           .exact_key = "aperture_radius"};
const struct field scene_blade_rotation_field = {.key = "blade_rotation_degrees",
                                                 FIELD_OF(camera, lens_rotation),
                                                 REAL(-360, 360),
                                                 DEGREES("blade_rotation_radians")};

void scene_camera_fields(const struct camera *camera, struct scene_fields *out)
{
    static const struct field type = {
        .key = "type", .type = FIELD_CHOICE, FIELD_OF(camera, kind), .words = camera_names};
    static const struct field place[] = {
        {.key = "position", FIELD_OF(camera, position), COORDINATES},
        {.key = "direction", FIELD_OF(camera, direction), COORDINATES},
        {.key = "up", FIELD_OF(camera, up), COORDINATES},
    };
    static const struct field height = {
        .key = "height", .type = FIELD_REAL, FIELD_OF(camera, height)};
    static const struct field lens[] = {
        {.key = "focus_distance", .type = FIELD_REAL, FIELD_OF(camera, focus_distance)},
        {.key = "blades", .type = FIELD_COUNT, FIELD_OF(camera, lens_blades)},
    };
    bool has_focus = camera->focus_distance >= 1e-9 && camera->focus_distance <= 1e9;
    out->count = 0;
    if (camera->kind != CAMERA_PERSPECTIVE)
        add(out, &type, 1);
    add(out, FIELDS(place));
    if (camera->kind == CAMERA_ORTHOGRAPHIC)
        add(out, &height, 1);
    if (camera->kind != CAMERA_PERSPECTIVE)
        return;
    add(out, &scene_fov_field, 1);
    if (camera->lens_radius == 0 && !has_focus)
        return;
    add(out, &scene_aperture_field, 1);
    add(out, FIELDS(lens));
    add(out, &scene_blade_rotation_field, 1);
}

// --- environments --------------------------------------------------------------------------------

const struct field scene_environment_fields[2] = {
    {.key = "radiance", FIELD_OF(environment, radiance), RADIANCE},
    {.key = "rotation_degrees",
     FIELD_OF(environment, rotation),
     REAL(-SCENE_TURN_MAX, SCENE_TURN_MAX),
     DEGREES("rotation_radians")},
};

const struct field scene_gradient_fields[3] = {
    {.key = "zenith", FIELD_OF(environment_gradient, zenith), RADIANCE},
    {.key = "horizon", FIELD_OF(environment_gradient, horizon), RADIANCE},
    {.key = "nadir", FIELD_OF(environment_gradient, nadir), RADIANCE},
};

const struct field scene_sky_fields[5] = {
    {.key = "turbidity", FIELD_OF(sky, turbidity), REAL(SKY_TURBIDITY_MIN, SKY_TURBIDITY_MAX)},
    {.key = "sun_direction", FIELD_OF(sky, sun_direction), COORDINATES},
    {.key = "ground_albedo", FIELD_OF(sky, ground_albedo), VECTOR(0, 1)},
    {.key = "sun", .type = FIELD_SWITCH, FIELD_OF(sky, has_sun)},
    {.key = "sun_diameter_degrees",
     FIELD_OF(sky, sun_diameter),
     REAL(ENVIRONMENT_SUN_DIAMETER_MIN, ENVIRONMENT_SUN_DIAMETER_MAX),
     DEGREES("sun_diameter_radians")},
};

// --- bases ---------------------------------------------------------------------------------------

const struct field scene_base_fields[3] = {
    {.key = "studio",
     .type = FIELD_CHOICE,
     FIELD_OF(scene_load_params, studio),
     .words = scene_studio_names},
    {.key = "ground",
     .type = FIELD_CHOICE,
     FIELD_OF(scene_load_params, ground),
     .words = scene_ground_names},
    {.key = "up", .type = FIELD_CHOICE, FIELD_OF(scene_load_params, up), .words = scene_up_names},
};

const struct scene_base_text scene_base_texts[3] = {
    {"scene", offsetof(struct scene_load_params, scene_name)},
    {"animation", offsetof(struct scene_load_params, animation)},
    {"variant", offsetof(struct scene_load_params, variant)},
};
