#include "flatten/geometry.h"

#include "base/clock.h"
#include "base/parallel.h"
#include "bvh/bvh_cache.h"
#include "flatten/flatten_shapes.h"
#include "scene/core/affine.h"
#include <math.h>
#include <string.h>

// --- trees ---------------------------------------------------------------------------------------

// Trees that are built together: the world's and those of the shared meshes.
struct build {
    const struct geometry_params *p;
    const struct flat_scene *flat;
    struct bvh *meshes;   // one for each shared mesh
    struct bvh_cut *cuts; // for each shared mesh, boxes that bound it (bvh_cut)
    struct arena *arenas; // one for each thread
    double done, part;    // fractions of all primitives: in finished trees, in the current tree
    struct bvh_cache cache;
    double spared_seconds; // build time of the trees that were loaded from the cache
};

struct bvh_cut {
    struct bvh_box boxes[BVH_CUT_MAX];
    uint32_t count;
};

// Reports a tree's progress as a part of the total.
static void report(void *context, const char *phase, double fraction)
{
    const struct build *build = context;
    progress_report(build->p->progress, phase, build->done + fraction * build->part);
}

static bool should_stop(void *context)
{
    const struct build *build = context;
    return progress_should_stop(build->p->progress);
}

// Makes the parameters for the triangles in [first, first + count) only.
static struct bvh_params triangle_params(const struct build *build, uint32_t first, uint32_t count)
{
    const void *vertices = &build->flat->triangles[first];
    return (struct bvh_params){
        .triangle_vertices = vertices,
        .triangle_stride = sizeof *build->flat->triangles,
        .triangle_count = count,
        .method = build->p->bvh,
    };
}

static bool build_tree(struct build *build, struct bvh_params *params, struct arena *arena,
                       struct bvh *out, struct err *err)
{
    const struct progress progress = {report, should_stop, build};
    const struct flat_scene *flat = build->flat;
    double all = (double)flat->triangle_count + flat->shape_count + flat->placed_count;
    double mine = (double)params->triangle_count + params->shape_count + params->instance_count;
    build->part = all > 0 ? mine / all : 1.0;
    params->progress = &progress;
    bool ok = bvh_build_cached(&build->cache, params, arena, out, err);
    if (ok && out->stats.cached_seconds > 0)
        build->spared_seconds += out->stats.cached_seconds - out->stats.build_seconds;
    params->progress = NULL;
    build->done += build->part;
    return ok;
}

// --- shared meshes -------------------------------------------------------------------------------

// Smaller meshes are built in parallel, one thread each; larger ones one after the other with all
// threads.
#define SMALL_MESH 16384
#define MESHES_AT_ONCE 256 // meshes between two polls for a stop

struct mesh_job {
    struct build *build;
    uint32_t first;
};

static void build_small(void *context, size_t begin, size_t end, unsigned thread)
{
    const struct mesh_job *job = context;
    struct build *build = job->build;
    for (size_t i = job->first + begin; i < job->first + end; i++) {
        const struct flat_mesh *mesh = &build->flat->meshes[i];
        struct bvh_params params =
            triangle_params(build, mesh->first_triangle, mesh->triangle_count);
        struct err err = {0};
        params.threads = 1;
        if (mesh->triangle_count > SMALL_MESH ||
            !bvh_build(&params, &build->arenas[thread], &build->meshes[i], &err))
            build->meshes[i].node_count = 0; // makes build_meshes() build it, or fail
    }
}

static bool build_meshes(struct build *build, struct arena *arena, struct err *err)
{
    const struct flat_scene *flat = build->flat;
    for (uint32_t first = 0; first < flat->mesh_count; first += MESHES_AT_ONCE) {
        struct mesh_job job = {build, first};
        uint32_t left = flat->mesh_count - first;
        if (should_stop(build))
            return err_set(err, ERR_STOPPED, "stopped while building the BVH");
        parallel_for(left < MESHES_AT_ONCE ? left : MESHES_AT_ONCE, 1, 0, build_small, &job);
    }
    for (uint32_t i = 0; i < flat->mesh_count; i++) {
        const struct flat_mesh *mesh = &flat->meshes[i];
        struct bvh_params params =
            triangle_params(build, mesh->first_triangle, mesh->triangle_count);
        if (build->meshes[i].node_count == 0 &&
            !build_tree(build, &params, arena, &build->meshes[i], err))
            return false;
        build->cuts[i].count = bvh_cut(&build->meshes[i], build->cuts[i].boxes);
    }
    return true;
}

// --- instances' boxes ----------------------------------------------------------------------------

// A bound of the rounding errors of a hit, relative to the coordinates in world space and in mesh
// space. Rays are transformed in single precision, and each coordinate is a sum of four products,
// which carries errors from one axis to the others.
#define BOX_ROUNDINGS (32.0 * 0x1p-24)

