#include "render/focus.h"

#include "render/tables/emitters.h"
#include "scene/core/scene.h"

// Surfaces with a greater alpha (roughness 0.3) do not count. Balls of metal and of glass with this
// alpha, under a small lamp, had the same errors by path and by bidir, within 2 %
// (docs/measurements/2026-11-27-auto.md).
#define SHARP_ALPHA 0.09f

enum sharpness { IS_DULL, IS_SHARP, IS_SPECULAR };

static enum sharpness of_alpha(float alpha)
{
    if (alpha < MATERIAL_SMALLEST_ALPHA)
        return IS_SPECULAR;
    return alpha <= SHARP_ALPHA ? IS_SHARP : IS_DULL;
}

// A textured roughness counts as perfectly specular, because it may have any value.
static enum sharpness of_roughness(const struct scene *scene, const struct material *m,
                                   uint32_t parameter)
{
    float roughness = m->parameters[parameter];
    return scene_parameter_is_textured(scene, m, parameter) ? IS_SPECULAR
                                                            : of_alpha(roughness * roughness);
}

static enum sharpness sharper(enum sharpness a, enum sharpness b)
{
    return a > b ? a : b;
}

static enum sharpness of_principled(const struct scene *scene, const struct material *m)
{
    enum sharpness base = of_roughness(scene, m, PARAMETER_ROUGHNESS);
    if (!(m->clearcoat > 0.0f))
        return base;
    return sharper(base, m->flags & MATERIAL_COAT_GGX
                             ? of_roughness(scene, m, PARAMETER_CLEARCOAT_ROUGHNESS)
                             : IS_SHARP);
}

static enum sharpness of_material(const struct scene *scene, const struct material *m)
{
    switch (material_shading_model(m)) {
    case MATERIAL_LAMBERT:
        return IS_DULL;
    case MATERIAL_MIRROR:
        return IS_SPECULAR;
    case MATERIAL_PRINCIPLED:
        return of_principled(scene, m);
    case MATERIAL_PHONG:
    case MATERIAL_BLINN_PHONG: {
        double roughness = material_phong_roughness((double)m->exponent);
        return of_alpha((float)(roughness * roughness));
    }
    default:
        return of_roughness(scene, m, PARAMETER_ROUGHNESS);
    }
}

static enum sharpness sharpest(const struct scene *scene, const struct flat_scene *flat)
{
    enum sharpness most = IS_DULL;
    for (uint32_t i = 0; i < scene->material_count; i++)
        if (flat->material_used[i])
            most = sharper(most, of_material(scene, &scene->materials[i]));
    return most;
}

struct focus_found focus_find(const struct scene *scene, const struct flat_scene *flat)
{
    const struct settings *settings = &scene->settings;
    const struct emitter_counts counts = emitters_count(scene, flat);
    enum sharpness sharpness = sharpest(scene, flat);
    struct focus_found found = {.delta_lights = counts.lights};
    // A path over a focusing surface has two scattering events: at this surface, and at the one
    // that its light reaches.
    if (settings->max_bounces < 2)
        found.reason = "paths have fewer than two scattering events";
    else if (!settings->nee || settings->nee_depth == 0)
        found.reason = "no shadow rays are sent";
    else if (emitters_total(&counts) == 0)
        found.reason = "light paths can begin at no emitter";
    else if (sharpness == IS_DULL)
        found.reason = "no surface is smooth enough to focus light";
    else
        found.focus = sharpness == IS_SPECULAR && counts.lights > 0 ? FOCUS_LOST : FOCUS_POSSIBLE;
    return found;
}
