// The CPU reference: closest hit, any hit and brute force, in double precision.
//
// The tree never changes the result, for any input. A primitive counts as hit only if the ray also
// hits the primitive's own box, by the same slab test as for nodes, and its t is clamped to that
// box's interval. The slab test is monotone: rounding preserves order, so the interval of a box
// contains that of any box inside it, bit for bit. Hence no node above a hit primitive is missed or
// begins behind its t. Boxes are enlarged by more than the rounding errors of the triangle test, so
// these rules only affect hits that are rounding errors themselves.
#include "bvh_trace.h"

#include "bvh/bvh_node.h"
#include "bvh/bvh_slab.h"
#include "bvh/bvh_triangle.h"
#include <math.h>
#include <string.h>

// --- Triangles ----------------------------------------------------------------------------------

// The shear that turns the ray into the unit z axis.
struct shear_ray {
    int kx, ky, kz; // kz is the largest component of the direction
    double sx, sy, sz;
};

static struct shear_ray shear_ray_for(const struct bvh_ray *ray)
{
    const double *d = ray->direction;
    struct shear_ray shear = {.kz = 0};
    for (int axis = 1; axis < 3; axis++)
        shear.kz = fabs(d[axis]) > fabs(d[shear.kz]) ? axis : shear.kz;
    shear.kx = (shear.kz + 1) % 3;
    shear.ky = (shear.kx + 1) % 3;
    shear.sx = d[shear.kx] / d[shear.kz];
    shear.sy = d[shear.ky] / d[shear.kz];
    shear.sz = 1 / d[shear.kz];
    return shear;
}

// Tests a triangle from both sides (Woop, Benthin, Wald 2013, "Watertight ray/triangle
// intersection"). For an edge that two triangles share, the two edge functions are exact negatives
// of each other, and zero counts as inside for both.
static bool triangle_test(const struct shear_ray *shear, const double origin[3],
                          const float vertices[3][3], struct bvh_hit *hit)
{
    double x[3], y[3], z[3];
    for (int i = 0; i < 3; i++) {
        z[i] = vertices[i][shear->kz] - origin[shear->kz];
        x[i] = vertices[i][shear->kx] - origin[shear->kx] - shear->sx * z[i];
        y[i] = vertices[i][shear->ky] - origin[shear->ky] - shear->sy * z[i];
    }
    double u = x[2] * y[1] - y[2] * x[1]; // the weight of corner 0, times the determinant
    double v = x[0] * y[2] - y[0] * x[2];
    double w = x[1] * y[0] - y[1] * x[0];
    if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0))
        return false;
    double determinant = u + v + w;
    if (determinant == 0) // seen edge-on, or without area
        return false;
    hit->t = (u * z[0] + v * z[1] + w * z[2]) * shear->sz / determinant;
    hit->u = v / determinant;
    hit->v = w / determinant;
    return isfinite(hit->t);
}

// --- Primitives ---------------------------------------------------------------------------------

// A ray in world space, or in the space of an instance's tree.
struct tracer {
    const struct bvh_trace_scene *scene;
    const struct bvh_ray *ray;
    struct slab_ray slab;
    struct shear_ray shear;
    uint32_t instance;  // UINT32_MAX: world space
    double interval[2]; // range of t within the instance's box
};

static struct tracer tracer_for(const struct bvh_trace_scene *scene, const struct bvh_ray *ray)
{
    return (struct tracer){scene,
                           ray,
                           slab_ray_for(ray->origin, ray->direction),
                           shear_ray_for(ray),
                           UINT32_MAX,
                           {-INFINITY, INFINITY}};
}

// Computes the interval of t in which a ray is inside a box of single precision. Returns false if
// there is none.
static bool box_test(const struct slab_ray *ray, const struct bvh_box *box, double interval[2])
{
    double min[3], max[3];
    for (int axis = 0; axis < 3; axis++) {
        min[axis] = box->min[axis];
        max[axis] = box->max[axis];
    }
    return slab_test(ray, min, max, interval);
}

