#include "scene/core/environment.h"

#include "base/file.h"
#include "base/hash.h"
#include "base/maths.h"
#include "image/image.h"
#include "shared/types.h"
#include <math.h>
#include <string.h>

static bool check_radiance(const float radiance[3], struct err *err)
{
    for (int c = 0; c < 3; c++)
        if (!(radiance[c] >= 0 && radiance[c] <= (float)SCENE_RADIANCE_MAX))
            return err_set(err, ERR_INPUT, "radiance %.9g is outside [0, %g]", (double)radiance[c],
                           SCENE_RADIANCE_MAX);
    return true;
}

static bool hash_file(struct scene *scene, const char *path, struct err *err)
{
    struct arena scratch = {0};
    struct file_bytes bytes;
    bool ok = file_read(&scratch, path, 0, &bytes, err);
    if (ok)
        scene->hash = hash_bytes(scene->hash, bytes.data, bytes.size);
    arena_finish(&scratch);
    return ok;
}

// Sets invalid texels to 0 and counts them. Returns false with *err set if a texel exceeds the
// maximum radiance.
static bool clean_texels(struct scene *scene, const char *path, struct image *image,
                         const float factor[3], uint64_t *zeroed, struct err *err)
{
    size_t count = (size_t)image->width * image->height;
    for (size_t i = 0; i < count; i++) {
        if (!scene_goes_on(scene, i, err))
            return false;
        float *texel = image->pixels[i];
        if (!isfinite(texel[0]) || !isfinite(texel[1]) || !isfinite(texel[2]) || texel[0] < 0 ||
            texel[1] < 0 || texel[2] < 0) {
            texel[0] = texel[1] = texel[2] = 0;
            ++*zeroed;
        }
        for (int c = 0; c < 3; c++)
            if ((double)texel[c] * (double)factor[c] > SCENE_RADIANCE_MAX)
                return err_set(err, ERR_INPUT, "%s: texel %zu, %zu: radiance %g exceeds %g", path,
                               i % image->width, i / image->width,
                               (double)texel[c] * (double)factor[c], SCENE_RADIANCE_MAX);
    }
    return *zeroed == 0 ||
           scene_note(scene, "%s: %zu of %zu texels were negative or not finite and are black",
                      path, (size_t)*zeroed, count) ||
           err_memory(err, "a note", 0);
}

static bool load_image(struct scene *scene, const char *path, const float factor[3],
                       struct environment *out, struct err *err)
{
    const struct image_read_params params = {.path = path, .progress = scene->progress};
    struct image image = {0};
    if (!hash_file(scene, path, err) || !image_read(&params, &scene->arena, &image, err))
        return false;
    if (image.width > ENVIRONMENT_SIZE_MAX || image.height > ENVIRONMENT_SIZE_MAX)
        return err_set(err, ERR_INPUT, "%s: is %u x %u pixels; expected at most %d on a side", path,
                       image.width, image.height, ENVIRONMENT_SIZE_MAX);
    if (!clean_texels(scene, path, &image, factor, &out->zeroed, err))
        return false;
    out->width = image.width;
    out->height = image.height;
    out->texels = image.pixels;
    return true;
}

bool scene_set_environment(struct scene *scene, const char *file, const float radiance[3],
                           struct err *err)
{
    struct environment environment = {.present = true, .radiance = {1, 1, 1}};
    for (int c = 0; radiance && c < 3; c++)
        environment.radiance[c] = radiance[c];
    if (!check_radiance(environment.radiance, err))
        return false;
    scene->hash = hash_bytes(scene->hash, environment.radiance, sizeof environment.radiance);
    if (file && !load_image(scene, file, environment.radiance, &environment, err))
        return false;
    if (file && !(environment.file = arena_strdup(&scene->arena, file)))
        return err_memory(err, "a path", strlen(file) + 1);
    scene->environment = environment;
    return true;
}

