// World space, single precision, one level: what the BVH and the kernels take.
#include "flatten.h"

#include "affine.h"
#include "bounds.h"
#include "flatten_attributes.h"
#include "flatten_shapes.h"
#include "log.h"
#include <float.h>
#include <math.h>
#include <string.h>

// --- bounds and origin ---------------------------------------------------------------------------

static bool fail_vertex(const struct scene *scene, const struct instance *instance, uint32_t vertex,
                        const double point[3], struct err *err)
{
    const char *name = scene->meshes[instance->mesh].name;
    return err_set(err, ERR_INPUT,
                   "%s: instance %td: mesh %u%s%s%s: vertex %u lies at (%g, %g, %g) in the world; "
                   "expected coordinates within +-%g",
                   scene->path ? scene->path : "scene", instance - scene->instances, instance->mesh,
                   *name ? " \"" : "", name, *name ? "\"" : "", vertex, point[0], point[1],
                   point[2], SCENE_COORDINATE_MAX);
}

// Coordinates of a file in single precision that are far from its own origin have lost their digits
// before anything here can save them: beyond this ratio of position to size a mesh is resolved in
// fewer than 2^24 / 2^18 = 64 steps (stiff case C2).
#define COARSE_RATIO 262144

static void warn_if_coarse(const struct mesh *mesh)
{
    struct bounds bounds = BOUNDS_EMPTY;
    double extent = 0, farthest = 0;
    if (mesh->exact_positions || mesh->triangle_count == 0)
        return;
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        for (int corner = 0; corner < 3; corner++) {
            double point[3];
            mesh_vertex(mesh, mesh->indices[t][corner], point);
            bounds_add_point(&bounds, point);
        }
    }
    for (int i = 0; i < 3; i++) {
        extent = fmax(extent, bounds.max[i] - bounds.min[i]);
        farthest = fmax(farthest, fmax(-bounds.min[i], bounds.max[i]));
    }
    if (farthest > COARSE_RATIO * extent)
        log_warn("mesh \"%s\" is %g in size and %g from its origin: single precision resolves it "
                 "in steps of %.2g",
                 mesh->name, extent, farthest, farthest * (double)FLT_EPSILON);
}

// Adds an instance to the bounds; false with *err set when a vertex is out of range.
static bool measure_instance(const struct scene *scene, const struct instance *instance,
                             struct bounds *bounds, struct err *err)
{
    const struct mesh *mesh = &scene->meshes[instance->mesh];
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        for (int corner = 0; corner < 3; corner++) {
            uint32_t vertex = mesh->indices[t][corner];
            double point[3];
            mesh_vertex(mesh, vertex, point);
            affine_point(instance->transform, point, point);
            if (!flatten_in_range(point))
                return fail_vertex(scene, instance, vertex, point, err);
            bounds_add_point(bounds, point);
        }
    }
    return true;
}

static bool is_singular(const struct instance *instance)
{
    double determinant = affine_determinant(instance->transform);
    return determinant == 0 || isnan(determinant);
}

struct census {
    struct bounds bounds;
    uint64_t triangle_count;
    struct attribute_needs needs;
    uint32_t skipped_instances;
};

static bool take_census(const struct scene *scene, struct census *census, struct err *err)
{
    *census = (struct census){.bounds = BOUNDS_EMPTY};
    for (uint32_t i = 0; i < scene->mesh_count; i++)
        warn_if_coarse(&scene->meshes[i]);
    for (uint32_t i = 0; i < scene->instance_count; i++) {
        const struct instance *instance = &scene->instances[i];
        const struct mesh *mesh = &scene->meshes[instance->mesh];
        if (is_singular(instance)) {
            log_warn("instance %u of mesh \"%s\" is skipped: its transform is singular", i,
                     mesh->name);
            census->skipped_instances++;
            continue;
        }
        census->triangle_count += mesh->triangle_count;
        attributes_census(scene, instance, &census->needs);
        if (!measure_instance(scene, instance, &census->bounds, err))
            return false;
    }
    for (uint32_t i = 0; i < scene->shape_count; i++)
        bounds_add_shape(&census->bounds, &scene->shapes[i]);
    return true;
}