// Enters an instance. Returns false if the ray misses its box. The transformed ray is written to
// `ray`.
static bool enter_instance(const struct tracer *world, uint32_t instance, struct bvh_ray *ray,
                           struct tracer *out)
{
    double interval[2] = {-INFINITY, INFINITY};
    const double(*m)[4] = world->scene->instances[instance].to_object;
    const struct bvh_box *boxes = world->scene->geometry->instance_boxes;
    if (boxes && !box_test(&world->slab, &boxes[instance], interval))
        return false;
    *ray = *world->ray;
    for (int i = 0; i < 3; i++) {
        const double *o = world->ray->origin, *d = world->ray->direction;
        ray->origin[i] = m[i][0] * o[0] + m[i][1] * o[1] + m[i][2] * o[2] + m[i][3];
        ray->direction[i] = m[i][0] * d[0] + m[i][1] * d[1] + m[i][2] * d[2];
    }
    *out = tracer_for(world->scene, ray);
    out->instance = instance;
    memcpy(out->interval, interval, sizeof interval);
    return true;
}

static bool is_ignored(const struct tracer *tracer, uint32_t primitive)
{
    const struct bvh_ray *ray = tracer->ray;
    for (int i = 0; i < 2; i++)
        if (primitive == ray->ignore[i] && tracer->instance + 1 == ray->ignore_instance[i])
            return true;
    return false;
}

static struct bvh_box triangle_box(const float vertices[3][3])
{
    struct bvh_box box = box_empty();
    for (int i = 0; i < 3; i++)
        box_add_point(&box, vertices[i]);
    return box;
}

// Computes the hit with a primitive, without regard to other hits.
static bool primitive_test(const struct tracer *tracer, uint32_t primitive, struct bvh_hit *hit)
{
    const struct bvh_ray *ray = tracer->ray;
    const struct bvh_trace_scene *scene = tracer->scene;
    if (is_ignored(tracer, primitive))
        return false;
    struct bvh_box box;
    *hit = (struct bvh_hit){.primitive = primitive, .instance = tracer->instance};
    if (primitive & BVH_LEAF_SHAPE) {
        uint32_t shape = primitive & BVH_LEAF_INDEX;
        hit->t = scene->intersect_shape(scene->shape_context, shape, ray);
        if (!(hit->t > 0))
            return false;
        box = scene->geometry->shape_boxes[shape];
    } else {
        float vertices[3][3];
        bvh_triangle_load(scene->geometry, primitive, vertices);
        if (!triangle_test(&tracer->shear, ray->origin, (const float(*)[3])vertices, hit))
            return false;
        box = triangle_box((const float(*)[3])vertices);
    }
    double interval[2];
    if (!box_test(&tracer->slab, &box, interval))
        return false;
    hit->t = hit->t < interval[0] ? interval[0] : hit->t > interval[1] ? interval[1] : hit->t;
    return hit->t > 0 && hit->t < ray->t_max && hit->t >= tracer->interval[0] &&
           hit->t <= tracer->interval[1];
}

// Returns whether a hit precedes another one at the same distance.
static bool comes_first(const struct bvh_hit *hit, const struct bvh_hit *other)
{
    if (hit->instance != other->instance)
        return hit->instance + 1 < other->instance + 1; // hits without an instance, UINT32_MAX,
                                                        // come first
    return hit->primitive < other->primitive;
}

// Keeps the nearer hit, or the first one of equal hits. The counts in *best increase.
static void consider(const struct tracer *tracer, uint32_t primitive, struct bvh_hit *best)
{
    struct bvh_hit hit;
    best->primitives_tested++;
    if (!primitive_test(tracer, primitive, &hit))
        return;
    if (hit.t > best->t ||
        (hit.t == best->t && best->primitive != UINT32_MAX && !comes_first(&hit, best)))
        return;
    hit.nodes_visited = best->nodes_visited;
    hit.primitives_tested = best->primitives_tested;
    *best = hit;
}

static struct bvh_hit no_hit(const struct bvh_ray *ray)
{
    return (struct bvh_hit){.t = ray->t_max, .primitive = UINT32_MAX, .instance = UINT32_MAX};
}

// --- Traversal ----------------------------------------------------------------------------------

struct stack_entry {
    double near;
    uint32_t child;
};