bool scene_set_gradient(struct scene *scene, const struct environment_gradient *gradient,
                        struct err *err)
{
    struct environment environment = {
        .present = true, .radiance = {1, 1, 1}, .width = 1, .height = ENVIRONMENT_GRADIENT_ROWS};
    if (!check_radiance(gradient->zenith, err) || !check_radiance(gradient->horizon, err) ||
        !check_radiance(gradient->nadir, err))
        return false;
    struct environment_gradient *source = ARENA_NEW(&scene->arena, struct environment_gradient, 1);
    environment.texels = arena_alloc(&scene->arena, environment.height, sizeof *environment.texels);
    if (!environment.texels || !source)
        return err_memory(err, "a gradient", environment.height * sizeof *environment.texels);
    *source = *gradient;
    environment.gradient = source;
    for (uint32_t row = 0; row < environment.height; row++) {
        // Solid angle is uniform in the height y (Archimedes), so the mean over a row of a function
        // that is linear in y is its value at the row's mean y.
        double height = 0.5 * (cos(M_PI * row / environment.height) +
                               cos(M_PI * (row + 1) / environment.height));
        const float *pole = height > 0 ? gradient->zenith : gradient->nadir;
        for (int c = 0; c < 3; c++)
            environment.texels[row][c] = (float)((double)gradient->horizon[c] * (1 - fabs(height)) +
                                                 (double)pole[c] * fabs(height));
    }
    scene->hash = hash_bytes(scene->hash, gradient, sizeof *gradient);
    scene->environment = environment;
    return true;
}

double environment_sun_radiance(double irradiance, double angular_radius)
{
    // The integral of the cosine over the disc is pi sin^2 of its angular radius.
    double sine = sin(angular_radius);
    return irradiance / (M_PI * sine * sine);
}

float environment_greatest(const struct environment *environment)
{
    float largest = 0;
    size_t count = (size_t)environment->width * environment->height;
    for (size_t i = 0; i < count; i++)
        for (int c = 0; c < 3; c++)
            largest = fmaxf(largest, environment->texels[i][c] * environment->radiance[c]);
    for (int c = 0; c < 3 && count == 0; c++)
        largest = fmaxf(largest, environment->radiance[c]);
    return largest;
}

static void turn(double direction[3], double radians)
{
    double x = direction[0], z = direction[2];
    direction[0] = x * cos(radians) + z * sin(radians);
    direction[2] = z * cos(radians) - x * sin(radians);
}

bool scene_adjust_environment(struct scene *scene, double radians, double strength, struct err *err)
{
    struct environment *environment = &scene->environment;
    struct environment_sun *sun = &environment->sun;
    if (!environment->present || (radians == 0 && strength == 1))
        return true;
    double largest = (double)environment_greatest(environment);
    for (int c = 0; c < 3 && sun->angular_radius > 0; c++)
        largest = fmax(largest,
                       environment_sun_radiance((double)sun->irradiance[c], sun->angular_radius));
    if (!(strength >= 0 && largest * strength <= (double)(float)SCENE_RADIANCE_MAX))
        return err_set(err, ERR_INPUT,
                       "a strength of %.9g makes the radiance %g; expected at most %g", strength,
                       largest * strength, SCENE_RADIANCE_MAX);
    for (int c = 0; c < 3; c++) {
        environment->radiance[c] = (float)((double)environment->radiance[c] * strength);
        sun->irradiance[c] = (float)((double)sun->irradiance[c] * strength);
    }
    environment->rotation += radians;
    turn(sun->direction, radians);
    if (sun->light > 0) {
        struct light *light = &scene->lights[sun->light - 1];
        turn(light->direction, radians);
        for (int c = 0; c < 3; c++)
            light->radiant[c] = (float)((double)light->radiant[c] * strength);
    }
    const double hashed[] = {radians, strength};
    scene->hash = hash_bytes(scene->hash, hashed, sizeof hashed);
    return true;
}