// Coordinates up to 16 times the size cost four of the 24 bits; beyond that the arrays get an
// origin of their own, the middle of the scene.
#define REBASE_RATIO 16

static void choose_origin(const struct bounds *bounds, double origin[3])
{
    double extent = 0, farthest = 0;
    for (int i = 0; i < 3; i++)
        origin[i] = 0;
    if (bounds_is_empty(bounds))
        return;
    for (int i = 0; i < 3; i++) {
        extent = fmax(extent, bounds->max[i] - bounds->min[i]);
        farthest = fmax(farthest, fmax(-bounds->min[i], bounds->max[i]));
    }
    if (farthest > REBASE_RATIO * extent)
        for (int i = 0; i < 3; i++)
            origin[i] = bounds->min[i] + (bounds->max[i] - bounds->min[i]) / 2;
}

// --- triangles -----------------------------------------------------------------------------------

static struct placement place(const struct scene *scene, uint32_t index, const double origin[3])
{
    const struct instance *instance = &scene->instances[index];
    struct placement placement = {
        .mesh = &scene->meshes[instance->mesh],
        .instance = instance,
        .origin = {origin[0], origin[1], origin[2]},
        .is_mirrored = affine_determinant(instance->transform) < 0,
    };
    // Cofactors are the inverse transpose times the determinant, whose sign is taken back here.
    affine_cofactors(instance->transform, placement.normals);
    for (int i = 0; i < 9 && placement.is_mirrored; i++)
        placement.normals[i / 3][i % 3] *= -1;
    return placement;
}

static void place_vertex(const struct placement *placement, uint32_t vertex, float out[3])
{
    double point[3];
    mesh_vertex(placement->mesh, vertex, point);
    affine_point(placement->instance->transform, point, point);
    for (int i = 0; i < 3; i++)
        out[i] = (float)(point[i] - placement->origin[i]);
}

// The normal of a triangle from its rounded corners, not normalised. Exactly zero for a triangle
// without area: differences of floats, and products of two such, are exact in double precision
// unless their exponents are far apart.
static void triangle_normal(const struct flat_triangle *triangle, double out[3])
{
    double edges[2][3];
    for (int e = 0; e < 2; e++)
        for (int i = 0; i < 3; i++)
            edges[e][i] = (double)triangle->v[e + 1][i] - (double)triangle->v[0][i];
    vec3_cross(edges[0], edges[1], out);
}

// False for one without area: it is dropped.
static bool add_triangle(struct flat_scene *flat, const struct scene *scene,
                         const struct placement *placement, uint32_t index)
{
    const struct mesh *mesh = placement->mesh;
    const uint32_t *corners = mesh->indices[index];
    // A reflection turns the winding round; exchanging two corners keeps the outside outside.
    const uint32_t vertices[3] = {
        corners[0],
        corners[placement->is_mirrored ? 2 : 1],
        corners[placement->is_mirrored ? 1 : 2],
    };
    struct flat_triangle *triangle = &flat->triangles[flat->triangle_count];
    for (int corner = 0; corner < 3; corner++)
        place_vertex(placement, vertices[corner], triangle->v[corner]);
    double geometric[3];
    triangle_normal(triangle, geometric);
    if (!vec3_normalize(geometric))
        return false;
    triangle->material = instance_material(mesh, placement->instance, index);
    for (int corner = 0; corner < 3; corner++)
        flatten_bound(flat, triangle->v[corner], triangle->v[corner]);
    attributes_place(flat, scene, placement, vertices, geometric);
    flat->triangle_count++;
    return true;
}

