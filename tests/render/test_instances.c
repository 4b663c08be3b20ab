// Tests instances on the host: shared meshes are at the same places as flattened ones.
#include "bvh_trace.h"
#include "flatten/geometry.h"
#include "scene/core/affine.h"
#include "test.h"

enum { MESHES = 3, RAYS = 4000, INSTANCES = 60 };

struct fixture {
    struct scene scene;
    struct arena arena;
    struct flat_scene flat;
    struct bvh bvh;
    struct bvh_params params;
    struct bvh_trace_instance *instances;
    struct bvh_trace_scene trace;
};

// --- scenes --------------------------------------------------------------------------------------

static uint64_t state;

// Returns values in [0, 1) by SplitMix64 (Steele, Lea, Flood 2014).
static double uniform(void)
{
    uint64_t z = state += UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
    return (double)((z ^ z >> 31) >> 11) * 0x1p-53;
}

static double between(double low, double high)
{
    return low + (high - low) * uniform();
}

// Adds triangles that share no vertex, each with every vertex attribute.
static void add_mesh(struct scene *scene, uint32_t triangles, double size)
{
    struct mesh *mesh = scene_add_mesh(scene, NULL);
    struct arena *arena = &scene->arena;
    mesh->name = "soup";
    mesh->triangle_count = triangles;
    mesh->vertex_count = 3 * triangles;
    mesh->positions = arena_alloc(arena, mesh->vertex_count, sizeof *mesh->positions);
    mesh->normals = arena_alloc(arena, mesh->vertex_count, sizeof *mesh->normals);
    mesh->tangents = arena_alloc(arena, mesh->vertex_count, sizeof *mesh->tangents);
    mesh->uvs[0] = arena_alloc(arena, mesh->vertex_count, sizeof *mesh->uvs[0]);
    mesh->colors = arena_alloc(arena, mesh->vertex_count, sizeof *mesh->colors);
    mesh->indices = arena_alloc(arena, triangles, sizeof *mesh->indices);
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        for (int c = 0; c < 3; c++) {
            double from = v % 3 ? (double)mesh->positions[v - v % 3][c] : between(-1, 1);
            mesh->positions[v][c] = (float)(v % 3 ? from + between(-size, size) : from);
            mesh->normals[v][c] = (float)between(-1, 1);
            mesh->tangents[v][c] = (float)between(-1, 1);
        }
        mesh->tangents[v][3] = uniform() < 0.5 ? -1.0f : 1.0f;
        for (int c = 0; c < 4; c++)
            mesh->colors[v][c] = (float)uniform();
        mesh->uvs[0][v][0] = (float)uniform();
        mesh->uvs[0][v][1] = (float)uniform();
        mesh->indices[v / 3][v % 3] = v;
    }
}

enum kind { ROTATED, MIRRORED, SQUASHED, SHEARED, TINY, NESTED, SINGULAR, KINDS };

static void rotate(double m[3][4])
{
    const double axis[3] = {between(-1, 1), between(-1, 1), between(0.1, 1)};
    double turn[3][4];
    affine_rotation(axis, between(0, 6.28), turn);
    affine_multiply(turn, m, m);
}

static void make_transform(enum kind kind, const double center[3], double m[3][4])
{
    memcpy(m, AFFINE_IDENTITY, sizeof AFFINE_IDENTITY);
    rotate(m);
    if (kind == MIRRORED)
        for (int j = 0; j < 4; j++)
            m[1][j] *= -1;
    if (kind == SQUASHED)
        for (int j = 0; j < 4; j++)
            m[2][j] *= 0.01;
    if (kind == SINGULAR)
        for (int j = 0; j < 4; j++)
            m[2][j] = 0;
    if (kind == SHEARED)
        for (int j = 0; j < 4; j++)
            m[0][j] += 3 * m[1][j];
    if (kind == TINY)
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 4; j++)
                m[i][j] *= 1e-3;
    if (kind == NESTED) { // an instance of an instance: two such maps in sequence
        double outer[3][4];
        make_transform(SQUASHED, (const double[]){0, 0.5, 0}, outer);
        affine_multiply(outer, m, m);
    }
    if (kind != SINGULAR)
        rotate(m);
    for (int i = 0; i < 3; i++)
        m[i][3] += center[i] + between(-3, 3);
}

