#include "scene/sky/studio.h"

#include "base/hash.h"
#include "scene/core/affine.h"
#include "scene/core/bounds.h"
#include "scene/core/emission.h"
#include "scene/core/environment.h"
#include "scene/core/framing.h"
#include "scene/core/texture_load.h"
#include <math.h>
#include <string.h>

// --- the lights ----------------------------------------------------------------------------------

// A soft box: the direction of its centre from the model (azimuth from the camera to the right),
// half its width and height as tangents, and its irradiance on a surface facing it relative to that
// of the key light.
struct soft_box {
    double azimuth_degrees, elevation_degrees;
    double half_width, half_height;
    double share;
};

// The key light models the form from the upper left, the fill light brightens the key light's
// shadows to a quarter (a lighting ratio of 4 to 1), and the rim light from behind separates the
// model from the background.
static const struct soft_box boxes[] = {
    {-55, 42, 0.32, 0.32, 1.0},
    {65, 38, 0.6, 0.5, 0.12},
    {155, 62, 0.45, 0.35, 0.6},
};
#define BOX_COUNT (sizeof boxes / sizeof *boxes)

// The fraction of a box over which its light fades out on either side of its edge.
#define BOX_SOFTNESS 0.35
// The radiance of the background at the zenith relative to that at the horizon.
#define ZENITH_SHARE 0.5
// The reflectance of the ground below the model, and far away.
#define GROUND_NEAR 0.36
#define GROUND_FAR 0.17
// The radius of the ground's texture in radii of the model's bounding sphere.
#define GROUND_REACH 8.0

#define STUDIO_WIDTH 512
#define STUDIO_HEIGHT 256

// The light of the studio. `axes` point to the right, up and towards the camera.
struct studio {
    struct scene_axes axes;
    double boxes[BOX_COUNT][3][3]; // for each box, unit vectors to the right, up and to its centre
    double radiance[BOX_COUNT];
    double horizon; // radiance of the background at the horizon
};

static double smoothstep(double x)
{
    x = fmin(fmax(x, 0), 1);
    return x * x * (3 - 2 * x);
}

static double box_edge(double x, double half)
{
    double soft = BOX_SOFTNESS * half;
    return smoothstep((half + soft - fabs(x)) / (2 * soft));
}

// Returns the relative radiance of a box in a direction, from 0 to 1.
static double box_profile(const struct studio *studio, size_t box, const double direction[3])
{
    const double(*frame)[3] = studio->boxes[box];
    double ahead = vec3_dot(direction, frame[2]);
    if (!(ahead > 0))
        return 0;
    return box_edge(vec3_dot(direction, frame[0]) / ahead, boxes[box].half_width) *
           box_edge(vec3_dot(direction, frame[1]) / ahead, boxes[box].half_height);
}

// Returns the radiance of the background relative to that at the horizon; below the horizon it
// equals that of the distant ground.
static double background(double height)
{
    return 1 - (1 - ZENITH_SHARE) * smoothstep(height);
}

static void aim_boxes(struct studio *studio)
{
    const struct scene_axes *axes = &studio->axes;
    for (size_t b = 0; b < BOX_COUNT; b++) {
        double azimuth = boxes[b].azimuth_degrees * DEGREE;
        double elevation = boxes[b].elevation_degrees * DEGREE;
        double(*frame)[3] = studio->boxes[b];
        for (int i = 0; i < 3; i++)
            frame[2][i] =
                cos(elevation) * (sin(azimuth) * axes->right[i] + cos(azimuth) * axes->front[i]) +
                sin(elevation) * axes->up[i];
        vec3_cross(axes->up, frame[2], frame[0]);
        vec3_normalize(frame[0]);
        vec3_cross(frame[2], frame[0], frame[1]);
    }
}

// Rotates the axes about the up axis so that the front faces the camera. Leaves them unchanged if
// the camera looks straight up or down.
static void face_camera(const struct scene *scene, struct scene_axes *axes)
{
    double side[3], front[3];
    if (scene->camera_count == 0) {
        framing_towards_camera(scene->up, front);
    } else {
        for (int i = 0; i < 3; i++)
            front[i] = -scene->cameras[0].direction[i];
    }
    vec3_cross(axes->up, front, side);
    if (!vec3_normalize(side))
        return;
    memcpy(axes->right, side, sizeof side);
    vec3_cross(axes->right, axes->up, axes->front);
}

// --- the environment -----------------------------------------------------------------------------

struct texel {
    double direction[3], solid_angle;
};

