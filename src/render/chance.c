#include "render/chance.h"

#include "scene/core/environment.h"
#include "shared/material.h"
#include "shared/methods.h"
#include <math.h>

#define LOBES_DIFFUSE (LOBE_LAMBERT | LOBE_DIFFUSE_TRANSMISSION)
#define LOBES_SCATTERING (LOBE_ROUGH - 1) // below it are lobes, from it on what they need

// Whether a path may meet any emitter by chance.
static bool leaves_to_chance(const struct scene *scene, const struct specialization *s)
{
    const struct settings *settings = &scene->settings;
    if (s->integrator == INTEGRATOR_AO || settings->max_bounces == 0)
        return false;
    return !settings->nee || settings->nee_depth < settings->max_bounces ||
           s->directions != DIRECTIONS_BSDF || (s->lobes & LOBES_SCATTERING & ~LOBES_DIFFUSE) != 0;
}

static float emission_of(const struct scene *scene, uint32_t index)
{
    const struct material *material = &scene->materials[index];
    const float *e = material->emission;
    return material_emits(material) ? fmaxf(e[0], fmaxf(e[1], e[2])) : 0.0f;
}

static float greatest_of_lights(const struct scene *scene)
{
    float greatest = 0.0f;
    for (uint32_t i = 0; i < scene->light_count; i++) {
        const struct light *light = &scene->lights[i];
        for (int c = 0; c < 3 && light->angular_radius > 0.0f; c++)
            greatest =
                fmaxf(greatest, (float)environment_sun_radiance((double)light->radiant[c],
                                                                (double)light->angular_radius));
    }
    return greatest;
}

float brightest_by_chance(const struct scene *scene, const struct flat_scene *flat,
                          const struct specialization *specialization)
{
    if (!leaves_to_chance(scene, specialization))
        return 0.0f;
    float greatest = greatest_of_lights(scene);
    if (scene->environment.present)
        greatest = fmaxf(greatest, environment_greatest(&scene->environment));
    for (uint32_t i = 0; i < flat->triangle_count; i++)
        greatest = fmaxf(greatest, emission_of(scene, flat->triangles[i].material));
    for (uint32_t i = 0; i < flat->shape_count; i++)
        greatest = fmaxf(greatest, emission_of(scene, flat->shapes[i].material));
    float limit = scene->settings.clamp_limit;
    return limit > 0.0f ? fminf(greatest, limit) : greatest;
}