static void make_scene(struct scene *scene, const double center[3], uint64_t seed)
{
    struct material *material;
    state = seed;
    *scene = (struct scene){.path = "test"};
    for (int i = 0; i < 2; i++)
        material = scene_add_material(scene, NULL);
    material->anisotropic = 0.5f; // needs tangents
    add_mesh(scene, 1, 1);
    add_mesh(scene, 40, 0.5);
    add_mesh(scene, 300, 0.2);
    for (uint32_t i = 0; i < INSTANCES; i++) {
        struct instance *instance = scene_add_instance(scene, NULL);
        instance->mesh = i % MESHES;
        instance->material = i % 4 == 0 ? 1 : SCENE_NONE;
        make_transform((enum kind)(i % KINDS), center, instance->transform);
    }
}

static bool prepare(struct fixture *f, enum instancing instancing, struct bvh_method method,
                    struct err *err)
{
    const struct geometry_params params = {&f->scene, .bvh = method, .instancing = instancing};
    if (!geometry_prepare(&params, &f->arena, &f->flat, &f->bvh, err))
        return false;
    const void *vertices = f->flat.triangles;
    f->params = (struct bvh_params){
        .triangle_vertices = vertices,
        .triangle_stride = sizeof *f->flat.triangles,
        .triangle_count = f->flat.world_triangle_count,
        .instance_count = f->flat.placed_count,
    };
    f->instances = ARENA_NEW(&f->arena, struct bvh_trace_instance, f->flat.placed_count);
    for (uint32_t i = 0; i < f->flat.placed_count; i++) {
        const struct flat_instance *placed = &f->flat.instances[i];
        const struct flat_mesh *mesh = &f->flat.meshes[placed->mesh];
        double m[3][4];
        for (int k = 0; k < 12; k++)
            m[k / 4][k % 4] = (double)placed->to_world[k / 4][k % 4];
        CHECK(affine_inverse(m, f->instances[i].to_object));
        f->instances[i].root = f->bvh.roots[placed->mesh + 1];
        f->instances[i].first_triangle = mesh->first_triangle;
        f->instances[i].triangle_count = mesh->triangle_count;
    }
    f->trace = (struct bvh_trace_scene){&f->bvh, &f->params, f->instances, NULL, NULL};
    return true;
}

static void finish(struct fixture *f)
{
    arena_finish(&f->arena);
    scene_finish(&f->scene);
}

// --- rays ----------------------------------------------------------------------------------------

// Returns a ray from around the scene, one in ten from far away, to a point in the scene.
// Coordinates are those of the flat scene.
static struct bvh_ray make_ray(const struct flat_scene *flat, const double center[3])
{
    struct bvh_ray ray = {.t_max = INFINITY, .ignore = {UINT32_MAX, UINT32_MAX}};
    double reach = uniform() < 0.1 ? 100 : 5;
    for (int i = 0; i < 3; i++) {
        double middle = center[i] - flat->origin[i];
        ray.origin[i] = middle + between(-reach, reach);
        ray.direction[i] = middle + between(-4, 4) - ray.origin[i];
    }
    return ray;
}

// Finds the scene's instance, and the triangle of its mesh, that was hit.
static void source_of(const struct flat_scene *flat, const struct bvh_hit *hit, uint32_t out[2])
{
    flat_triangle_source(flat, hit->primitive, &out[0], &out[1]);
    if (hit->instance != UINT32_MAX) {
        CHECK(out[0] == SCENE_NONE);
        out[0] = flat->instances[hit->instance].source;
    }
}

