#include "emitters.h"

#include "alias_table.h"
#include "emitter_power.h"
#include "log.h"
#include <math.h>
#include <string.h>

struct emitter_counts emitters_count(const struct scene *scene, const struct flat_scene *flat)
{
    struct emitter_counts counts = {.environment = scene->environment.present &&
                                                   scene->environment.width > 0};
    for (uint32_t i = 0; i < scene->light_count; i++) {
        bool is_sun = scene->lights[i].kind == LIGHT_DIRECTIONAL &&
                      scene->lights[i].angular_radius > 0.0;
        counts.suns += is_sun;
        counts.lights += !is_sun;
    }
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

uint64_t emitters_total(const struct emitter_counts *counts)
{
    return (uint64_t)counts->triangles + counts->spheres + counts->discs + counts->lights +
           counts->suns + counts->environment;
}

uint32_t emitters_choice(uint32_t setting, const struct emitter_counts *counts)
{
    (void)counts;
    return setting == LIGHT_CHOICE_AUTO ? LIGHT_CHOICE_POWER : setting;
}

// --- the list of emitters ------------------------------------------------------------------------

struct emitter_list {
    uint32_t *primitives;
    double *powers; // as in emitter_power.h
    uint32_t count, surface_count;
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
    uint64_t count = emitters_total(&counts);
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
    list->surface_count = list->count;
    for (uint32_t i = 0; i < scene->light_count; i++)
        add_emitter(list, PRIMITIVE_LIGHT | i, light_power(&scene->lights[i], flat));
    if (counts.environment)
        add_emitter(list, PRIMITIVE_ENVIRONMENT, environment_power(&scene->environment, flat));
    return true;
}

// --- lights without extent, and suns -------------------------------------------------------------

// The record of a light, but for the probability to pick it.
static struct gpu_light light_record(const struct light *light, const struct flat_scene *flat,
                                     float reach)
{
    struct gpu_light record = {
        .kind = light->kind,
        .inverse_range = (float)(1.0 / (double)light->range),
        .reach = reach,
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
    if (light->kind == LIGHT_DIRECTIONAL)
        record.versine = (float)versine(light->angular_radius);
    return record;
}

static bool fill_lights(const struct scene *scene, const struct flat_scene *flat,
                        struct arena *arena, struct emitters *out, struct err *err)
{
    uint32_t count = scene->light_count;
    if (count == 0)
        return true;
    out->lights = ARENA_NEW(arena, struct gpu_light, count);
    if (!out->lights)
        return err_memory(err, "lights", count * sizeof *out->lights);
    uint32_t dark = 0;
    for (uint32_t i = 0; i < count; i++) {
        out->lights[i] = light_record(&scene->lights[i], flat, out->reach);
        dark += !(out->lights[i].versine > 0.0f);
    }
    if (!scene->settings.nee && dark > 0)
        log_warn("without next-event estimation no light without extent is found: %u left dark: "
                 "expected --nee on",
                 dark);
    return true;
}

// Adds `pick` to the probability of an emitter whose probability is the same everywhere.
static void add_pick(struct emitters *out, uint32_t primitive, double pick)
{
    if (primitive == PRIMITIVE_ENVIRONMENT)
        out->environment_pick += (float)pick;
    else if (primitive & PRIMITIVE_LIGHT)
        out->lights[primitive & ~PRIMITIVE_LIGHT].pick_probability += (float)pick;
}

// --- ways to choose ------------------------------------------------------------------------------

// Fills bins[count] and the probabilities that they give to lights and the environment, times
// `share`.
static bool fill_bins(const uint32_t *primitives, const double *powers, uint32_t count,
                      double share, struct arena *arena, struct gpu_emitter *bins,
                      struct emitters *out, struct err *err)
{
    struct alias_bin *table = ARENA_NEW(arena, struct alias_bin, count);
    double *sums = ARENA_NEW(arena, double, count);
    if (!table || !sums || !alias_table_build(powers, count, arena, table))
        return err_memory(err, "emitters", (uint64_t)count * sizeof *bins);
    for (uint32_t i = 0; i < count; i++) {
        bins[i] = (struct gpu_emitter){.threshold = table[i].threshold,
                                       .primitive = primitives[i],
                                       .alias_primitive = primitives[table[i].alias]};
        sums[i] += (double)table[i].threshold;
        sums[table[i].alias] += 1.0 - (double)table[i].threshold;
    }
    for (uint32_t i = 0; i < count; i++)
        add_pick(out, primitives[i], share * (sums[i] / count));
    return true;
}

static bool build_power(const struct emitter_list *list, struct arena *arena, struct emitters *out,
                        struct err *err)
{
    if (!(list->total > 0.0))
        return true;
    struct gpu_emitter *bins = ARENA_NEW(arena, struct gpu_emitter, list->count);
    if (!bins)
        return err_memory(err, "emitters", (uint64_t)list->count * sizeof *bins);
    out->data = bins;
    out->bytes = (uint64_t)list->count * sizeof *bins;
    out->count = list->count;
    out->total_power = list->total;
    return fill_bins(list->primitives, list->powers, list->count, 1.0, arena, bins, out, err);
}

// Bins without aliases, each chosen with probability `pick`.
static bool build_list(const struct emitter_list *list, double pick, struct arena *arena,
                       struct emitters *out, struct err *err)
{
    struct gpu_emitter *bins = ARENA_NEW(arena, struct gpu_emitter, list->count);
    if (!bins)
        return err_memory(err, "emitters", (uint64_t)list->count * sizeof *bins);
    out->data = bins;
    out->bytes = (uint64_t)list->count * sizeof *bins;
    out->count = list->count;
    for (uint32_t i = 0; i < list->count; i++) {
        bins[i] = (struct gpu_emitter){.threshold = 1.0f,
                                       .primitive = list->primitives[i],
                                       .alias_primitive = list->primitives[i]};
        add_pick(out, list->primitives[i], pick);
    }
    return true;
}

bool emitters_build(const struct scene *scene, const struct flat_scene *flat, const struct bvh *bvh,
                    uint32_t choice, struct arena *arena, struct emitters *out, struct err *err)
{
    struct emitter_list list;
    // Twice the longest way that there is inside of the bounds: beyond all surfaces from whichever
    // of them.
    *out = (struct emitters){.reach = (float)(4.0 * bounding_radius(flat))};
    if (!fill_lights(scene, flat, arena, out, err) ||
        !list_emitters(scene, flat, bvh, arena, &list, err))
        return false;
    out->primitives = list.primitives;
    out->surface_count = list.surface_count;
    if (list.count == 0)
        return true;
    switch (choice) {
    case LIGHT_CHOICE_UNIFORM:
        return build_list(&list, 1.0 / list.count, arena, out, err);
    case LIGHT_CHOICE_ALL:
        return build_list(&list, 1.0, arena, out, err);
    default:
        return build_power(&list, arena, out, err);
    }
}

float emitters_pick_density(const struct emitters *emitters, const struct scene *scene,
                            const struct material *material)
{
    double radiance = mean_radiance(scene, material);
    if (emitters->total_power > 0.0)
        return (float)(radiance / emitters->total_power);
    return emitters->count > 0 && radiance > 0.0 ? 1.0f : 0.0f;
}