// Returns the direction of the centre of a texel: the inverse of the mapping of environment.h.
static struct texel texel_at(const struct environment *environment, uint32_t row, uint32_t column)
{
    double polar = M_PI * (row + 0.5) / environment->height;
    double around = 2 * M_PI * ((column + 0.5) / environment->width - 0.5);
    return (struct texel){
        .direction = {sin(polar) * cos(around), cos(polar), sin(polar) * sin(around)},
        .solid_angle = environment_texel_solid_angle(environment, row),
    };
}

// The irradiance from each box of radiance 1, on a surface facing it (`faced`) and on a horizontal
// surface (`level`), and the irradiance from the background on a horizontal surface, if the
// background has radiance 1 at the horizon.
struct received {
    double faced[BOX_COUNT], level[BOX_COUNT], background;
};

static struct received receive(const struct studio *studio, const struct environment *environment)
{
    struct received sum = {0};
    for (uint32_t row = 0; row < environment->height; row++)
        for (uint32_t column = 0; column < environment->width; column++) {
            struct texel texel = texel_at(environment, row, column);
            double height = vec3_dot(texel.direction, studio->axes.up);
            double level = fmax(height, 0) * texel.solid_angle;
            sum.background += background(height) * level;
            for (size_t b = 0; b < BOX_COUNT; b++) {
                double profile = box_profile(studio, b, texel.direction);
                double faced = vec3_dot(texel.direction, studio->boxes[b][2]);
                sum.faced[b] += profile * fmax(faced, 0) * texel.solid_angle;
                sum.level[b] += profile * level;
            }
        }
    return sum;
}

// Sets the boxes by their relative irradiances and the background to the radiance of the distant
// ground, and scales the boxes so that a horizontal surface receives pi. The background's radiance
// h and the irradiance E of the ground depend on each other: h = GROUND_FAR / pi E, E = E_boxes + h
// E_background. With E = pi, h = GROUND_FAR and E_boxes = pi - GROUND_FAR E_background.
static void set_radiance(struct studio *studio, const struct environment *environment)
{
    const struct received received = receive(studio, environment);
    double level = 0;
    for (size_t b = 0; b < BOX_COUNT; b++) {
        studio->radiance[b] = boxes[b].share / received.faced[b];
        level += studio->radiance[b] * received.level[b];
    }
    studio->horizon = GROUND_FAR;
    double scale = (M_PI - GROUND_FAR * received.background) / level;
    for (size_t b = 0; b < BOX_COUNT; b++)
        studio->radiance[b] *= scale;
}

static double radiance_along(const struct studio *studio, const double direction[3])
{
    double sum = studio->horizon * background(vec3_dot(direction, studio->axes.up));
    for (size_t b = 0; b < BOX_COUNT; b++)
        sum += studio->radiance[b] * box_profile(studio, b, direction);
    return sum;
}

static bool add_light(struct scene *scene, const struct scene_axes *axes, struct err *err)
{
    struct environment environment = {
        .present = true, .radiance = {1, 1, 1}, .width = STUDIO_WIDTH, .height = STUDIO_HEIGHT};
    struct studio studio = {.axes = *axes};
    const size_t count = STUDIO_WIDTH * STUDIO_HEIGHT;
    environment.texels = arena_alloc(&scene->arena, count, sizeof *environment.texels);
    if (!environment.texels)
        return err_memory(err, "a studio", count * sizeof *environment.texels);
    aim_boxes(&studio);
    set_radiance(&studio, &environment);
    for (uint32_t row = 0; row < STUDIO_HEIGHT; row++)
        for (uint32_t column = 0; column < STUDIO_WIDTH; column++) {
            struct texel texel = texel_at(&environment, row, column);
            float *out = environment.texels[(size_t)row * STUDIO_WIDTH + column];
            out[0] = out[1] = out[2] = (float)radiance_along(&studio, texel.direction);
        }
    scene->environment = environment;
    return true;
}

// --- the ground ----------------------------------------------------------------------------------

#define GROUND_TEXELS 64