// Compares both levels traced in three ways, and the flattened scene, whose rounded vertices are at
// slightly different places, so that rays along edges may disagree.
static void compare(const double center[3], struct bvh_method method, uint64_t seed)
{
    struct fixture flat = {0}, two = {0};
    struct err err = {0};
    make_scene(&flat.scene, center, seed);
    make_scene(&two.scene, center, seed);
    REQUIRE(prepare(&flat, INSTANCING_OFF, method, &err), "%s", err.msg);
    REQUIRE(prepare(&two, INSTANCING_ON, method, &err), "%s", err.msg);
    REQUIRE(flat.flat.placed_count == 0 && two.flat.placed_count == INSTANCES - INSTANCES / KINDS &&
            two.flat.triangle_count == 341 && two.flat.world_triangle_count == 0);
    uint32_t hits = 0, differ = 0;
    for (int i = 0; i < RAYS; i++) {
        struct bvh_ray ray = make_ray(&flat.flat, center);
        struct bvh_hit one, a, b;
        bvh_trace_closest(&flat.trace, &ray, &one);
        // The two scenes may have different origins.
        for (int c = 0; c < 3; c++)
            ray.origin[c] += flat.flat.origin[c] - two.flat.origin[c];
        bvh_trace_brute_force(&two.trace, &ray, &a);
        bvh_trace_closest(&two.trace, &ray, &b);
        CHECK(a.primitive == b.primitive && a.instance == b.instance && a.t == b.t && a.u == b.u &&
                  a.v == b.v,
              "ray %d: %u of %u at %.17g, not %u of %u at %.17g", i, b.primitive, b.instance, b.t,
              a.primitive, a.instance, a.t);
        CHECK(bvh_trace_any(&two.trace, &ray) == (a.primitive != UINT32_MAX));
        hits += a.primitive != UINT32_MAX;
        if (a.primitive == UINT32_MAX || one.primitive == UINT32_MAX) {
            differ += a.primitive != one.primitive;
            continue;
        }
        uint32_t want[2], got[2];
        source_of(&flat.flat, &one, want);
        source_of(&two.flat, &a, got);
        bool same = want[0] == got[0] && want[1] == got[1] && fabs(a.t - one.t) < 1e-4;
        differ += !same;
    }
    CHECK(hits > RAYS / 10 && hits < RAYS, "%u hits", hits);
    CHECK(differ <= RAYS / 500, "%u of %d rays differ", differ, RAYS);
    finish(&flat);
    finish(&two);
}

TEST(instances_are_where_flattened_ones_are)
{
    static const struct bvh_method methods[] = {
        {BVH_SPLIT_SAH, BVH_QUANTISED},
        {BVH_SPLIT_MEDIAN, BVH_FLOAT},
        {BVH_SPLIT_SAH, BVH_FLOAT, BVH_OPTIMIZE_OFF},
    };
    for (uint64_t i = 0; i < sizeof methods / sizeof *methods; i++)
        compare((const double[]){0, 0, 0}, methods[i], 7 + i);
}

TEST(far_instances_are_where_flattened_ones_are)
{
    compare((const double[]){1e5, -2e5, 3e4}, (struct bvh_method){0}, 3);
}

