// Flattens a scene: converts its triangles to single precision, in world space or in the space of a
// shared mesh, for the BVH and the kernels.
#include "base/log.h"
#include "flatten/flatten_census.h"
#include "flatten/flatten_instances.h"
#include "flatten/flatten_lamps.h"
#include "flatten/flatten_precision.h"
#include "flatten/flatten_shapes.h"
#include "scene/core/affine.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

// --- triangles -----------------------------------------------------------------------------------

// Emissive triangles that are dropped because they have no area. One warning reports all of them.
struct lost_emitters {
    uint32_t count;
    const struct mesh *mesh; // mesh of the first dropped triangle
    double corner[3];        // its first corner in world space, in metres
    double longest;          // longest edge of all dropped triangles, in metres
};

struct flattening {
    const struct flatten_params *params;
    struct flat_scene *flat;
    struct arena *arena;
    uint64_t triangle_count; // all triangles, including dropped ones
    struct lost_emitters lost;
    struct lamps lamps;
    uint32_t next_lamp; // index in lamps.triangles
};

// Computes the normal of a triangle from its rounded corners, not normalised. It is exactly zero
// for a triangle without area, because differences of floats, and products of two such differences,
// are exact in double precision unless their exponents are far apart.
static void triangle_normal(const struct flat_triangle *triangle, double out[3])
{
    double edges[2][3];
    for (int e = 0; e < 2; e++)
        for (int i = 0; i < 3; i++)
            edges[e][i] = (double)triangle->v[e + 1][i] - (double)triangle->v[0][i];
    vec3_cross(edges[0], edges[1], out);
}

// Returns the index in lamps.items of the lamp that has an instance's triangle; SCENE_NONE if none
// has. Must be called in ascending order of instances and triangles.
static uint32_t take_lamp(struct flattening *f, const struct instance *instance, uint32_t triangle)
{
    const struct lamps *lamps = &f->lamps;
    if (f->next_lamp == lamps->triangle_count)
        return SCENE_NONE;
    const struct lamp_triangle *next = &lamps->triangles[f->next_lamp];
    if (instance != &f->params->scene->instances[next->instance] || triangle != next->triangle)
        return SCENE_NONE;
    f->next_lamp++;
    return next->lamp;
}

// Adds a triangle. Returns false for a triangle without area, which is not added.
static bool add_triangle(struct flattening *f, const struct placement *placement, uint32_t index)
{
    const struct scene *scene = f->params->scene;
    struct flat_scene *flat = f->flat;
    const struct mesh *mesh = placement->mesh;
    const uint32_t *corners = mesh->indices[index];
    // A reflection reverses the orientation of a triangle; exchanging two corners restores it, so
    // that the front side stays the front side.
    const uint32_t vertices[3] = {
        corners[0],
        corners[placement->is_mirrored ? 2 : 1],
        corners[placement->is_mirrored ? 1 : 2],
    };
    struct flat_triangle *triangle = &flat->triangles[flat->triangle_count];
    double points[3][3], geometric[3];
    for (int corner = 0; corner < 3; corner++) {
        placement_vertex(placement, vertices[corner], points[corner]);
        for (int i = 0; i < 3; i++)
            triangle->v[corner][i] = (float)points[corner][i];
    }
    triangle->material = instance_material(mesh, placement->instance, index);
    triangle_normal(triangle, geometric);
    uint32_t lamp = take_lamp(f, placement->instance, index);
    if (lamp != SCENE_NONE)
        lamp_add_triangle(&f->lamps, lamp, (const double(*)[3])points, geometric, flat);
    if (!vec3_normalize(geometric))
        return false;
    attributes_place(flat, scene, placement, vertices, geometric);
    flat->triangle_count++;
    return true;
}

// Records a dropped triangle. The list is doubled when it is full, that is, when its length is a
// power of 2.
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

// Records a dropped triangle if its material emits light.
static void note_lost(struct flattening *f, const struct placement *placement, uint32_t triangle)
{
    struct lost_emitters *lost = &f->lost;
    double corners[3][3], edge[3];
    if (!flatten_emits(f->params->scene,
                       instance_material(placement->mesh, placement->instance, triangle)))
        return;
    placement_corners(placement, triangle, corners);
    if (lost->count++ == 0) {
        lost->mesh = placement->mesh;
        for (int i = 0; i < 3; i++)
            lost->corner[i] = corners[0][i] / placement->scale + placement->origin[i];
    }
    for (int corner = 0; corner < 3; corner++) {
        vec3_subtract(corners[corner], corners[(corner + 1) % 3], edge);
        lost->longest = fmax(lost->longest, vec3_length(edge) / placement->scale);
    }
}