// Makes the texture of the ground. Its reflectance decreases with the distance from the centre,
// from GROUND_NEAR to GROUND_FAR at the edge of the image and beyond.
static bool add_ground_image(struct scene *scene, uint32_t *index, struct err *err)
{
    const size_t count = GROUND_TEXELS * GROUND_TEXELS;
    float(*texels)[4] = arena_alloc(&scene->arena, count, sizeof *texels);
    struct texture_image *image = scene_add_image(scene, index);
    if (!image || !texels)
        return err_memory(err, "a ground", count * sizeof *texels);
    double sum = 0;
    for (size_t i = 0; i < count; i++) {
        double s = 2 * ((double)(i % GROUND_TEXELS) + 0.5) / GROUND_TEXELS - 1;
        double t = 2 * ((double)(i / GROUND_TEXELS) + 0.5) / GROUND_TEXELS - 1;
        double value = GROUND_FAR + (GROUND_NEAR - GROUND_FAR) * smoothstep(1 - hypot(s, t));
        sum += value;
        for (int c = 0; c < 4; c++)
            texels[i][c] = c < 3 ? (float)value : 1.0f;
    }
    float mean = (float)(sum / (double)count);
    *image = (struct texture_image){
        .name = "ground",
        .width = GROUND_TEXELS,
        .height = GROUND_TEXELS,
        .texels = texels,
        .mean = {mean, mean, mean, 1},
        .greatest = 1,
        .hash = hash_bytes(HASH_INIT, texels, count * sizeof *texels),
    };
    return true;
}

static bool add_ground_material(struct scene *scene, double radius, uint32_t *index,
                                struct err *err)
{
    float scale = (float)(1 / (2 * GROUND_REACH * radius));
    struct texture texture = {
        .flags = texture_scales(GROUP_BASE, (const int[4]){0, 1, 2, -1}) |
                 TEXTURE_WRAP_CLAMP << TEXTURE_WRAP_S_SHIFT |
                 TEXTURE_WRAP_CLAMP << TEXTURE_WRAP_T_SHIFT,
        .transform = {{scale, 0, 0.5f}, {0, scale, 0.5f}},
    };
    struct material *material = scene_add_material(scene, index);
    if (!material)
        return err_memory(err, "a ground", sizeof *material);
    material->name = "ground";
    for (int c = 0; c < 3; c++)
        material->base_color[c] = 1;
    return add_ground_image(scene, &texture.image, err) &&
           material_add_texture(scene, material, &texture, err);
}

// Adds the ground 2^-14 of the radius below the lowest point, so that a flat bottom of the model
// hides it. Rounding errors are far smaller: coordinates as large as the camera's distance, about
// four radii, have steps of 2^-22 of the radius. The gap is a tenth of a pixel in an image of 1000
// lines.
static bool add_ground(struct scene *scene, const struct scene_axes *axes, struct err *err)
{
    const struct scene_part whole = scene_whole(scene);
    const struct bounds bounds = bounds_of_part(scene, &whole);
    double center[3], lowest, down[1][3];
    for (int i = 0; i < 3; i++) {
        center[i] = (bounds.min[i] + bounds.max[i]) / 2;
        down[0][i] = -axes->up[i];
    }
    double radius = bounds_radius(scene, &whole, center);
    if (bounds_is_empty(&bounds) || !(radius > 0))
        return true;
    bounds_support(scene, &whole, 1, (const double(*)[3])down, &lowest);
    double height = -lowest - radius / 16384;
    uint32_t material;
    if (!add_ground_material(scene, radius, &material, err))
        return false;
    struct shape *plane = scene_add_shape(scene, NULL);
    if (!plane)
        return err_memory(err, "a ground", sizeof *plane);
    plane->kind = SHAPE_PLANE;
    plane->material = material;
    double above = height - vec3_dot(center, axes->up);
    for (int i = 0; i < 3; i++) {
        plane->center[i] = center[i] + above * axes->up[i];
        plane->normal[i] = axes->up[i];
        plane->axes[1][i] = axes->right[i];
    }
    scene->has_ground = true;
    scene->hash = hash_bytes(scene->hash, plane->center, sizeof plane->center);
    scene->hash = hash_bytes(scene->hash, plane->normal, sizeof plane->normal);
    return true;
}

// --- the scene's own light -----------------------------------------------------------------------

static bool has_emission(const struct scene *scene)
{
    for (uint32_t i = 0; i < scene->shape_count; i++)
        if (mean_radiance(scene, &scene->materials[scene->shapes[i].material]) > 0)
            return true;
    return scene_has_emissive_triangles(scene);
}