// Rays start on a triangle of one instance. Only this triangle is ignored, not the same one of
// other instances.
TEST(ignored_triangles_are_of_one_instance)
{
    struct fixture f = {0};
    struct err err = {0};
    struct bvh_hit hit;
    make_scene(&f.scene, (const double[]){0, 0, 0}, 1);
    f.scene.mesh_count = 1;
    f.scene.instance_count = 2;
    memset(f.scene.instances, 0, 2 * sizeof *f.scene.instances);
    for (int i = 0; i < 2; i++) {
        memcpy(f.scene.instances[i].transform, AFFINE_IDENTITY, sizeof AFFINE_IDENTITY);
        f.scene.instances[i].transform[2][3] = -2.0 * i;
    }
    const float corners[3][3] = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
    memcpy(f.scene.meshes[0].positions, corners, sizeof corners);
    REQUIRE(prepare(&f, INSTANCING_ON, (struct bvh_method){0}, &err), "%s", err.msg);
    struct bvh_ray ray = {
        .origin = {0, 0, 1}, .direction = {0, 0, -2}, .t_max = INFINITY, .ignore = {0, UINT32_MAX}};
    bvh_trace_closest(&f.trace, &ray, &hit);
    CHECK(hit.instance == 0 && hit.t == 0.5, "nothing of the world is in the way");
    ray.ignore_instance[0] = 1;
    bvh_trace_closest(&f.trace, &ray, &hit);
    CHECK(hit.instance == 1 && hit.primitive == 0 && hit.t == 1.5);
    ray.ignore[1] = 0;
    ray.ignore_instance[1] = 2;
    bvh_trace_closest(&f.trace, &ray, &hit);
    CHECK(hit.primitive == UINT32_MAX && hit.instance == UINT32_MAX);
    // Two instances are at the same place, so the first one is hit.
    f.scene.instances[1].transform[2][3] = 0;
    REQUIRE(prepare(&f, INSTANCING_ON, (struct bvh_method){0}, &err), "%s", err.msg);
    ray.ignore[0] = ray.ignore[1] = UINT32_MAX;
    bvh_trace_closest(&f.trace, &ray, &hit);
    CHECK(hit.instance == 0 && hit.t == 0.5);
    finish(&f);
}

// --- what corners carry --------------------------------------------------------------------------

static double angle_error(const float a[3], const double b[3])
{
    double n[3] = {(double)a[0], (double)a[1], (double)a[2]}, m[3] = {b[0], b[1], b[2]}, d[3];
    vec3_normalize(n);
    vec3_normalize(m);
    vec3_subtract(n, m, d);
    return vec3_length(d);
}

// Normals are transformed by the inverse transpose, tangents by the matrix, and the sign of
// bitangents is inverted by reflections.
static void check_corner(const struct fixture *flat, const struct fixture *two, uint32_t instance,
                         uint32_t id, uint32_t own, int corner, int own_corner)
{
    const struct flat_instance *placed = &two->flat.instances[instance];
    double normal[3] = {0}, tangent[3] = {0};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            normal[i] +=
                (double)placed->to_object[j][i] * (double)two->flat.normals[own][own_corner][j];
            tangent[i] +=
                (double)placed->to_world[i][j] * (double)two->flat.tangents[own][own_corner][j];
        }
    CHECK(angle_error(flat->flat.normals[id][corner], normal) < 1e-4);
    CHECK(angle_error(flat->flat.tangents[id][corner], tangent) < 1e-4);
    float sign = placed->is_mirrored ? -1.0f : 1.0f;
    CHECK(flat->flat.tangents[id][corner][3] == sign * two->flat.tangents[own][own_corner][3]);
    CHECK(!memcmp(flat->flat.colors[id][corner], two->flat.colors[own][own_corner], 16));
}

TEST(corners_carry_the_same)
{
    struct fixture flat = {0}, two = {0};
    struct err err = {0};
    make_scene(&flat.scene, (const double[]){0, 0, 0}, 5);
    make_scene(&two.scene, (const double[]){0, 0, 0}, 5);
    REQUIRE(prepare(&flat, INSTANCING_OFF, (struct bvh_method){0}, &err), "%s", err.msg);
    REQUIRE(prepare(&two, INSTANCING_ON, (struct bvh_method){0}, &err), "%s", err.msg);
    REQUIRE(flat.flat.normals && flat.flat.tangents && flat.flat.colors && two.flat.tangents);
    uint32_t id = 0;
    for (uint32_t i = 0; i < two.flat.placed_count; i++) {
        const struct flat_instance *placed = &two.flat.instances[i];
        const struct flat_mesh *mesh = &two.flat.meshes[placed->mesh];
        for (uint32_t t = 0; t < mesh->triangle_count; t++, id++)
            for (int corner = 0; corner < 3; corner++)
                check_corner(&flat, &two, i, id, mesh->first_triangle + t, corner,
                             placed->is_mirrored && corner > 0 ? 3 - corner : corner);
    }
    CHECK(id == flat.flat.triangle_count);
    finish(&flat);
    finish(&two);
}