struct box_job {
    const struct build *build;
    struct bvh_box *boxes;
    uint32_t *trees; // for each instance, the tree of its mesh
};

static struct bvh_box instance_box(const struct flat_instance *instance, const struct bvh_cut *cut)
{
    double m[3][4], min[3], max[3], largest = 0;
    struct bvh_box box;
    for (int i = 0; i < 3; i++) {
        min[i] = INFINITY;
        max[i] = -INFINITY;
        for (int j = 0; j < 4; j++)
            m[i][j] = (double)instance->to_world[i][j];
    }
    for (uint32_t k = 0; k < cut->count; k++) {
        double low[3], high[3];
        for (int i = 0; i < 3; i++) {
            low[i] = (double)cut->boxes[k].min[i];
            high[i] = (double)cut->boxes[k].max[i];
        }
        for (int i = 0; i < 3; i++) {
            double sum = fabs(m[i][3]);
            for (int j = 0; j < 3; j++)
                sum += fabs(m[i][j]) * fmax(fabs(low[j]), fabs(high[j]));
            largest = fmax(largest, sum);
        }
        affine_box(m, low, high, low, high);
        for (int i = 0; i < 3; i++) {
            min[i] = low[i] < min[i] ? low[i] : min[i];
            max[i] = high[i] > max[i] ? high[i] : max[i];
        }
    }
    for (int i = 0; i < 3; i++) {
        box.min[i] = nextafterf((float)(min[i] - BOX_ROUNDINGS * largest), -INFINITY);
        box.max[i] = nextafterf((float)(max[i] + BOX_ROUNDINGS * largest), INFINITY);
    }
    return box;
}

static void make_boxes(void *context, size_t begin, size_t end, unsigned thread)
{
    (void)thread;
    const struct box_job *job = context;
    for (size_t i = begin; i < end; i++) {
        const struct flat_instance *instance = &job->build->flat->instances[i];
        job->boxes[i] = instance_box(instance, &job->build->cuts[instance->mesh]);
        job->trees[i] = instance->mesh;
    }
}

// --- the whole geometry --------------------------------------------------------------------------

static bool build_world(struct build *build, const struct bvh_box *instance_boxes,
                        struct arena *scratch, struct arena *arena, struct bvh *out,
                        struct err *err)
{
    const struct flat_scene *flat = build->flat;
    struct bvh_box *boxes = ARENA_NEW(scratch, struct bvh_box, flat->shape_count);
    if (!boxes)
        return err_memory(err, "shapes", flat->shape_count * sizeof *boxes);
    for (uint32_t i = 0; i < flat->shape_count; i++)
        flat_shape_box(&flat->shapes[i], boxes[i].min, boxes[i].max);
    struct bvh_params params = triangle_params(build, 0, flat->world_triangle_count);
    params.shape_boxes = boxes;
    params.shape_count = flat->shape_count;
    params.instance_boxes = instance_boxes;
    params.instance_count = flat->placed_count;
    return build_tree(build, &params, arena, out, err);
}

static bool build_two_levels(struct build *build, struct arena *scratch, struct arena *arena,
                             struct bvh *out, struct err *err)
{
    const struct flat_scene *flat = build->flat;
    struct box_job boxes = {
        build,
        ARENA_NEW(scratch, struct bvh_box, flat->placed_count),
        ARENA_NEW(scratch, uint32_t, flat->placed_count),
    };
    build->meshes = ARENA_NEW(scratch, struct bvh, flat->mesh_count);
    build->cuts = ARENA_NEW(scratch, struct bvh_cut, flat->mesh_count);
    struct bvh world;
    if (!boxes.boxes || !boxes.trees || !build->meshes || !build->cuts)
        return err_memory(err, "instances",
                          flat->placed_count * (sizeof *boxes.boxes + sizeof *boxes.trees));
    if (!build_meshes(build, scratch, err))
        return false;
    parallel_for(flat->placed_count, 4096, 0, make_boxes, &boxes);
    if (!build_world(build, boxes.boxes, scratch, scratch, &world, err))
        return false;
    const struct bvh_join_params join = {&world, build->meshes, flat->mesh_count, boxes.trees};
    return bvh_join(&join, arena, out, err);
}

static bool build_bvh(const struct geometry_params *p, const struct flat_scene *flat,
                      struct arena *arena, struct bvh *bvh, struct err *err)
{
    uint64_t start = clock_ns();
    struct arena scratch = {0}, arenas[PARALLEL_MAX_THREADS] = {{0}};
    struct build build = {
        .p = p, .flat = flat, .arenas = arenas, .cache = {.folder = p->bvh_cache}};
    bool ok = flat->mesh_count > 0 ? build_two_levels(&build, &scratch, arena, bvh, err)
                                   : build_world(&build, NULL, &scratch, arena, bvh, err);
    if (ok) {
        double seconds = clock_seconds_since(start), spared = build.spared_seconds;
        bvh->stats.build_seconds = seconds;
        bvh->stats.cached_seconds = build.cache.loaded ? fmax(seconds + spared, 0.0) : 0.0;
    }
    arena_finish(&scratch);
    for (unsigned i = 0; i < PARALLEL_MAX_THREADS; i++)
        arena_finish(&arenas[i]);
    return ok;
}

