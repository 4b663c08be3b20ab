#include "emitters.h"

#include "alias_table.h"
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
    return true;
}

bool emitters_build(const struct scene *scene, const struct flat_scene *flat, const struct bvh *bvh,
                    struct arena *arena, struct emitters *out, struct err *err)
{
    struct emitter_list list;
    *out = (struct emitters){0};
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

float emitters_pick_density(const struct emitters *emitters, const struct scene *scene,
                            const struct material *material)
{
    if (!(emitters->total_power > 0.0))
        return 0.0f;
    return (float)(mean_radiance(scene, material) / emitters->total_power);
}
