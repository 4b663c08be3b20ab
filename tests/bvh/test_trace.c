// Tests the reference traversal: it equals brute force bit for bit, and is correct where the result
// is known.
#include "bvh_trace.h"
#include "meshes.h"
#include "test.h"

#define NONE UINT32_MAX

static const struct bvh_method ways[] = {
    {BVH_SPLIT_SAH, BVH_QUANTISED},        {BVH_SPLIT_MEDIAN, BVH_FLOAT},
    {BVH_SPLIT_MEAN, BVH_QUANTISED},       {BVH_SPLIT_SAH, BVH_FLOAT},
    {BVH_SPLIT_SPATIAL, BVH_QUANTISED},    {BVH_SPLIT_MIDDLE, BVH_FLOAT, .max_leaf = 8},
    {.traversal_cost = 10, .max_leaf = 5},
};
enum { WAYS = sizeof ways / sizeof *ways };

struct scene {
    struct arena arena;
    struct mesh mesh;
    struct bvh_params params;
    struct bvh bvh[WAYS];
    struct bvh_trace_scene trace; // refers to the first member
};

static void scene_build(struct scene *scene)
{
    struct err err = {0};
    for (int way = 0; way < WAYS; way++) {
        scene->params.method = ways[way];
        CHECK(bvh_build(&scene->params, &scene->arena, &scene->bvh[way], &err), "%s", err.msg);
    }
    scene->trace.bvh = &scene->bvh[0];
    scene->trace.geometry = &scene->params;
}

static struct bvh_ray make_ray(const double origin[3], const double direction[3])
{
    struct bvh_ray ray = {.t_max = INFINITY, .ignore = {NONE, NONE}};
    memcpy(ray.origin, origin, sizeof ray.origin);
    memcpy(ray.direction, direction, sizeof ray.direction);
    return ray;
}

// Compares all three functions for one ray, with any tree. Returns whether it hits anything.
static bool check_ray(const struct scene *scene, const struct bvh_ray *ray)
{
    struct bvh_hit want, got;
    struct bvh_trace_scene trace = scene->trace;
    bvh_trace_brute_force(&trace, ray, &want);
    for (int way = 0; way < WAYS; way++) {
        trace.bvh = &scene->bvh[way];
        bvh_trace_closest(&trace, ray, &got);
        CHECK(got.primitive == want.primitive && !memcmp(&got.t, &want.t, sizeof got.t) &&
                  !memcmp(&got.u, &want.u, sizeof got.u) && !memcmp(&got.v, &want.v, sizeof got.v),
              "way %d: %u at %.17g, not %u at %.17g; origin (%a %a %a), direction (%a %a %a)", way,
              got.primitive, got.t, want.primitive, want.t, ray->origin[0], ray->origin[1],
              ray->origin[2], ray->direction[0], ray->direction[1], ray->direction[2]);
        CHECK(bvh_trace_any(&trace, ray) == (want.primitive != NONE), "way %d", way);
    }
    return want.primitive != NONE;
}

// --- Rays that are hard on a traversal ----------------------------------------------------------

static const float *some_vertex(const struct mesh *mesh, struct random *random)
{
    return mesh->vertices[random_u32(random) % mesh->count][random_u32(random) % 3];
}

// Returns a point of a triangle: inside, on an edge, or a corner.
static void point_on_triangle(const struct mesh *mesh, struct random *random, double point[3])
{
    const float(*v)[3] = (const float(*)[3])mesh->vertices[random_u32(random) % mesh->count];
    double a = random_unit(random), b = random_unit(random) * (1 - a);
    uint32_t kind = random_u32(random) % 3;
    a = kind == 2 ? 1 : a;
    b = kind == 0 ? b : kind == 1 ? 1 - a : 0;
    for (int axis = 0; axis < 3; axis++)
        point[axis] = a * v[0][axis] + b * v[1][axis] + (1 - a - b) * v[2][axis];
}