bool scene_add_sky_sun(struct scene *scene, struct err *err)
{
    struct environment_sun *sun = &scene->environment.sun;
    if (!(sun->angular_radius > 0) || sun->light > 0)
        return true;
    struct light *light = scene_add_light(scene, NULL);
    if (!light)
        return err_memory(err, "a sun", sizeof *light);
    light->name = "sun";
    light->kind = LIGHT_DIRECTIONAL;
    light->range = INFINITY;
    light->angular_radius = sun->angular_radius;
    for (int c = 0; c < 3; c++) {
        light->direction[c] = sun->direction[c];
        light->radiant[c] = sun->irradiance[c];
    }
    sun->light = scene->light_count;
    return true;
}

uint32_t scene_sun_light(const struct scene *scene)
{
    uint32_t light = scene->environment.present ? scene->environment.sun.light : 0;
    return light > 0 ? light - 1 : SCENE_NONE;
}

struct light *scene_insert_light(struct scene *scene, uint32_t *index)
{
    uint32_t sun = scene_sun_light(scene), place;
    struct light *added = scene_add_light(scene, &place);
    if (!added)
        return NULL;
    if (sun != SCENE_NONE) {
        struct light fresh = *added;
        *added = scene->lights[sun];
        scene->lights[sun] = fresh;
        scene->environment.sun.light = place + 1;
        place = sun;
    }
    if (index)
        *index = place;
    return &scene->lights[place];
}

void scene_take_light(struct scene *scene)
{
    uint32_t sun = scene_sun_light(scene);
    if (sun != SCENE_NONE) {
        scene->lights[sun - 1] = scene->lights[sun];
        scene->environment.sun.light = sun;
    }
    scene->light_count--;
}

void scene_remove_sun(struct scene *scene, const struct environment *former)
{
    if (former->sun.light > 0)
        scene->light_count = former->sun.light - 1;
}

double environment_texel_solid_angle(const struct environment *environment, uint32_t row)
{
    // cos a - cos b = 2 sin((a + b) / 2) sin((b - a) / 2), which does not cancel.
    double half = 0.5 * M_PI / environment->height;
    return 2 * M_PI / environment->width * 2 * sin((2.0 * row + 1) * half) * sin(half);
}

double environment_cell_solid_angle(const struct environment *environment, uint32_t row)
{
    double half = 0.5 * M_PI / environment->height;
    double top = row > 0 ? row - 0.5 : 0;
    double bottom = row < environment->height ? row + 0.5 : environment->height;
    return 2 * M_PI / environment->width * 2 * sin((top + bottom) * half) *
           sin((bottom - top) * half);
}

double environment_luminance(const struct environment *environment)
{
    double mean[3] = {1, 1, 1};
    for (uint32_t row = 0; row < environment->height; row++) {
        const float(*texels)[3] =
            (const float(*)[3])environment->texels + (size_t)row * environment->width;
        double sum[3] = {0, 0, 0};
        for (uint32_t i = 0; i < environment->width; i++)
            for (int c = 0; c < 3; c++)
                sum[c] += (double)texels[i][c];
        double part = environment_texel_solid_angle(environment, row) / (4 * M_PI);
        for (int c = 0; c < 3; c++)
            mean[c] = (row > 0 ? mean[c] : 0) + part * sum[c];
    }
    for (int c = 0; c < 3; c++)
        mean[c] *= (double)environment->radiance[c];
    return environment->present ? vec3_luminance(mean) : 0;
}

double environment_luminance_above(const struct environment *environment, double floor)
{
    if (!(floor > 0))
        return environment_luminance(environment);
    double mean = 0;
    for (uint32_t row = 0; row < environment->height; row++) {
        double sum = 0;
        for (uint32_t i = 0; i < environment->width; i++) {
            const float *texel = environment->texels[(size_t)row * environment->width + i];
            double radiance[3];
            for (int c = 0; c < 3; c++)
                radiance[c] = (double)texel[c] * (double)environment->radiance[c];
            sum += fmax(vec3_luminance(radiance) - floor, 0.0);
        }
        mean += environment_texel_solid_angle(environment, row) / (4 * M_PI) * sum;
    }
    return environment->present ? mean : 0;
}
