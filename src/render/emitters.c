#include "emitters.h"

#include "alias_table.h"
#include "log.h"
#include <math.h>
#include <string.h>

static double luminance(const float rgb[3])
{
    return 0.2126 * (double)rgb[0] + 0.7152 * (double)rgb[1] + 0.0722 * (double)rgb[2]; // BT.709
}

// The mean radiance of a material's surfaces: textures scale what the parameters say.
static double mean_radiance(const struct scene *scene, const struct material *material)
{
    if (!material_emits(material) || (material->flags & MATERIAL_UNLIT))
        return 0.0;
    float mean[3];
    memcpy(mean, material->emission, sizeof mean);
    for (uint32_t i = 0; i < material->texture_count; i++) {
        const struct texture *texture = &scene->textures[material->first_texture + i];
        if ((texture->flags >> TEXTURE_USE_SHIFT & 3u) != TEXTURE_USE_SCALE ||
            (texture->flags >> TEXTURE_GROUP_SHIFT & 15u) != GROUP_EMISSION)
            continue;
        for (uint32_t c = 0; c < 3; c++) {
            uint32_t channel = texture->flags >> (TEXTURE_CHANNELS_SHIFT + 2 * c) & 3u;
            if (texture->flags >> (TEXTURE_MASK_SHIFT + c) & 1u)
                mean[c] *= scene->images[texture->image].mean[channel];
        }
    }
    return luminance(mean);
}

struct emitter_counts emitters_count(const struct scene *scene, const struct flat_scene *flat)
{
    struct emitter_counts counts = {.lights = scene->light_count};
    for (uint32_t i = 0; i < flat->triangle_count; i++)
        counts.triangles +=
            mean_radiance(scene, &scene->materials[flat->triangles[i].material]) > 0.0;
    for (uint32_t i = 0; i < flat->shape_count; i++) {
        if (!(mean_radiance(scene, &scene->materials[flat->shapes[i].material]) > 0.0))
            continue;
        if (flat->shapes[i].kind == SHAPE_SPHERE)
            counts.spheres++;
        else
            counts.discs++;
    }
    return counts;
}

static double triangle_area(const struct flat_triangle *triangle)
{
    double e[2][3], square = 0.0;
    for (int c = 0; c < 3; c++) {
        e[0][c] = (double)triangle->v[1][c] - (double)triangle->v[0][c];
        e[1][c] = (double)triangle->v[2][c] - (double)triangle->v[0][c];
    }
    for (int c = 0; c < 3; c++) {
        double n = e[0][(c + 1) % 3] * e[1][(c + 2) % 3] - e[0][(c + 2) % 3] * e[1][(c + 1) % 3];
        square += n * n;
    }
    return 0.5 * sqrt(square);
}

static double shape_area(const struct flat_shape *shape)
{
    double disc = M_PI * (double)shape->radius * (double)shape->radius;
    return shape->kind == SHAPE_SPHERE ? 4.0 * disc : disc;
}

// Half the diagonal of the scene's bounds.
static double bounding_radius(const struct flat_scene *flat)
{
    double square = 0.0;
    for (int c = 0; c < 3; c++) {
        double extent = (double)flat->bounds_max[c] - (double)flat->bounds_min[c];
        square += extent > 0.0 ? extent * extent : 0.0;
    }
    return 0.5 * sqrt(square);
}

// KHR_lights_punctual, "Inner and Outer Cone Angles": the falloff's cosines are this far apart at
// least.
#define SPOT_WIDTH_MIN 1e-3

// 1 - cos, without cancellation.
static double versine(double angle)
{
    double sine = sin(0.5 * angle);
    return 2.0 * sine * sine;
}

// The cosines between which a spot's light falls off.
static double spot_width(const struct light *light)
{
    double width = versine((double)light->outer_angle) - versine((double)light->inner_angle);
    return width > SPOT_WIDTH_MIN ? width : SPOT_WIDTH_MIN;
}

// The solid angle that a spot fills, weighted by its falloff ((cos - cos_outer) / width)^2: over
// the cosines from the outer one to `width` above it a third of the width, and all of what is
// beyond.
static double spot_solid_angle(const struct light *light)
{
    double width = spot_width(light), cone = versine((double)light->outer_angle);
    double sloped = cone < width ? cone : width;
    return 2.0 * M_PI * (sloped * sloped * sloped / (3.0 * width * width) + cone - sloped);
}

// What a light without extent sends into the scene. In the units of emitters with an area: those
// send pi * luminance * area to each of their two sides, which counts as luminance * area.
static double light_power(const struct light *light, const struct flat_scene *flat)
{
    double radius = bounding_radius(flat), brightness = luminance(light->radiant) / (2.0 * M_PI);
    switch (light->kind) {
    case LIGHT_DIRECTIONAL:
        return brightness * M_PI * radius * radius;
    case LIGHT_SPOT:
        return brightness * spot_solid_angle(light);
    default:
        return brightness * 4.0 * M_PI;
    }
}

struct emitter_list {
    uint32_t *primitives;
    double *powers; // luminance times area: what a diffuse emitter sends, but for a constant
    uint32_t count;
    double total;
};

static void add_emitter(struct emitter_list *list, uint32_t primitive, double power)
{
    list->primitives[list->count] = primitive;
    list->powers[list->count++] = power;
    list->total += power;
}