static void any_origin(const struct mesh *mesh, struct random *random, double origin[3])
{
    const float *vertex = some_vertex(mesh, random);
    double far = random_u32(random) % 8 == 0 ? 1000 : 1;
    for (int axis = 0; axis < 3; axis++)
        origin[axis] = random_u32(random) % 8 == 0
                           ? vertex[axis]
                           : vertex[axis] + far * random_between(random, -1, 1);
}

// Returns a direction parallel to an axis or to a coordinate plane, with zeros of both signs.
static void axis_direction(struct random *random, double direction[3])
{
    random_direction(random, direction);
    uint32_t keep = random_u32(random) % 3, second = random_u32(random) % 2;
    for (uint32_t axis = 0; axis < 3; axis++)
        if (axis != keep && !(second && axis == (keep + 1) % 3))
            direction[axis] = random_u32(random) % 2 ? 0.0 : -0.0;
}

static void scale_direction(struct random *random, double direction[3])
{
    double length = random_u32(random) % 4 ? 1 : pow(10, random_between(random, -12, 12));
    for (int axis = 0; axis < 3; axis++)
        direction[axis] *= length;
}

static struct bvh_ray hard_ray(const struct mesh *mesh, struct random *random)
{
    double origin[3], target[3], direction[3];
    any_origin(mesh, random, origin);
    switch (random_u32(random) % 8) {
    case 0:
        random_direction(random, direction);
        break;
    case 1:
    case 2:
        axis_direction(random, direction);
        break;
    case 3: // to a point of a triangle, which may be a corner or on an edge
        point_on_triangle(mesh, random, target);
        for (int axis = 0; axis < 3; axis++)
            direction[axis] = target[axis] - origin[axis];
        break;
    case 4: // from a point of a triangle
        point_on_triangle(mesh, random, origin);
        random_direction(random, direction);
        break;
    case 5: // from surface to surface, often along an edge or in a triangle's plane
        point_on_triangle(mesh, random, origin);
        point_on_triangle(mesh, random, target);
        for (int axis = 0; axis < 3; axis++)
            direction[axis] = target[axis] - origin[axis];
        break;
    case 6: { // from vertex to vertex, exactly
        const float *a = some_vertex(mesh, random), *b = some_vertex(mesh, random);
        for (int axis = 0; axis < 3; axis++) {
            origin[axis] = a[axis];
            direction[axis] = (double)b[axis] - a[axis];
        }
        break;
    }
    default: // almost parallel to an axis, with a component like the computed cos(pi / 2)
        axis_direction(random, direction);
        for (int axis = 0; axis < 3; axis++)
            direction[axis] += direction[axis] == 0 ? random_between(random, -1e-16, 1e-16) : 0;
    }
    if (direction[0] == 0 && direction[1] == 0 && direction[2] == 0)
        direction[2] = 1;
    scale_direction(random, direction);
    struct bvh_ray ray = make_ray(origin, direction);
    if (random_u32(random) % 4 == 0)
        ray.t_max = random_unit(random);
    if (random_u32(random) % 4 == 0)
        ray.ignore[random_u32(random) % 2] = random_u32(random) % mesh->count;
    return ray;
}

static void check_hard_rays(struct scene *scene, uint32_t rays, double least_hits)
{
    scene->params = mesh_params(&scene->mesh);
    scene_build(scene);
    struct random random = {scene->mesh.count};
    uint32_t hits = 0;
    for (uint32_t i = 0; i < rays; i++) {
        struct bvh_ray ray = hard_ray(&scene->mesh, &random);
        hits += check_ray(scene, &ray);
    }
    CHECK(hits >= least_hits * rays, "only %u of %u rays hit", hits, rays);
    arena_finish(&scene->arena);
}

TEST(brute_force_soups)
{
    static const uint32_t counts[] = {1, 2, 3, 4, 5, 9, 64, 500};
    for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++) {
        struct scene scene = {0};
        scene.mesh = mesh_soup(&scene.arena, counts[i], 0.4, i);
        check_hard_rays(&scene, 5000, 0.05);
    }
}

