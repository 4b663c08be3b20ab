#include "render/chance.h"

#include "base/maths.h"
#include "scene/core/emission.h"
#include "scene/core/environment.h"
#include "scene/core/light.h"
#include "scene/core/texture_load.h"
#include "shared/material.h"
#include "shared/methods.h"
#include <math.h>

#define LOBES_DIFFUSE (LOBE_LAMBERT | LOBE_DIFFUSE_TRANSMISSION)
#define LOBES_SCATTERING                                                                           \
    (LOBE_ROUGH - 1) // bits below LOBE_ROUGH are lobes; the others are properties of lobes

// Returns whether scattered rays may hit some emitter without a shadow ray having been aimed at it.
static bool leaves_to_chance(const struct scene *scene, const struct specialization *s)
{
    const struct settings *settings = &scene->settings;
    if (s->integrator == INTEGRATOR_AO || settings->max_bounces == 0)
        return false;
    return !settings->nee || settings->nee_depth < settings->max_bounces ||
           s->directions != DIRECTIONS_BSDF || (s->lobes & LOBES_SCATTERING & ~LOBES_DIFFUSE) != 0;
}

// Returns the least roughness of a material, including the textures that scale it.
static double least_roughness(const struct scene *scene, const struct material *material)
{
    double least = (double)material->roughness;
    for (uint32_t i = 0; i < material->texture_count; i++) {
        const struct texture *texture = &scene->textures[material->first_texture + i];
        const struct texture_image *image = &scene->images[texture->image];
        if (!texture_scales_parameter(texture, PARAMETER_ROUGHNESS))
            continue;
        uint32_t channel = texture_channel(texture, PARAMETER_ROUGHNESS);
        float texel = INFINITY;
        for (uint64_t t = 0; t < (uint64_t)image->width * image->height; t++) {
            float channels[4];
            texture_texel(image, t, channels);
            texel = fminf(texel, channels[channel]);
        }
        least *= (double)fmaxf(texel, 0.0f);
    }
    return least;
}

// Returns the greatest density, per solid angle, of a reflected direction when visible GGX normals
// are sampled. The density is D G1 / (4 cos); at grazing angles G1 / cos tends to 2 / alpha (Heitz
// 2018, "Sampling the GGX distribution of visible normals", eq. 19; Walter et al. 2007, eqs. 33 and
// 34).
static double sharpest_reflection(const struct scene *scene, const struct material *material)
{
    double roughness = least_roughness(scene, material), alpha = roughness * roughness;
    double aspect = sqrt(1.0 - 0.9 * (double)material->anisotropic), narrow = alpha * aspect;
    if (narrow < (double)MATERIAL_SMALLEST_ALPHA)
        return INFINITY;
    return 1.0 / (2.0 * M_PI * alpha / aspect * narrow * narrow);
}

// Returns the greatest density, per solid angle, with which a material samples a direction. It is
// infinite for delta lobes, and for refraction, coats and cosine powers, which may be nearly delta.
static double sharpest_of_material(const struct scene *scene, const struct material *material)
{
    bool has_layers = material->model == MATERIAL_PRINCIPLED &&
                      (material->transmission > 0.0f || material->clearcoat > 0.0f);
    if (has_layers)
        return INFINITY;
    switch (material->model) {
    case MATERIAL_LAMBERT:
        return 1.0 / M_PI;
    case MATERIAL_PRINCIPLED:
    case MATERIAL_CONDUCTOR:
    case MATERIAL_MICROFACET:
        return sharpest_reflection(scene, material);
    default:
        return INFINITY;
    }
}

// Returns whether shadow rays are aimed at infinitely far emitters with a density per solid angle,
// which MIS can compare with that of the BSDF.
static bool looks_far(const struct scene *scene, const struct emitters *emitters)
{
    for (uint32_t i = 0; i < scene->light_count; i++)
        if (scene->lights[i].angular_radius > 0.0)
            return true;
    return scene->environment.width > 0 && emitters->environment_pick > 0.0f;
}

