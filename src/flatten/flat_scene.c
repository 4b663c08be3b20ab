// Queries of a flattened scene.
#include "flatten/flatten.h"

#include <stdlib.h>

// Returns the index of the first of `count` ascending values that exceeds `value`; `count` if none
// does.
static uint32_t first_above(const uint32_t *values, uint32_t count, uint32_t value)
{
    uint32_t low = 0;
    while (low < count) {
        uint32_t middle = low + (count - low) / 2;
        if (values[middle] <= value)
            low = middle + 1;
        else
            count = middle;
    }
    return low;
}

// Finds the instance and the triangle in its mesh by a number among all triangles of the scene,
// including dropped ones.
static void find_source(const struct flat_scene *flat, uint32_t number, uint32_t *instance,
                        uint32_t *triangle)
{
    uint32_t runs = flat->instance_count + flat->mesh_count;
    uint32_t run = first_above(flat->instance_first, runs, number) - 1;
    *triangle = number - flat->instance_first[run];
    *instance = run < flat->instance_count ? run : SCENE_NONE;
}

void flat_triangle_source(const struct flat_scene *flat, uint32_t id, uint32_t *instance,
                          uint32_t *triangle)
{
    uint32_t dropped = first_above(flat->dropped_before, flat->dropped_degenerate, id);
    find_source(flat, id + dropped, instance, triangle);
}

void flat_dropped_source(const struct flat_scene *flat, uint32_t k, uint32_t *instance,
                         uint32_t *triangle)
{
    find_source(flat, flat->dropped_before[k] + k, instance, triangle);
}

// Returns the flat triangle that follows the first `source` triangles of the scene, of which some
// may have been dropped. The dropped triangle number i was at position dropped_before[i] + i.
static uint32_t first_from(const struct flat_scene *flat, uint32_t source)
{
    uint32_t dropped = 0, end = flat->dropped_degenerate;
    while (dropped < end) {
        uint32_t middle = dropped + (end - dropped) / 2;
        if (flat->dropped_before[middle] + middle < source)
            dropped = middle + 1;
        else
            end = middle;
    }
    return source - dropped;
}

void flat_instance_triangles(const struct flat_scene *flat, uint32_t instance, uint32_t *first,
                             uint32_t *count)
{
    uint32_t runs = flat->instance_count + flat->mesh_count;
    uint32_t all = flat->triangle_count + flat->dropped_degenerate;
    *first = first_from(flat, flat->instance_first[instance]);
    *count =
        first_from(flat, instance + 1 < runs ? flat->instance_first[instance + 1] : all) - *first;
}

void flat_from_world(const struct flat_scene *flat, const double point[3], double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = (point[i] - flat->origin[i]) * flat->scale;
}

void flat_to_world(const struct flat_scene *flat, const double point[3], double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = point[i] / flat->scale + flat->origin[i];
}

static int compare_small(const void *a, const void *b)
{
    uint32_t id = *(const uint32_t *)a,
             triangle = ((const struct flat_small_triangle *)b)->triangle;
    return (id > triangle) - (id < triangle);
}

const struct flat_small_triangle *flat_find_small(const struct flat_scene *flat, uint32_t id)
{
    if (flat->small_count == 0)
        return NULL;
    return bsearch(&id, flat->small, flat->small_count, sizeof *flat->small, compare_small);
}

void flat_triangle_edges(const struct flat_scene *flat, uint32_t id, double edges[2][3])
{
    const struct flat_small_triangle *small = flat_find_small(flat, id);
    const struct flat_triangle *triangle = &flat->triangles[id];
    for (int e = 0; e < 2; e++)
        for (int i = 0; i < 3; i++)
            edges[e][i] = small ? (double)small->edges[e][i]
                                : (double)triangle->v[e + 1][i] - (double)triangle->v[0][i];
}