// The corners are on a coarse lattice, so there are axis-parallel triangles, triangles without
// area, and shared planes and edges.
TEST(brute_force_lattice)
{
    struct scene scene = {0};
    scene.mesh = mesh_soup(&scene.arena, 300, 1, 12);
    for (uint32_t i = 0; i < scene.mesh.count; i++)
        for (int v = 0; v < 3; v++)
            for (int axis = 0; axis < 3; axis++) {
                float *x = &scene.mesh.vertices[i][v][axis];
                *x = roundf(*x * 4) / 4;
            }
    check_hard_rays(&scene, 20000, 0.2);
}

TEST(brute_force_sphere)
{
    struct scene scene = {0};
    scene.mesh = mesh_sphere(&scene.arena, 12, 24);
    check_hard_rays(&scene, 20000, 0.2);
}

TEST(brute_force_slivers)
{
    struct scene scene = {0};
    scene.mesh = mesh_soup(&scene.arena, 200, 0.01, 8);
    for (uint32_t i = 0; i < scene.mesh.count; i++)
        for (int v = 0; v < 3; v++)
            scene.mesh.vertices[i][v][i % 3] = v == 0 ? -5000.0f : 5000.0f;
    check_hard_rays(&scene, 10000, 0.05);
}

TEST(brute_force_extreme_scales)
{
    static const float scales[] = {1e-30f, 1e-8f, 1e8f, 1e30f};
    for (size_t i = 0; i < sizeof scales / sizeof scales[0]; i++) {
        struct scene scene = {0};
        scene.mesh = mesh_soup(&scene.arena, 100, 0.4, i);
        for (uint32_t t = 0; t < scene.mesh.count; t++)
            for (int v = 0; v < 3; v++)
                for (int axis = 0; axis < 3; axis++)
                    scene.mesh.vertices[t][v][axis] *= scales[i];
        check_hard_rays(&scene, 5000, 0.05);
    }
}

// A scene with coordinates of every magnitude.
TEST(brute_force_all_magnitudes)
{
    struct scene scene = {0};
    scene.mesh = mesh_new(&scene.arena, 300);
    struct random random = {3};
    for (uint32_t i = 0; i < scene.mesh.count; i++)
        for (int v = 0; v < 3; v++)
            for (int axis = 0; axis < 3; axis++) {
                double magnitude = pow(10, random_between(&random, -12, 12));
                scene.mesh.vertices[i][v][axis] =
                    (float)(random_unit(&random) < 0.5 ? -magnitude : magnitude);
            }
    check_hard_rays(&scene, 10000, 0.05);
}

// --- Known answers ------------------------------------------------------------------------------

TEST(empty_scene)
{
    struct scene scene = {0};
    scene_build(&scene);
    struct bvh_ray ray = make_ray((double[]){0, 0, 0}, (double[]){0, 0, 1});
    CHECK(!check_ray(&scene, &ray));
    arena_finish(&scene.arena);
}

TEST(known_triangle)
{
    struct scene scene = {0};
    scene.mesh = mesh_new(&scene.arena, 1);
    memcpy(scene.mesh.vertices[0], (float[3][3]){{0, 0, 2}, {1, 0, 2}, {0, 1, 2}},
           sizeof scene.mesh.vertices[0]);
    scene.params = mesh_params(&scene.mesh);
    scene_build(&scene);
    for (int side = 0; side < 2; side++) { // tests both sides; t is in units of the direction's
                                           // length
        struct bvh_ray ray =
            make_ray((double[]){0.25, 0.5, side ? 4 : 0}, (double[]){0, 0, side ? -0.5 : 0.5});
        struct bvh_hit hit;
        bvh_trace_closest(&scene.trace, &ray, &hit);
        CHECK(hit.primitive == 0 && hit.t == 4 && hit.u == 0.25 && hit.v == 0.5, "%g %g %g", hit.t,
              hit.u, hit.v);
        CHECK(hit.nodes_visited == 1 && hit.primitives_tested == 1);
        ray.t_max = 4; // hits have t < t_max
        CHECK(!check_ray(&scene, &ray));
        ray.t_max = 4.001;
        CHECK(check_ray(&scene, &ray));
        ray.ignore[1] = 0;
        CHECK(!check_ray(&scene, &ray));
    }
    arena_finish(&scene.arena);
}