// --- trees ---------------------------------------------------------------------------------------

TEST(leaves_of_instances_are_validated)
{
    enum { COUNT = 1000 };
    static struct bvh_box boxes[COUNT];
    struct arena arena = {0};
    struct bvh bvh;
    struct err err = {0};
    state = 11;
    for (int i = 0; i < COUNT; i++)
        for (int c = 0; c < 3; c++) {
            boxes[i].min[c] = (float)between(-10, 10);
            boxes[i].max[c] = boxes[i].min[c] + (float)between(0, 1);
        }
    const struct bvh_params params = {
        .shape_boxes = boxes, .shape_count = 7, .instance_boxes = boxes, .instance_count = COUNT};
    REQUIRE(bvh_build(&params, &arena, &bvh, &err), "%s", err.msg);
    CHECK(bvh_validate(&bvh, &params, &err), "%s", err.msg);
    for (uint32_t n = 0; n < bvh.node_count; n++)
        for (uint32_t i = 0; i < 4; i++) {
            uint32_t bit = (7 * n + 13 * i) % 32;
            bvh.nodes[n].child[i] ^= 1u << bit;
            CHECK(!bvh_validate(&bvh, &params, &err), "node %u child %u bit %u", n, i, bit);
            bvh.nodes[n].child[i] ^= 1u << bit;
        }
    boxes[3].max[1] = NAN;
    CHECK(!bvh_build(&params, &arena, &bvh, &err) && err.code == ERR_BUG);
    arena_finish(&arena);
}

// The statistics of both levels, computed by hand for one triangle in two instances.
TEST(statistics_count_both_levels)
{
    struct fixture f = {0};
    struct err err = {0};
    make_scene(&f.scene, (const double[]){0, 0, 0}, 1);
    REQUIRE(prepare(&f, INSTANCING_ON, (struct bvh_method){0}, &err), "%s", err.msg);
    const struct bvh_stats *stats = &f.bvh.stats;
    CHECK(stats->node_count == f.bvh.node_count && f.bvh.triangle_count == 341);
    CHECK(stats->sah_cost > 1 && stats->depth >= 3 && stats->stack_entries >= 3);
    CHECK(f.bvh.roots[0] == 0 && f.bvh.roots[1] > 0 && f.bvh.roots[2] == f.bvh.roots[1] + 1);
    f.scene.instance_count = 1;
    REQUIRE(prepare(&f, INSTANCING_ON, (struct bvh_method){0}, &err), "%s", err.msg);
    // The root of the world and its leaf, and the root of the mesh and its triangle.
    CHECK(stats->depth == 2 && stats->stack_entries == 1, "%u", stats->stack_entries);
    CHECK(fabs(stats->sah_cost - 4) < 0.1, "%g", stats->sah_cost);
    finish(&f);
}

int main(int argc, char **argv)
{
    static const struct test_case cases[] = {
        TEST_CASE(instances_are_where_flattened_ones_are),
        TEST_CASE(far_instances_are_where_flattened_ones_are),
        TEST_CASE(ignored_triangles_are_of_one_instance),
        TEST_CASE(corners_carry_the_same),
        TEST_CASE(leaves_of_instances_are_validated),
        TEST_CASE(statistics_count_both_levels),
    };
    return test_run(cases, sizeof cases / sizeof *cases, argc, argv);
}