// Returns the greatest density, per solid angle, with which a used surface of the scene samples a
// direction. It is infinite if MIS does not weight BSDF samples against shadow rays everywhere.
static double sharpest_lobe(const struct scene *scene, const struct flat_scene *flat,
                            const struct specialization *s, const struct emitters *emitters)
{
    const struct settings *settings = &scene->settings;
    if (!looks_far(scene, emitters) || !settings->nee ||
        settings->nee_depth < settings->max_bounces || s->directions != DIRECTIONS_BSDF ||
        s->normals != NORMALS_VISIBLE)
        return INFINITY;
    double sharpest = 1.0 / M_PI;
    for (uint32_t i = 0; i < scene->material_count; i++)
        if (flat->material_used[i])
            sharpest = fmax(sharpest, sharpest_of_material(scene, &scene->materials[i]));
    return sharpest;
}

// Returns the greatest radiance of the suns that count as found by chance. A sun does not count if
// shadow rays sample its directions with a density p above the greatest BSDF density q: by the
// balance heuristic both strategies then contribute f cos L / (p + q), and shadow rays do so more
// often. Only infinitely far emitters have the same density p for all points.
static float greatest_of_suns(const struct scene *scene, const struct emitters *emitters,
                              double sharpest)
{
    double greatest = 0.0;
    for (uint32_t i = 0; i < scene->light_count; i++) {
        const struct light *light = &scene->lights[i];
        if (!light_is_sun(light))
            continue;
        double solid_angle = 2.0 * M_PI * versine(light->angular_radius);
        double density = (double)emitters->lights[i].pick_probability / solid_angle;
        for (int c = 0; c < 3 && density < sharpest; c++)
            greatest = fmax(greatest, environment_sun_radiance((double)light->radiant[c],
                                                               light->angular_radius));
    }
    return (float)greatest;
}

// Returns the greatest radiance of the environment that is found by chance. The texel's density is
// divided by 4, because the density in a cell between texels may be as low as a quarter of that of
// its brightest texel.
static float greatest_of_environment(const struct environment *environment,
                                     const struct emitters *emitters, double sharpest)
{
    double floor = (double)emitters->environment_floor;
    double mean = environment_luminance_above(environment, floor);
    double pick = (double)emitters->environment_pick;
    if (!environment->present)
        return 0.0f;
    if (environment->width == 0 || !(pick > 0.0) || !(mean > 0.0) || isinf(sharpest))
        return environment_greatest(environment);
    float greatest = 0.0f;
    size_t count = (size_t)environment->width * environment->height;
    for (size_t i = 0; i < count; i++) {
        float radiance[3];
        for (int c = 0; c < 3; c++)
            radiance[c] = environment->radiance[c] * environment->texels[i][c];
        double above = fmax((double)luminance(radiance) - floor, 0.0);
        double density = pick * above / (4.0 * M_PI * mean);
        for (int c = 0; c < 3 && density / 4.0 < sharpest; c++)
            greatest = fmaxf(greatest, radiance[c]);
    }
    return greatest;
}

static float greatest_of_surfaces(const struct scene *scene, const struct flat_scene *flat)
{
    float greatest = 0.0f;
    for (uint32_t i = 0; i < scene->material_count; i++) {
        float radiance[3];
        greatest_radiance(scene, &scene->materials[i], radiance);
        for (int c = 0; c < 3 && flat->material_used[i]; c++)
            greatest = fmaxf(greatest, radiance[c]);
    }
    return greatest;
}

float brightest_by_chance(const struct scene *scene, const struct flat_scene *flat,
                          const struct specialization *specialization,
                          const struct emitters *emitters)
{
    if (!leaves_to_chance(scene, specialization))
        return 0.0f;
    double sharpest = sharpest_lobe(scene, flat, specialization, emitters);
    float greatest = fmaxf(greatest_of_suns(scene, emitters, sharpest),
                           greatest_of_environment(&scene->environment, emitters, sharpest));
    greatest = fmaxf(greatest, greatest_of_surfaces(scene, flat));
    float limit = scene->settings.clamp_limit;
    return limit > 0.0f ? fminf(greatest, limit) : greatest;
}