static void check_lowest_wins(struct scene *scene)
{
    scene->params = mesh_params(&scene->mesh);
    scene_build(scene);
    struct bvh_ray ray = make_ray((double[]){0.4, 0.4, -1}, (double[]){0.01, 0.02, 1});
    struct bvh_hit hit;
    bvh_trace_closest(&scene->trace, &ray, &hit);
    CHECK(hit.primitive == 0, "%u", hit.primitive);
    ray.ignore[0] = 0;
    bvh_trace_closest(&scene->trace, &ray, &hit);
    CHECK(hit.primitive == 1, "%u", hit.primitive);
    arena_finish(&scene->arena);
}

TEST(lowest_of_identical_triangles_wins)
{
    static const uint32_t counts[] = {2, 5, 10000, 200000};
    for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++) {
        struct scene scene = {0};
        scene.mesh = mesh_identical(&scene.arena, counts[i]);
        check_lowest_wins(&scene);
    }
}

// A triangle and copies with other orders of corners are far apart in the list.
TEST(lowest_of_coplanar_duplicates_wins)
{
    struct scene scene = {0};
    scene.mesh = mesh_soup(&scene.arena, 2000, 0.2, 9);
    for (uint32_t i = 0; i < 1000; i++)
        for (int v = 0; v < 3; v++)
            memcpy(scene.mesh.vertices[1999 - i][v], scene.mesh.vertices[i][v], sizeof(float[3]));
    scene.params = mesh_params(&scene.mesh);
    scene_build(&scene);
    struct random random = {1};
    uint32_t hits = 0;
    for (int i = 0; i < 2000; i++) {
        struct bvh_ray ray = hard_ray(&scene.mesh, &random);
        ray.ignore[0] = ray.ignore[1] = NONE;
        struct bvh_hit hit;
        bvh_trace_closest(&scene.trace, &ray, &hit);
        hits += hit.primitive != NONE;
        CHECK(hit.primitive == NONE || hit.primitive < 1000, "%u", hit.primitive);
    }
    CHECK(hits > 500, "%u", hits);
    arena_finish(&scene.arena);
}

// Checks that a ray from inside the closed sphere towards one of its points hits the sphere near
// that point.
static void check_inside(const struct scene *scene, const double origin[3], const double target[3])
{
    double direction[3];
    for (int axis = 0; axis < 3; axis++)
        direction[axis] = target[axis] - origin[axis];
    struct bvh_ray ray = make_ray(origin, direction);
    struct bvh_hit hit;
    bvh_trace_closest(&scene->trace, &ray, &hit);
    CHECK(hit.primitive != NONE && fabs(hit.t - 1) < 1e-9,
          "origin (%a %a %a), target (%a %a %a): %g", origin[0], origin[1], origin[2], target[0],
          target[1], target[2], hit.t);
}

