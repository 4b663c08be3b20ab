#include "render/tables/camera_media.h"

#include "scene/core/affine.h"
#include "scene/sdf/sdf.h"
#include "scene/sdf/sdf_evaluate.h"
#include <math.h>
#include <string.h>

#define RAYS 3

struct probe {
    double origin[3];
    double directions[RAYS][3];
    // For each ray and medium: how often the ray leaves the medium, minus how often it enters it.
    int32_t left[RAYS][MEDIA_MAX + 1];
};

// Returns +1 if the ray leaves through the triangle's front side, from which its corners appear
// counter-clockwise; -1 if it enters through that side; 0 for a miss (Moeller and Trumbore 1997).
static int crossing(const double origin[3], const double direction[3],
                    const struct flat_triangle *triangle)
{
    double e1[3], e2[3], from[3], p[3], q[3];
    for (int c = 0; c < 3; c++) {
        e1[c] = (double)triangle->v[1][c] - (double)triangle->v[0][c];
        e2[c] = (double)triangle->v[2][c] - (double)triangle->v[0][c];
        from[c] = origin[c] - (double)triangle->v[0][c];
    }
    vec3_cross(direction, e2, p);
    vec3_cross(from, e1, q);
    double determinant = vec3_dot(e1, p); // -(direction . normal)
    if (determinant == 0.0)
        return 0;
    double u = vec3_dot(from, p) / determinant, v = vec3_dot(direction, q) / determinant;
    double t = vec3_dot(e2, q) / determinant;
    if (u < 0.0 || v < 0.0 || u + v > 1.0 || t <= 0.0)
        return 0;
    return determinant < 0.0 ? 1 : -1;
}

// --- shapes --------------------------------------------------------------------------------------

// Returns whether a point is inside the body that a shape encloses. A plane encloses the half-space
// behind it.
static bool is_inside(const double origin[3], const struct flat_shape *shape)
{
    double from[3], axes[3][3], along[3], square[3], radius = (double)shape->radius;
    for (int i = 0; i < 3; i++) {
        from[i] = origin[i] - (double)shape->center[i];
        vec3_widen(shape->axes[i], axes[i]);
    }
    for (int i = 0; i < 3; i++) {
        along[i] = vec3_dot(from, axes[i]);
        square[i] = vec3_dot(axes[i], axes[i]);
    }
    double normal[3];
    vec3_widen(shape->normal, normal);
    switch (shape->kind) {
    case SHAPE_SPHERE:
        return vec3_dot(from, from) < radius * radius;
    case SHAPE_PLANE:
        return vec3_dot(from, normal) < 0.0;
    case SHAPE_BOX:
        return fabs(along[0]) < square[0] && fabs(along[1]) < square[1] &&
               fabs(along[2]) < square[2];
    case SHAPE_CYLINDER:
        return fabs(along[0]) < square[0] &&
               vec3_dot(from, from) - along[0] * along[0] / square[0] < radius * radius;
    default:
        return false;
    }
}

// Returns whether a point is inside a distance field. Outside the field's box there is no body.
static bool is_inside_field(const double origin[3], const struct flat_shape *shape,
                            const struct sdf *sdf)
{
    struct shape placed = {.kind = SHAPE_SDF};
    double to_world[3][4], to_field[3][4], p[3];
    vec3_widen(shape->center, placed.center);
    for (int i = 0; i < 3; i++)
        vec3_widen(shape->axes[i], placed.axes[i]);
    sdf_to_world(sdf, &placed, to_world);
    if (!affine_inverse(to_world, to_field))
        return false;
    affine_point(to_field, origin, p);
    for (int i = 0; i < 3; i++)
        if (!(p[i] >= sdf->min[i] && p[i] <= sdf->max[i]))
            return false;
    return sdf_evaluate(sdf, p) < 0.0;
}

// Returns +1, -1 or 0 as crossing() does, for the plane of a shape at distance t. The plane's front
// side is in the direction of the normal.
static int crossing_plane(const double direction[3], const double normal[3], double t, bool hit)
{
    return !hit || !(t > 0.0) ? 0 : vec3_dot(direction, normal) > 0.0 ? 1 : -1;
}

