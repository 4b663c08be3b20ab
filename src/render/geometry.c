#include "geometry.h"

#include "flatten_shapes.h"
#include "log.h"
#include <math.h>

static bool build_bvh(const struct geometry_params *p, const struct flat_scene *flat,
                      struct arena *arena, struct bvh *bvh, struct err *err)
{
    struct arena scratch = {0};
    struct bvh_box *boxes = ARENA_NEW(&scratch, struct bvh_box, flat->shape_count);
    if (!boxes)
        return err_memory(err, "shapes", flat->shape_count * sizeof *boxes);
    for (uint32_t i = 0; i < flat->shape_count; i++)
        flat_shape_box(&flat->shapes[i], boxes[i].min, boxes[i].max);
    const void *vertices = flat->triangles;
    const struct bvh_params params = {
        .triangle_vertices = vertices,
        .triangle_stride = sizeof *flat->triangles,
        .triangle_count = flat->world_triangle_count,
        .shape_boxes = boxes,
        .shape_count = flat->shape_count,
        .method = p->bvh,
        .progress = p->progress,
    };
    bool ok = bvh_build(&params, arena, bvh, err);
    arena_finish(&scratch);
    return ok;
}

// Cross products of edges overflow or underflow single precision beyond these, with room for edges
// that are smaller than the scene.
#define LARGEST_EXTENT 1e9f
#define SMALLEST_EXTENT 1e-9f

static void warn_about_extent(const struct flat_scene *flat)
{
    float extent = 0.0f;
    for (int c = 0; c < 3; c++)
        extent = fmaxf(extent, flat->bounds_max[c] - flat->bounds_min[c]);
    if (extent > LARGEST_EXTENT || (extent > 0.0f && extent < SMALLEST_EXTENT))
        log_warn("the scene is %g m across; surfaces are lost to single precision beyond %g m and "
                 "below %g m: expected a scene scaled into that range",
                 (double)extent, (double)LARGEST_EXTENT, (double)SMALLEST_EXTENT);
}

bool geometry_prepare(const struct geometry_params *p, struct arena *arena, struct flat_scene *flat,
                      struct bvh *bvh, struct err *err)
{
    if (!scene_flatten(p->scene, p->instancing, arena, flat, err))
        return false;
    warn_about_extent(flat);
    return build_bvh(p, flat, arena, bvh, err);
}