// The list of dropped triangles doubles when it is full, which is when their number is a power
// of 2.
static bool drop_triangle(struct flat_scene *flat, struct arena *arena)
{
    uint32_t count = flat->dropped_degenerate;
    if ((count & (count - 1)) == 0) {
        uint32_t *list = ARENA_NEW(arena, uint32_t, count ? 2 * (size_t)count : 1);
        if (!list)
            return false;
        if (count)
            memcpy(list, flat->dropped_before, count * sizeof *list);
        flat->dropped_before = list;
    }
    flat->dropped_before[flat->dropped_degenerate++] = flat->triangle_count;
    return true;
}

static bool add_instance(struct flat_scene *flat, const struct scene *scene, uint32_t index,
                         struct arena *arena, struct err *err)
{
    flat->instance_first[index] = flat->triangle_count + flat->dropped_degenerate;
    if (is_singular(&scene->instances[index]))
        return true;
    const struct placement placement = place(scene, index, flat->origin);
    for (uint32_t t = 0; t < placement.mesh->triangle_count; t++)
        if (!add_triangle(flat, scene, &placement, t) && !drop_triangle(flat, arena))
            return err_memory(err, "dropped triangles", flat->dropped_degenerate * 4u);
    return true;
}

// The first of `count` ascending values that is above `value`, or `count`.
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

void flat_triangle_source(const struct flat_scene *flat, uint32_t id, uint32_t *instance,
                          uint32_t *triangle)
{
    uint32_t dropped = first_above(flat->dropped_before, flat->dropped_degenerate, id);
    uint32_t source = id + dropped;
    *instance = first_above(flat->instance_first, flat->instance_count, source) - 1;
    *triangle = source - flat->instance_first[*instance];
}

// --- the whole -----------------------------------------------------------------------------------

static bool reserve(const struct scene *scene, const struct census *census, struct arena *arena,
                    struct flat_scene *flat, struct err *err)
{
    if (census->triangle_count >= UINT32_MAX)
        return err_set(err, ERR_INPUT, "%s: %llu triangles in all; expected fewer than 4294967295",
                       scene->path ? scene->path : "scene",
                       (unsigned long long)census->triangle_count);
    size_t count = (size_t)census->triangle_count;
    flat->triangles = ARENA_NEW(arena, struct flat_triangle, count);
    flat->shapes = ARENA_NEW(arena, struct flat_shape, scene->shape_count);
    flat->material_used = ARENA_NEW(arena, bool, scene->material_count);
    flat->instance_first = ARENA_NEW(arena, uint32_t, scene->instance_count);
    flat->instance_count = scene->instance_count;
    if (!flat->instance_first || !flat->triangles || !flat->shapes || !flat->material_used)
        return err_memory(err, "the flattened scene", count * sizeof *flat->triangles);
    return attributes_reserve(&census->needs, count, arena, flat, err);
}

bool scene_flatten(const struct scene *scene, enum instancing instancing, struct arena *arena,
                   struct flat_scene *out, struct err *err)

{
    (void)instancing;
    struct census census;
    *out = (struct flat_scene){
        .bounds_min = {INFINITY, INFINITY, INFINITY},
        .bounds_max = {-INFINITY, -INFINITY, -INFINITY},
    };
    if (!take_census(scene, &census, err) || !reserve(scene, &census, arena, out, err))
        return false;
    out->skipped_instances = census.skipped_instances;
    choose_origin(&census.bounds, out->origin);
    for (uint32_t i = 0; i < scene->instance_count; i++)
        if (!add_instance(out, scene, i, arena, err))
            return false;
    out->world_triangle_count = out->triangle_count;
    if (!flatten_shapes(scene, out, err))
        return false;
    for (uint32_t i = 0; i < out->triangle_count; i++)
        out->material_used[out->triangles[i].material] = true;
    for (uint32_t i = 0; i < out->shape_count; i++)
        out->material_used[out->shapes[i].material] = true;
    return true;
}