bool scene_is_lit(const struct scene *scene, double *emission)
{
    *emission = 0;
    if (scene->environment.present)
        return true;
    if (!scene->is_model)
        return scene->light_count > 0 || has_emission(scene);
    const struct scene_part whole = scene_whole(scene);
    const struct bounds bounds = bounds_of_part(scene, &whole);
    double center[3];
    for (int i = 0; i < 3; i++)
        center[i] = (bounds.min[i] + bounds.max[i]) / 2;
    double radius = bounds_radius(scene, &whole, center);
    if (!(radius > 0)) // nothing receives light, so its amount does not matter
        return scene->light_count > 0 || has_emission(scene);
    *emission = (scene_emitted_flux(scene) + scene_light_flux(scene, center, radius)) /
                (4 * M_PI * radius * radius);
    return *emission >= STUDIO_EMISSION_LEAST ||
           (*emission == 0 && scene_has_emissive_triangles(scene));
}

// --- additions -----------------------------------------------------------------------------------

static bool provide_even_light(struct scene *scene, struct err *err)
{
    scene->environment = (struct environment){.present = true, .radiance = {1, 1, 1}};
    return scene_note(scene, "no light in the file: constant environment of radiance 1") ||
           err_memory(err, "a note", 0);
}

static bool provide_studio(struct scene *scene, double emission, struct err *err)
{
    struct scene_axes axes = scene_axes(scene->up);
    face_camera(scene, &axes);
    if (!add_light(scene, &axes, err))
        return false;
    scene->has_studio = true;
    scene->weak_emission = emission;
    const uint8_t hashed[] = {'s', 't', 'u', 'd', 'i', 'o', 1, (uint8_t)scene->up};
    scene->hash = hash_bytes(scene->hash, hashed, sizeof hashed);
    return true;
}

// Returns whether to add a ground. With SCENE_GROUND_AUTO, all cameras of a model must be above it,
// because a camera below would see nothing else, and a .json scene must have no camera.
static bool wants_ground(const struct scene *scene, enum scene_ground choice)
{
    const struct scene_axes axes = scene_axes(scene->up);
    const double down[1][3] = {{-axes.up[0], -axes.up[1], -axes.up[2]}};
    const struct scene_part whole = scene_whole(scene);
    double lowest;
    if (choice != SCENE_GROUND_AUTO || !scene->has_studio)
        return choice == SCENE_GROUND_ON;
    bounds_support(scene, &whole, 1, down, &lowest);
    for (uint32_t i = 0; i < scene->camera_count; i++)
        if (!scene->is_model || vec3_dot(scene->cameras[i].position, axes.up) <= -lowest)
            return false;
    return true;
}

bool scene_provide_light(struct scene *scene, const struct scene_load_params *params,
                         struct err *err)
{
    double emission;
    bool is_lit = scene_is_lit(scene, &emission);
    bool is_bare = scene->is_model || scene->camera_count == 0;
    bool ok = true;
    if (params->studio == SCENE_STUDIO_ON || (!is_lit && params->studio && is_bare))
        ok = provide_studio(scene, is_lit ? 0 : emission, err);
    else if (!is_lit && !(emission > 0))
        ok = provide_even_light(scene, err);
    if (!ok || !wants_ground(scene, params->ground))
        return ok;
    struct scene_axes axes = scene_axes(scene->up);
    face_camera(scene, &axes);
    return add_ground(scene, &axes, err);
}

// --- notes ---------------------------------------------------------------------------------------

// Moves the last note to the front, because a summary may only have room for one.
static void put_last_note_first(struct scene *scene)
{
    const char *last = scene->notes[scene->note_count - 1];
    memmove(scene->notes + 1, scene->notes, (scene->note_count - 1) * sizeof *scene->notes);
    scene->notes[0] = last;
}

bool scene_note_additions(struct scene *scene, struct err *err)
{
    const char *camera = "", *light = "", *ground = scene->has_ground ? ", ground (--ground)" : "";
    if (scene->camera_is_framed)
        camera = arena_printf(&scene->arena, ", view with %s up (--up)", scene_up_names[scene->up]);
    if (scene->has_studio)
        light = ", studio light (--studio, --env)";
    if (!camera)
        return err_memory(err, "a note", 0);
    if (!*camera && !*light && !*ground)
        return true;
    if (!scene_note(scene, "added:%s%s%s", *light ? light + 1 : "",
                    *light || *ground ? ground + (*light == 0) : "",
                    *light || *ground ? camera : camera + 1))
        return err_memory(err, "a note", 0);
    put_last_note_first(scene);
    return !(scene->weak_emission > 0) ||
           scene_note(
               scene,
               "the file's own light is only %.2g of the studio's; from %g on, the studio would "
               "not be added",
               scene->weak_emission, STUDIO_EMISSION_LEAST) ||
           err_memory(err, "a note", 0);
}