static void warn_of_lost(const struct lost_emitters *lost)
{
    if (lost->count > 0)
        log_warn(
            "%u emissive triangles are omitted and emit no light, because they have no area in "
            "single precision: their longest edge is %g m, the first one lies at (%g, %g, %g) "
            "in mesh \"%s\"; expected larger triangles",
            lost->count, lost->longest, lost->corner[0], lost->corner[1], lost->corner[2],
            lost->mesh->name);
}

// Adds all triangles of an instance; a shared mesh is added in its own space, as if it were an
// instance. `run` is the index in flat->instance_first at which the first triangle is recorded.
static bool add_triangles(struct flattening *f, const struct placement *placement, uint32_t run,
                          struct err *err)
{
    struct flat_scene *flat = f->flat;
    uint32_t first = flat->triangle_count + flat->dropped_degenerate;
    flat->instance_first[run] = first;
    for (uint32_t t = 0; t < placement->mesh->triangle_count; t++) {
        double done = (double)(first + t) / (double)f->triangle_count;
        if ((first + t) % FLATTEN_POLL == 0 &&
            !flatten_goes_on(f->params, FLATTEN_CENSUS_PART + done * (1 - FLATTEN_CENSUS_PART),
                             err))
            return false;
        bool added = add_triangle(f, placement, t);
        if (!added)
            note_lost(f, placement, t);
        if (!added && !drop_triangle(flat, f->arena))
            return err_memory(err, "dropped triangles", flat->dropped_degenerate * 4u);
    }
    return true;
}

// Returns whether all triangles from `first` on are small triangles of lamps, whose light is
// correct at any distance from the origin.
static bool are_small(const struct flat_scene *flat, uint32_t first)
{
    for (uint32_t i = first; i < flat->triangle_count; i++)
        if (!flat_find_small(flat, i))
            return false;
    return true;
}

static bool add_world(struct flattening *f, const struct census *census,
                      struct coarse_objects *coarse, struct err *err)
{
    const struct scene *scene = f->params->scene;
    struct flat_scene *flat = f->flat;
    for (uint32_t i = 0; i < scene->instance_count; i++) {
        flat->instance_first[i] = flat->triangle_count + flat->dropped_degenerate;
        if (census->instances[i] != INSTANCE_FLATTENED)
            continue;
        const struct instance *instance = &scene->instances[i];
        const struct placement placement =
            placement_create(scene, instance, flat->origin, flat->scale);
        uint32_t first = flat->triangle_count;
        if (!add_triangles(f, &placement, i, err))
            return false;
        if (first == flat->triangle_count || !are_small(flat, first))
            coarse_add_instance(flat, scene, i, &census->meshes[instance->mesh].bounds, coarse);
    }
    warn_of_lost(&f->lost);
    flat->world_triangle_count = flat->triangle_count;
    for (uint32_t i = 0; i < flat->triangle_count; i++)
        for (int corner = 0; corner < 3; corner++)
            flatten_bound(flat, flat->triangles[i].v[corner], flat->triangles[i].v[corner]);
    return true;
}

static void bound_mesh(const struct flat_scene *flat, struct flat_mesh *mesh)
{
    for (int c = 0; c < 3; c++) {
        mesh->bounds_min[c] = INFINITY;
        mesh->bounds_max[c] = -INFINITY;
    }
    for (uint32_t i = 0; i < 3 * mesh->triangle_count; i++) {
        const float *v = flat->triangles[mesh->first_triangle + i / 3].v[i % 3];
        for (int c = 0; c < 3; c++) {
            mesh->bounds_min[c] = fminf(mesh->bounds_min[c], v[c]);
            mesh->bounds_max[c] = fmaxf(mesh->bounds_max[c], v[c]);
        }
    }
}

static bool add_meshes(struct flattening *f, const struct census *census, struct err *err)
{
    const struct scene *scene = f->params->scene;
    struct flat_scene *flat = f->flat;
    for (uint32_t i = 0; i < scene->mesh_count; i++) {
        const struct mesh_use *use = &census->meshes[i];
        struct instance own = {.mesh = i, .material = SCENE_NONE};
        double origin[3];
        if (!use->is_shared)
            continue;
        struct flat_mesh *mesh = &flat->meshes[use->flat];
        memcpy(own.transform, AFFINE_IDENTITY, sizeof own.transform);
        flatten_choose_origin(&use->bounds, origin);
        mesh->first_triangle = flat->triangle_count;
        const struct placement placement =
            placement_create(scene, &own, origin, flatten_choose_scale(&use->bounds));
        if (!add_triangles(f, &placement, flat->instance_count + use->flat, err))
            return false;
        mesh->triangle_count = flat->triangle_count - mesh->first_triangle;
        bound_mesh(flat, mesh);
    }
    return true;
}