// Pushes the children that the ray hits, so that the nearest one is on top.
static uint32_t push_children(const struct tracer *tracer, uint32_t node, double t_max,
                              struct stack_entry *stack, uint32_t size)
{
    const struct bvh *bvh = tracer->scene->bvh;
    const uint32_t *child = bvh_children(bvh, node);
    uint32_t base = size;
    for (uint32_t i = 0; i < bvh_child_count(child); i++) {
        double min[3], max[3], interval[2];
        bvh_child_box(bvh, node, i, min, max);
        if (!slab_test(&tracer->slab, min, max, interval) || interval[0] > t_max)
            continue;
        uint32_t at = size++;
        for (; at > base && stack[at - 1].near < interval[0]; at--)
            stack[at] = stack[at - 1];
        stack[at] = (struct stack_entry){interval[0], child[i]};
    }
    return size;
}

static void traverse(const struct tracer *tracer, uint32_t root, bool any, struct bvh_hit *best);

static void test_leaf(const struct tracer *tracer, uint32_t leaf, bool any, struct bvh_hit *best)
{
    uint32_t first = bvh_leaf_first(tracer->scene->bvh, leaf);
    struct tracer inside;
    struct bvh_ray ray;
    if (bvh_child_is_instance(leaf)) {
        best->primitives_tested++;
        if (enter_instance(tracer, first, &ray, &inside))
            traverse(&inside, tracer->scene->instances[first].root, any, best);
        return;
    }
    if (leaf & BVH_LEAF_SHAPE) {
        consider(tracer, BVH_LEAF_SHAPE | first, best);
        return;
    }
    for (uint32_t i = 0; i < bvh_leaf_count(tracer->scene->bvh, leaf); i++)
        consider(tracer, tracer->scene->bvh->triangle_order[first + i], best);
}

// Boxes at the distance of the best hit are not culled, because they may contain an equal hit that
// precedes it. Recursion enters instances, one level deep.
static void traverse(const struct tracer *tracer, uint32_t root, bool any, struct bvh_hit *best)
{
    // The current child is on this stack, too, so there is one entry more than there are pending
    // children.
    struct stack_entry stack[BVH_STACK_ENTRIES_MAX + 1];
    uint32_t size = 1;
    stack[0] = (struct stack_entry){-INFINITY, root};
    while (size > 0 && !(any && best->primitive != UINT32_MAX)) {
        struct stack_entry entry = stack[--size];
        if (entry.near > best->t)
            continue;
        if (bvh_child_is_leaf(entry.child)) {
            test_leaf(tracer, entry.child, any, best);
            continue;
        }
        best->nodes_visited++;
        size = push_children(tracer, entry.child, best->t, stack, size);
    }
}

static void trace(const struct bvh_trace_scene *scene, const struct bvh_ray *ray, bool any,
                  struct bvh_hit *hit)
{
    struct tracer tracer = tracer_for(scene, ray);
    *hit = no_hit(ray);
    traverse(&tracer, 0, any, hit);
}

void bvh_trace_closest(const struct bvh_trace_scene *scene, const struct bvh_ray *ray,
                       struct bvh_hit *hit)
{
    trace(scene, ray, false, hit);
}

bool bvh_trace_any(const struct bvh_trace_scene *scene, const struct bvh_ray *ray)
{
    struct bvh_hit hit;
    trace(scene, ray, true, &hit);
    return hit.primitive != UINT32_MAX;
}

void bvh_trace_brute_force(const struct bvh_trace_scene *scene, const struct bvh_ray *ray,
                           struct bvh_hit *hit)
{
    struct tracer tracer = tracer_for(scene, ray);
    *hit = no_hit(ray);
    for (uint32_t i = 0; i < scene->geometry->triangle_count; i++)
        consider(&tracer, i, hit);
    for (uint32_t i = 0; i < scene->geometry->shape_count; i++)
        consider(&tracer, BVH_LEAF_SHAPE | i, hit);
    for (uint32_t i = 0; i < scene->geometry->instance_count; i++) {
        const struct bvh_trace_instance *instance = &scene->instances[i];
        struct tracer inside;
        struct bvh_ray transformed;
        if (!enter_instance(&tracer, i, &transformed, &inside))
            continue;
        for (uint32_t t = 0; t < instance->triangle_count; t++)
            consider(&inside, instance->first_triangle + t, hit);
    }
}