static struct flatten_params flatten_params(const struct geometry_params *p)
{
    return (struct flatten_params){p->scene, p->instancing, p->progress, p->camera};
}

bool geometry_prepare(const struct geometry_params *p, struct arena *arena, struct flat_scene *flat,
                      struct bvh *bvh, struct err *err)
{
    const struct flatten_params params = flatten_params(p);
    if (!scene_flatten(&params, arena, flat, err))
        return false;
    return build_bvh(p, flat, arena, bvh, err);
}

// --- geometry shared by renderers ----------------------------------------------------------------

static bool same_bits(const void *a, const void *b, size_t bytes)
{
    return memcmp(a, b, bytes) == 0;
}

static bool same_counts(const struct flat_scene *a, const struct flat_scene *b)
{
    return a->triangle_count == b->triangle_count &&
           a->world_triangle_count == b->world_triangle_count && a->mesh_count == b->mesh_count &&
           a->placed_count == b->placed_count && a->shape_count == b->shape_count;
}

static bool same_instances(const struct flat_scene *a, const struct flat_scene *b)
{
    for (uint32_t i = 0; i < a->mesh_count; i++)
        if (a->meshes[i].first_triangle != b->meshes[i].first_triangle ||
            a->meshes[i].triangle_count != b->meshes[i].triangle_count)
            return false;
    for (uint32_t i = 0; i < a->placed_count; i++)
        if (a->instances[i].mesh != b->instances[i].mesh ||
            !same_bits(a->instances[i].to_world, b->instances[i].to_world,
                       sizeof a->instances[i].to_world))
            return false;
    return true;
}

// Returns whether both scenes have the same bits in everything that build_bvh() reads, so that the
// hierarchies would be the same.
static bool same_places(const struct flat_scene *a, const struct flat_scene *b)
{
    if (!same_counts(a, b) || !same_instances(a, b))
        return false;
    for (uint32_t i = 0; i < a->shape_count; i++) {
        struct bvh_box boxes[2];
        flat_shape_box(&a->shapes[i], boxes[0].min, boxes[0].max);
        flat_shape_box(&b->shapes[i], boxes[1].min, boxes[1].max);
        if (!same_bits(&boxes[0], &boxes[1], sizeof boxes[0]))
            return false;
    }
    for (uint32_t i = 0; i < a->triangle_count; i++)
        if (!same_bits(a->triangles[i].v, b->triangles[i].v, sizeof a->triangles[i].v))
            return false;
    return true;
}

static bool same_method(struct bvh_method a, struct bvh_method b)
{
    return a.split == b.split && a.format == b.format && a.optimize == b.optimize &&
           bvh_max_leaf(&a) == bvh_max_leaf(&b) &&
           bvh_cost(a.traversal_cost) == bvh_cost(b.traversal_cost) &&
           bvh_cost(a.intersection_cost) == bvh_cost(b.intersection_cost);
}

bool geometry_create(const struct geometry_params *p, struct geometry *out, struct err *err)
{
    *out = (struct geometry){0};
    return geometry_refresh(p, out, err);
}

void geometry_finish(struct geometry *geometry)
{
    if (!geometry)
        return;
    arena_finish(&geometry->flat_arena);
    arena_finish(&geometry->bvh_arena);
    *geometry = (struct geometry){0};
}

bool geometry_refresh(const struct geometry_params *p, struct geometry *geometry, struct err *err)
{
    const struct flatten_params params = flatten_params(p);
    struct geometry next = {.method = p->bvh, .key = flatten_key(&params)};
    // Even an empty scene has a hierarchy with a root, so node_count is 0 only before the first
    // build.
    bool is_built = geometry->bvh.node_count > 0 && same_method(next.method, geometry->method);
    if (is_built && next.key == geometry->key)
        return true;
    uint64_t start = clock_ns();
    bool ok = scene_flatten(&params, &next.flat_arena, &next.flat, err);
    next.flatten_seconds = clock_seconds_since(start);
    if (ok && is_built && same_places(&next.flat, &geometry->flat)) {
        next.bvh = geometry->bvh;
        next.bvh_arena = geometry->bvh_arena;
        geometry->bvh_arena = (struct arena){0};
    } else if (ok) {
        ok = build_bvh(p, &next.flat, &next.bvh_arena, &next.bvh, err);
    }
    geometry_finish(geometry);
    *geometry = next;
    if (!ok)
        geometry_finish(geometry);
    return ok;
}
