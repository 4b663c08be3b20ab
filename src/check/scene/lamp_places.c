// Distributes points over lamps in proportion to their light.
#include "check/scene/survey.h"

#include "base/maths.h"
#include "flatten/flatten_census.h"
#include "render/probe/emitter_shape.h"
#include "render/tables/emitter_power.h"
#include "scene/core/emission.h"
#include "shared/types.h"

// Returns a surface of a lamp by number: all shapes come first, then all triangles in world space.
static struct emitter_part part_at(const struct survey *survey, uint32_t number)
{
    uint32_t shapes = survey->flat->shape_count;
    return number < shapes ? (struct emitter_part){EMITTER_SHAPE, number}
                           : (struct emitter_part){EMITTER_TRIANGLE, number - shapes};
}

// Returns the power of a surface, as in emitter_power.h, if it has the given material (or any, for
// SCENE_NONE). It is 0 for triangles that are stored separately because rounding would change their
// form.
static double power_of(const struct survey *survey, uint32_t material, struct emitter_part part)
{
    const struct flat_scene *flat = survey->flat;
    bool is_shape = part.kind == EMITTER_SHAPE;
    uint32_t own =
        is_shape ? flat->shapes[part.index].material : flat->triangles[part.index].material;
    if (!flatten_emits(survey->scene, own) || (material != SCENE_NONE && own != material) ||
        (!is_shape && flat_find_small(flat, part.index)))
        return 0.0;
    double radiance = mean_radiance(survey->scene, &survey->scene->materials[own]);
    return radiance *
           (is_shape ? shape_area(&flat->shapes[part.index]) : triangle_area(flat, part.index));
}

// Computes point `number` of `count` points that are distributed over a surface; on triangles as in
// emitter_shape.h.
static void place_on(const struct survey *survey, struct emitter_part part, uint32_t number,
                     uint32_t count, struct sighting *out)
{
    static const double up[3] = {0.0, 1.0, 0.0}, no_way[3];
    struct probe_hit hit = {.primitive = part.index, .instance = NO_INSTANCE};
    double place[3] = {0}, way[3];
    if (part.kind == EMITTER_TRIANGLE) {
        double root = sqrt((number + 0.5) / count), v = fmod(0.5 + number * 0.7548776662466927, 1);
        hit.u = (float)(root * (1.0 - v));
        hit.v = (float)(root * v);
    } else {
        hit.primitive |= PRIMITIVE_SHAPE;
        sighting_scatter(up, number, way);
        emitter_place(&survey->job.renderer, part, way, number, count, place);
        shape_put_on(survey, &survey->flat->shapes[part.index], place);
    }
    sighting_find(survey, &hit, place, no_way, out);
}

uint32_t lamp_places_take(const struct survey *survey, uint32_t material, uint32_t most,
                          struct sightline *lines)
{
    uint32_t surfaces = survey->flat->shape_count + survey->flat->world_triangle_count, count = 0;
    double all = 0.0, passed = 0.0;
    for (uint32_t i = 0; i < surfaces; i++)
        all += power_of(survey, material, part_at(survey, i));
    for (uint32_t i = 0; i < surfaces && all > 0.0; i++) {
        struct emitter_part part = part_at(survey, i);
        passed += power_of(survey, material, part);
        // Adds as many points as correspond to the share of the light so far.
        uint32_t first = count, end = (uint32_t)fmin(most * (passed / all) + 0.5, most);
        for (; count < end; count++) {
            lines[count] = (struct sightline){.count = 1};
            place_on(survey, part, count - first, end - first, &lines[count].steps[0]);
        }
    }
    return count;
}