// Every primitive with emission, those of zero area too: they get no weight.
static bool list_emitters(const struct scene *scene, const struct flat_scene *flat,
                          const struct bvh *bvh, struct arena *arena, struct emitter_list *list,
                          struct err *err)
{
    struct emitter_counts counts = emitters_count(scene, flat);
    uint64_t count = (uint64_t)counts.triangles + counts.spheres + counts.discs + counts.lights;
    *list = (struct emitter_list){.primitives = ARENA_NEW(arena, uint32_t, count),
                                  .powers = ARENA_NEW(arena, double, count)};
    if (!list->primitives || !list->powers)
        return err_memory(err, "emitters", count * 12);
    for (uint32_t i = 0; i < flat->triangle_count && counts.triangles; i++) {
        const struct flat_triangle *triangle = &flat->triangles[bvh->triangle_order[i]];
        double radiance = mean_radiance(scene, &scene->materials[triangle->material]);
        if (radiance > 0.0)
            add_emitter(list, i, radiance * triangle_area(triangle));
    }
    for (uint32_t i = 0; i < flat->shape_count; i++) {
        const struct flat_shape *shape = &flat->shapes[i];
        double radiance = mean_radiance(scene, &scene->materials[shape->material]);
        if (radiance > 0.0)
            add_emitter(list, PRIMITIVE_SHAPE | i, radiance * shape_area(shape));
    }
    for (uint32_t i = 0; i < scene->light_count; i++)
        add_emitter(list, PRIMITIVE_LIGHT | i, light_power(&scene->lights[i], flat));
    return true;
}

// The record of a light, but for the probability to pick it.
static struct gpu_light light_record(const struct light *light, const struct flat_scene *flat)
{
    struct gpu_light record = {
        .kind = light->kind,
        .inverse_range = (float)(1.0 / (double)light->range),
        // Twice the longest way that there is inside of the bounds: beyond all surfaces from
        // whichever of them.
        .reach = (float)(4.0 * bounding_radius(flat)),
    };
    for (int c = 0; c < 3; c++) {
        record.position[c] = (float)(light->position[c] - flat->origin[c]);
        record.direction[c] = (float)light->direction[c];
        record.radiant[c] = light->radiant[c];
    }
    if (light->kind == LIGHT_SPOT) {
        double width = spot_width(light);
        record.spot_scale = (float)(1.0 / width);
        record.spot_offset = (float)(versine((double)light->outer_angle) / width);
    }
    return record;
}

// Adds up the parts of the bins that lead to each light.
static void set_pick_probabilities(struct emitters *emitters, uint32_t light_count, double *sums)
{
    for (uint32_t i = 0; i < emitters->count; i++) {
        const struct gpu_emitter *bin = &emitters->bins[i];
        double own = (double)bin->threshold;
        if (bin->primitive & PRIMITIVE_LIGHT)
            sums[bin->primitive & ~PRIMITIVE_LIGHT] += own;
        if (bin->alias_primitive & PRIMITIVE_LIGHT)
            sums[bin->alias_primitive & ~PRIMITIVE_LIGHT] += 1.0 - own;
    }
    for (uint32_t i = 0; i < light_count; i++)
        emitters->lights[i].pick_probability = (float)(sums[i] / emitters->count);
}

static bool fill_lights(const struct scene *scene, const struct flat_scene *flat,
                        struct arena *arena, struct emitters *out, struct err *err)
{
    uint32_t count = scene->light_count;
    if (count == 0)
        return true;
    double *sums = ARENA_NEW(arena, double, count);
    out->lights = ARENA_NEW(arena, struct gpu_light, count);
    if (!sums || !out->lights)
        return err_memory(err, "lights", count * (sizeof *out->lights + sizeof *sums));
    for (uint32_t i = 0; i < count; i++)
        out->lights[i] = light_record(&scene->lights[i], flat);
    set_pick_probabilities(out, count, sums);
    if (!scene->settings.nee)
        log_warn("without next-event estimation no light without extent is found: %u left dark: "
                 "expected --nee on",
                 count);
    return true;
}

static bool fill_bins(const struct scene *scene, const struct flat_scene *flat,
                      const struct bvh *bvh, struct arena *arena, struct emitters *out,
                      struct err *err)
{
    struct emitter_list list;
    if (!list_emitters(scene, flat, bvh, arena, &list, err))
        return false;
    if (list.count == 0 || !(list.total > 0.0))
        return true;
    struct alias_bin *bins = ARENA_NEW(arena, struct alias_bin, list.count);
    out->bins = ARENA_NEW(arena, struct gpu_emitter, list.count);
    if (!bins || !out->bins || !alias_table_build(list.powers, list.count, arena, bins))
        return err_memory(err, "emitters", (uint64_t)list.count * sizeof *out->bins);
    for (uint32_t i = 0; i < list.count; i++)
        out->bins[i] = (struct gpu_emitter){.threshold = bins[i].threshold,
                                            .primitive = list.primitives[i],
                                            .alias_primitive = list.primitives[bins[i].alias]};
    out->count = list.count;
    out->total_power = list.total;
    return true;
}

bool emitters_build(const struct scene *scene, const struct flat_scene *flat, const struct bvh *bvh,
                    struct arena *arena, struct emitters *out, struct err *err)
{
    *out = (struct emitters){0};
    return fill_bins(scene, flat, bvh, arena, out, err) &&
           fill_lights(scene, flat, arena, out, err);
}

float emitters_pick_density(const struct emitters *emitters, const struct scene *scene,
                            const struct material *material)
{
    if (!(emitters->total_power > 0.0))
        return 0.0f;
    return (float)(mean_radiance(scene, material) / emitters->total_power);
}