static int crossing_flat_shape(const double origin[3], const double direction[3],
                               const struct flat_shape *shape)
{
    double from[3], normal[3], u[3], v[3], point[3], radius = (double)shape->radius;
    vec3_widen(shape->normal, normal);
    vec3_widen(shape->axes[0], u);
    vec3_widen(shape->axes[1], v);
    if (shape->kind == SHAPE_QUAD)
        vec3_cross(u, v, normal);
    for (int c = 0; c < 3; c++)
        from[c] = origin[c] - (double)shape->center[c];
    double t = -vec3_dot(from, normal) / vec3_dot(direction, normal);
    for (int c = 0; c < 3; c++)
        point[c] = from[c] + t * direction[c];
    if (shape->kind == SHAPE_DISC)
        return crossing_plane(direction, normal, t, vec3_dot(point, point) <= radius * radius);
    // The coordinates a and b of the point are in units of the half edges.
    double across[3], square = vec3_dot(normal, normal);
    vec3_cross(point, v, across);
    double a = vec3_dot(across, normal) / square;
    vec3_cross(u, point, across);
    double b = vec3_dot(across, normal) / square;
    return crossing_plane(direction, normal, t, fabs(a) <= 1.0 && fabs(b) <= 1.0);
}

// Handles both sides of the wall of an open cylinder together: the ray leaves the body at the far
// crossing and enters it at the near one, if these are between the ends.
static int crossing_tube(const double origin[3], const double direction[3],
                         const struct flat_shape *shape)
{
    double from[3], axis[3], f[3], d[3], radius = (double)shape->radius;
    int crossings = 0;
    vec3_widen(shape->axes[0], axis);
    for (int c = 0; c < 3; c++)
        from[c] = origin[c] - (double)shape->center[c];
    double square = vec3_dot(axis, axis), from_along = vec3_dot(from, axis) / square;
    double along = vec3_dot(direction, axis) / square;
    for (int c = 0; c < 3; c++) {
        f[c] = from[c] - from_along * axis[c];
        d[c] = direction[c] - along * axis[c];
    }
    double a = vec3_dot(d, d), b = vec3_dot(f, d),
           discriminant = b * b - a * (vec3_dot(f, f) - radius * radius);
    for (int side = -1; side <= 1 && discriminant > 0.0; side += 2) {
        double t = (-b + side * sqrt(discriminant)) / a;
        if (t > 0.0 && fabs(from_along + t * along) <= 1.0)
            crossings += side;
    }
    return crossings;
}

static void probe_shape(struct probe *probe, const struct flat_shape *shape, const struct sdf *sdfs,
                        uint32_t number)
{
    bool inside = shape->kind == SHAPE_SDF
                      ? is_inside_field(probe->origin, shape, &sdfs[shape->sdf])
                      : is_inside(probe->origin, shape);
    for (int ray = 0; ray < RAYS; ray++) {
        const double *direction = probe->directions[ray];
        int32_t *left = &probe->left[ray][number];
        if (shape->kind == SHAPE_DISC || shape->kind == SHAPE_QUAD)
            *left += crossing_flat_shape(probe->origin, direction, shape);
        else if (shape->kind == SHAPE_TUBE)
            *left += crossing_tube(probe->origin, direction, shape);
        else
            *left += inside;
    }
}

// --- all surfaces --------------------------------------------------------------------------------

// The state of visiting the triangles of a tree that one of the rays may hit.
struct visit {
    struct probe *probe;
    const struct shading_tables_params *p;
    const struct gpu_material *materials;
    uint32_t override; // material of all triangles; SCENE_NONE: each has its own
    int ray;
};

static void probe_triangle(const struct visit *v, uint32_t index)
{
    const struct flat_triangle *triangle = &v->p->flat->triangles[index];
    uint32_t material = v->override == SCENE_NONE ? triangle->material : v->override;
    uint32_t number = v->materials[material].medium;
    if (number > 0)
        v->probe->left[v->ray][number] +=
            crossing(v->probe->origin, v->probe->directions[v->ray], triangle);
}

static void probe_instance(struct visit *v, const struct flat_instance *instance);

// The first ray that visits an instance probes it with all rays. An instance whose box does not
// contain the rays' origin is skipped.
static void visit_primitive(void *context, uint32_t primitive)
{
    struct visit *v = context;
    if (!(primitive & BVH_LEAF_SHAPE))
        probe_triangle(v, primitive);
    else if (v->ray == 0)
        probe_instance(v, &v->p->flat->instances[primitive & BVH_LEAF_INDEX]);
}

