#include "scene/core/emission.h"

#include "scene/core/affine.h"
#include "scene/core/bounds.h"
#include "shared/types.h"
#include <math.h>
#include <string.h>

// Multiplies `count` parameters, beginning with `first`, by the means of their textures.
static void scale_by_textures(const struct scene *scene, const struct material *material,
                              uint32_t first, uint32_t count, float *values)
{
    for (uint32_t i = 0; i < material->texture_count; i++) {
        const struct texture *texture = &scene->textures[material->first_texture + i];
        const float *channels = scene->images[texture->image].mean;
        for (uint32_t c = 0; c < count; c++)
            if (texture_scales_parameter(texture, first + c))
                values[c] *= channels[texture_channel(texture, first + c)];
    }
}

void mean_emission(const struct scene *scene, const struct material *material, float out[3])
{
    memset(out, 0, 3 * sizeof *out);
    if (!material_emits(material) || (material->flags & MATERIAL_UNLIT))
        return;
    memcpy(out, material->emission, 3 * sizeof *out);
    scale_by_textures(scene, material, PARAMETER_EMISSION, 3, out);
}

double mean_radiance(const struct scene *scene, const struct material *material)
{
    float mean[3];
    mean_emission(scene, material, mean);
    return luminance(mean);
}

double mean_opacity(const struct scene *scene, const struct material *material)
{
    float mean = material->opacity;
    if (!(material->flags & (MATERIAL_ALPHA_MASK | MATERIAL_ALPHA_BLEND)))
        return 1;
    scale_by_textures(scene, material, PARAMETER_OPACITY, 1, &mean);
    if (material->flags & MATERIAL_ALPHA_MASK)
        return mean >= material->alpha_cutoff;
    return fmin((double)mean, 1);
}

void greatest_radiance(const struct scene *scene, const struct material *material, float out[3])
{
    bool emits = material_emits(material);
    for (uint32_t c = 0; c < 3; c++)
        out[c] = emits ? material->emission[c] : 0.0f;
    for (uint32_t i = 0; i < material->texture_count; i++) {
        const struct texture *texture = &scene->textures[material->first_texture + i];
        for (uint32_t c = 0; c < 3; c++)
            if (texture_scales_parameter(texture, PARAMETER_EMISSION + c))
                out[c] *= scene->images[texture->image].greatest;
    }
}

double triangle_world_area(const struct mesh *mesh, const double transform[3][4], uint32_t triangle)
{
    double corner[3][3], edge[2][3], normal[3];
    for (int i = 0; i < 3; i++) {
        mesh_vertex(mesh, mesh->indices[triangle][i], corner[i]);
        affine_point(transform, corner[i], corner[i]);
    }
    vec3_subtract(corner[1], corner[0], edge[0]);
    vec3_subtract(corner[2], corner[0], edge[1]);
    vec3_cross(edge[0], edge[1], normal);
    return vec3_length(normal) / 2;
}

static uint32_t material_of(const struct mesh *mesh, const struct instance *instance,
                            uint32_t triangle)
{
    return instance->material != SCENE_NONE ? instance->material
           : mesh->triangle_material        ? mesh->triangle_material[triangle]
                                            : mesh->material;
}

static double instance_flux(const struct scene *scene, const struct instance *instance)
{
    const struct mesh *mesh = &scene->meshes[instance->mesh];
    double sum = 0, radiance = 0;
    uint32_t last = SCENE_NONE;
    for (uint32_t t = 0; t < mesh->triangle_count && !progress_stops_at(scene->progress, t + 1);
         t++) {
        uint32_t material = material_of(mesh, instance, t);
        if (material != last)
            radiance = mean_radiance(scene, &scene->materials[material]);
        last = material;
        if (radiance > 0)
            sum += radiance * triangle_world_area(mesh, instance->transform, t);
    }
    return sum;
}

double scene_emitted_flux(const struct scene *scene)
{
    double sum = 0;
    for (uint32_t i = 0; i < scene->instance_count && !progress_should_stop(scene->progress); i++)
        sum += instance_flux(scene, &scene->instances[i]);
    return sum;
}

static bool instance_emits(const struct scene *scene, const struct instance *instance)
{
    const struct mesh *mesh = &scene->meshes[instance->mesh];
    uint32_t last = SCENE_NONE;
    for (uint32_t t = 0; t < mesh->triangle_count && !progress_stops_at(scene->progress, t + 1);
         t++) {
        uint32_t material = material_of(mesh, instance, t);
        if (material != last && mean_radiance(scene, &scene->materials[material]) > 0)
            return true;
        last = material;
    }
    return false;
}

bool scene_has_emissive_triangles(const struct scene *scene)
{
    for (uint32_t i = 0; i < scene->instance_count && !progress_should_stop(scene->progress); i++)
        if (instance_emits(scene, &scene->instances[i]))
            return true;
    return false;
}

// --- lights --------------------------------------------------------------------------------------

static double cap_solid_angle(double angle)
{
    double half = sin(angle / 2);
    return 4 * M_PI * half * half;
}

// Returns the solid angle within which a point or spot light sends light to the sphere; for a spot
// light, an upper bound.
static double solid_angle_towards(const struct light *light, const double center[3], double radius)
{
    double towards[3];
    vec3_subtract(center, light->position, towards);
    double distance = vec3_length(towards);
    bool is_inside = distance <= radius, is_spot = light->kind == LIGHT_SPOT;
    double sphere = is_inside ? M_PI : asin(radius / distance);
    if (!is_inside && distance - radius > (double)light->range)
        return 0;
    if (!is_spot)
        return cap_solid_angle(sphere);
    double cosine = is_inside ? 1 : vec3_dot(towards, light->direction) / distance;
    if (!is_inside && acos(fmin(fmax(cosine, -1), 1)) > sphere + (double)light->outer_angle)
        return 0;
    return cap_solid_angle(fmin(sphere, (double)light->outer_angle));
}

double scene_light_flux(const struct scene *scene, const double center[3], double radius)
{
    double sum = 0;
    for (uint32_t i = 0; i < scene->light_count; i++) {
        const struct light *light = &scene->lights[i];
        double radiant = luminance(light->radiant);
        sum += light->kind == LIGHT_DIRECTIONAL
                   ? radiant * radius * radius
                   : radiant * solid_angle_towards(light, center, radius) / M_PI;
    }
    return sum;
}