TEST(closed_mesh_is_watertight)
{
    struct scene scene = {0};
    scene.mesh = mesh_sphere(&scene.arena, 40, 80);
    scene.params = mesh_params(&scene.mesh);
    scene_build(&scene);
    struct random random = {77};
    for (uint32_t i = 0; i < scene.mesh.count; i++) {
        const float(*v)[3] = (const float(*)[3])scene.mesh.vertices[i];
        for (int k = 0; k < 3; k++) {
            const float *a = v[k], *b = v[(k + 1) % 3];
            double origin[3], at_edge[3], blend = random_unit(&random);
            random_direction(&random, origin);
            double radius = random_u32(&random) % 4 ? random_between(&random, 0, 0.9) : 0;
            for (int axis = 0; axis < 3; axis++) {
                origin[axis] *= radius;
                at_edge[axis] = a[axis] + blend * ((double)b[axis] - a[axis]);
            }
            check_inside(&scene, origin, (double[]){a[0], a[1], a[2]});
            check_inside(&scene, origin, at_edge);
        }
    }
    arena_finish(&scene.arena);
}

// --- Shapes -------------------------------------------------------------------------------------

struct sphere {
    double centre[3], radius;
};

static double intersect_sphere(const void *context, uint32_t shape, const struct bvh_ray *ray)
{
    const struct sphere *sphere = (const struct sphere *)context + shape;
    double a = 0, b = 0, c = -sphere->radius * sphere->radius;
    for (int axis = 0; axis < 3; axis++) {
        double offset = ray->origin[axis] - sphere->centre[axis];
        a += ray->direction[axis] * ray->direction[axis];
        b += ray->direction[axis] * offset;
        c += offset * offset;
    }
    double discriminant = b * b - a * c;
    if (discriminant < 0)
        return -1;
    double near = (-b - sqrt(discriminant)) / a, far = (-b + sqrt(discriminant)) / a;
    double t = near > 0 ? near : far;
    return t < ray->t_max ? t : -1;
}

TEST(shapes_and_triangles)
{
    enum { SPHERES = 40 };
    struct scene scene = {0};
    struct sphere spheres[SPHERES];
    struct bvh_box boxes[SPHERES];
    struct random random = {4};
    for (int i = 0; i < SPHERES; i++) {
        spheres[i].radius = i % 4 ? 0.05 : 0.2;
        for (int axis = 0; axis < 3; axis++) {
            double centre = spheres[i].centre[axis] = random_unit(&random);
            // Rounded outwards: a float's spacing below 1.2 is at most 2^-23.
            boxes[i].min[axis] = (float)(centre - spheres[i].radius) - 0x1p-23f;
            boxes[i].max[axis] = (float)(centre + spheres[i].radius) + 0x1p-23f;
        }
    }
    spheres[7] = spheres[3]; // the lower one wins
    boxes[7] = boxes[3];
    scene.mesh = mesh_soup(&scene.arena, 60, 0.3, 3);
    scene.params = mesh_params(&scene.mesh);
    scene.params.shape_boxes = boxes;
    scene.params.shape_count = SPHERES;
    scene.trace.intersect_shape = intersect_sphere;
    scene.trace.shape_context = spheres;
    scene_build(&scene);
    uint32_t shape_hits = 0;
    for (int i = 0; i < 10000; i++) {
        struct bvh_ray ray = hard_ray(&scene.mesh, &random);
        check_ray(&scene, &ray);
        struct bvh_hit hit;
        bvh_trace_closest(&scene.trace, &ray, &hit);
        CHECK(hit.primitive != (BVH_LEAF_SHAPE | 7));
        shape_hits += hit.primitive != NONE && hit.primitive & BVH_LEAF_SHAPE;
    }
    CHECK(shape_hits > 1000, "%u", shape_hits);
    arena_finish(&scene.arena);
}

TEST_MAIN(TEST_CASE(brute_force_soups), TEST_CASE(brute_force_lattice),
          TEST_CASE(brute_force_sphere), TEST_CASE(brute_force_slivers),
          TEST_CASE(brute_force_extreme_scales), TEST_CASE(brute_force_all_magnitudes),
          TEST_CASE(empty_scene), TEST_CASE(known_triangle),
          TEST_CASE(lowest_of_identical_triangles_wins),
          TEST_CASE(lowest_of_coplanar_duplicates_wins), TEST_CASE(closed_mesh_is_watertight),
          TEST_CASE(shapes_and_triangles))