// --- the whole scene -----------------------------------------------------------------------------

static bool reserve(const struct scene *scene, const struct census *census, struct arena *arena,
                    struct flat_scene *flat, struct err *err)
{
    uint64_t triangles = census->world_triangle_count + census->shared_triangle_count;
    if (triangles >= UINT32_MAX)
        return err_set(err, ERR_INPUT, "%s: %llu triangles in all; expected fewer than 4294967295",
                       scene->path ? scene->path : "scene", (unsigned long long)triangles);
    size_t count = (size_t)triangles;
    flat->triangles = ARENA_NEW(arena, struct flat_triangle, count);
    flat->shapes = ARENA_NEW(arena, struct flat_shape, scene->shape_count);
    flat->material_used = ARENA_NEW(arena, bool, scene->material_count);
    flat->instance_first =
        ARENA_NEW(arena, uint32_t, (size_t)scene->instance_count + census->shared_count);
    flat->instance_count = scene->instance_count;
    flat->meshes = ARENA_NEW(arena, struct flat_mesh, census->shared_count);
    flat->mesh_count = census->shared_count;
    flat->instances = ARENA_NEW(arena, struct flat_instance, census->placed_count);
    if (!flat->instance_first || !flat->triangles || !flat->shapes || !flat->material_used ||
        !flat->meshes || !flat->instances)
        return err_memory(err, "the flattened scene",
                          count * sizeof *flat->triangles +
                              census->placed_count * sizeof *flat->instances);
    return attributes_reserve(&census->needs, count, arena, flat, err);
}

static bool reserve_small(const struct lamps *lamps, struct arena *arena, struct flat_scene *flat,
                          struct err *err)
{
    flat->small = ARENA_NEW(arena, struct flat_small_triangle, lamps->triangle_count);
    return flat->small ||
           err_memory(err, "small lamps", lamps->triangle_count * sizeof *flat->small);
}

static void mark_materials(struct flat_scene *flat)
{
    for (uint32_t i = 0; i < flat->world_triangle_count; i++)
        flat->material_used[flat->triangles[i].material] = true;
    for (uint32_t i = 0; i < flat->shape_count; i++)
        flat->material_used[flat->shapes[i].material] = true;
    for (uint32_t i = 0; i < flat->placed_count; i++) {
        const struct flat_instance *instance = &flat->instances[i];
        struct flat_mesh *mesh = &flat->meshes[instance->mesh];
        if (instance->material != SCENE_NONE)
            flat->material_used[instance->material] = true;
        mesh->is_own_material_used |= instance->material == SCENE_NONE;
    }
    for (uint32_t m = 0; m < flat->mesh_count; m++) {
        const struct flat_mesh *mesh = &flat->meshes[m];
        for (uint32_t i = 0; i < mesh->triangle_count && mesh->is_own_material_used; i++)
            flat->material_used[flat->triangles[mesh->first_triangle + i].material] = true;
    }
}

static bool flatten(const struct flatten_params *params, struct arena *scratch, struct arena *arena,
                    struct flat_scene *out, struct err *err)
{
    const struct scene *scene = params->scene;
    struct flattening f = {params, out, arena, 0};
    struct coarse_objects coarse = {0};
    struct census census;
    if (!flatten_take_census(params, scratch, &census, err) ||
        !reserve(scene, &census, arena, out, err))
        return false;
    f.triangle_count = census.world_triangle_count + census.shared_triangle_count;
    out->skipped_instances = census.skipped_instances;
    flatten_choose_origin(&census.bounds, out->origin);
    flatten_follow_camera(params, &census, out);
    out->scale = flatten_choose_scale(&census.bounds);
    if (!flatten_find_lamps(params, &census, out, scratch, &f.lamps, err) ||
        !reserve_small(&f.lamps, arena, out, err) || !add_world(&f, &census, &coarse, err) ||
        !lamps_finish(&f.lamps, out, scratch, err) || !add_meshes(&f, &census, err) ||
        !flatten_instances(params, &census, out, &coarse, err) ||
        !flatten_shapes(params, out, &coarse, err) ||
        !flatten_check_extent(scene, &census.bounds, err))
        return false;
    coarse_warn(&coarse);
    mark_materials(out);
    return true;
}

bool scene_flatten(const struct flatten_params *params, struct arena *arena, struct flat_scene *out,
                   struct err *err)
{
    struct arena scratch = {0};
    *out = (struct flat_scene){
        .bounds_min = {INFINITY, INFINITY, INFINITY},
        .bounds_max = {-INFINITY, -INFINITY, -INFINITY},
    };
    bool ok = flatten(params, &scratch, arena, out, err);
    arena_finish(&scratch);
    return ok;
}