// Returns whether some triangle has several entries in the leaf order. The tree is then not used,
// because it would visit such a triangle several times.
static bool is_split(const struct bvh *bvh)
{
    return bvh->reference_count > bvh->triangle_count;
}

// Probes the triangles [first, end), which belong to the tree at `root`, and the tree's instances.
static void probe_tree(struct visit *v, uint32_t root, uint32_t first, uint32_t end)
{
    const struct bvh *bvh = v->p->bvh;
    for (v->ray = 0; v->ray < RAYS; v->ray++) {
        for (uint32_t i = first; i < end && is_split(bvh); i++)
            probe_triangle(v, i);
        if (!is_split(bvh))
            bvh_visit_ray(bvh, root, v->probe->origin, v->probe->directions[v->ray],
                          visit_primitive, v);
    }
}

static void probe_instance(struct visit *v, const struct flat_instance *instance)
{
    const struct flat_mesh *mesh = &v->p->flat->meshes[instance->mesh];
    const struct probe *world = v->probe;
    struct probe probe = *world;
    for (int row = 0; row < 3; row++) {
        double linear[3];
        vec3_widen(instance->to_object[row], linear);
        probe.origin[row] = vec3_dot(linear, world->origin) + (double)instance->to_object[row][3];
        for (int ray = 0; ray < RAYS; ray++)
            probe.directions[ray][row] = vec3_dot(linear, world->directions[ray]);
    }
    // A closed surface encloses no point outside its box.
    for (int c = 0; c < 3; c++)
        if (!(probe.origin[c] >= (double)mesh->bounds_min[c] &&
              probe.origin[c] <= (double)mesh->bounds_max[c]))
            return;
    struct visit inside = *v;
    inside.probe = &probe;
    inside.override = instance->material;
    probe_tree(&inside, v->p->bvh->roots[instance->mesh + 1], mesh->first_triangle,
               mesh->first_triangle + mesh->triangle_count);
    memcpy(v->probe->left, probe.left, sizeof probe.left);
}

static void probe_scene(struct probe *probe, const struct shading_tables_params *p,
                        const struct gpu_material *materials)
{
    const struct flat_scene *flat = p->flat;
    struct visit visit = {probe, p, materials, SCENE_NONE, 0};
    probe_tree(&visit, 0, 0, flat->world_triangle_count);
    for (uint32_t i = 0; i < flat->placed_count && is_split(p->bvh); i++)
        probe_instance(&visit, &flat->instances[i]);
    for (uint32_t i = 0; i < flat->shape_count; i++) {
        uint32_t number = materials[flat->shapes[i].material].medium;
        if (number > 0)
            probe_shape(probe, &flat->shapes[i], p->scene->sdfs, number);
    }
}

// Returns the count that at least two of the three rays agree on; 0 if there is none.
static int32_t majority(const struct probe *probe, uint32_t number)
{
    int32_t a = probe->left[0][number], b = probe->left[1][number], c = probe->left[2][number];
    return a == b || a == c ? a : b == c ? b : 0;
}

uint32_t camera_media_find(const struct shading_tables_params *p,
                           const struct gpu_material *materials)
{
    // One ray is along the line of sight, two are beside it. None is along an axis, because scenes
    // are often symmetric.
    struct probe probe = {0};
    const double *d = p->camera->direction;
    flat_from_world(p->flat, p->camera->position, probe.origin);
    for (int c = 0; c < 3; c++) {
        probe.origin[c] = (double)(float)probe.origin[c];
        probe.directions[0][c] = d[c] + 0.0123 * d[(c + 1) % 3] + 0.00456 * (c + 1);
        probe.directions[1][c] = d[(c + 1) % 3] + 0.345 * (c - 0.7);
        probe.directions[2][c] = d[(c + 2) % 3] - 0.234 * (c - 1.3);
    }
    probe_scene(&probe, p, materials);
    uint32_t stack = 0;
    for (uint32_t number = 1; number <= MEDIA_MAX; number++)
        for (int32_t n = majority(&probe, number); n > 0; n--)
            stack = stack << 8 | number; // the media of highest priority remain
    return stack;
}
