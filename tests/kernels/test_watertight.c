// Tests exact requirements of traversal: no ray passes through a closed surface, the lowest id is
// reported among equal distances, and an independent library agrees on scanned meshes.
#include "../bench/bench.h"
#include "traversal_judge.h"
#include "traversal_scenes.h"

enum { RAYS = 16384 };

static struct probe_ray rays[RAYS];
static struct probe_hit hits[RAYS];

static void trace(struct renderer *r, enum kernel_id kernel, uint32_t count)
{
    struct err err = {0};
    bool complete = false;
    double ms;
    for (uint32_t first = 0; first < count; first += r->plan.wave_slots) {
        uint32_t part = count - first < r->plan.wave_slots ? count - first : r->plan.wave_slots;
        bool ok =
            ray_probe_trace(r, kernel, rays + first, part, hits + first, &ms, &complete, &err);
        REQUIRE(ok && complete, "%s", ok ? "a ray ran out of its budget" : err.msg);
    }
}

static uint32_t count_misses(uint32_t count)
{
    uint32_t misses = 0;
    for (uint32_t i = 0; i < count; i++)
        misses += hits[i].primitive == NO_PRIMITIVE;
    return misses;
}

// --- closed surfaces -----------------------------------------------------------------------------

// Traces rays from about `center` towards vertices and edges of setup->scene; none may escape.
// Shadow rays reach twice as far.
static void check_closed(const char *name, struct setup *setup, struct bvh_method bvh,
                         const double center[3], double inner_radius)
{
    setup->scene.materials[0].emission[0] = 1; // so that there are shadow rays
    OPEN_SETUP_WITH(setup, .wave = RAYS, .bvh = bvh);
    const struct flat_scene *flat = &setup->r.flat;
    struct random random = {11};
    for (uint32_t i = 0; i < RAYS; i++) {
        const struct flat_triangle *triangle = &flat->triangles[i % flat->triangle_count];
        uint32_t edge = random_u32(&random) % 3;
        // Every other ray is aimed at a vertex, the others at a random point of an edge.
        double along = i % 2 == 0 ? 0 : random_unit(&random);
        float offset[3], target[3];
        random_direction(&random, offset);
        for (int c = 0; c < 3; c++) {
            rays[i].origin[c] =
                (float)(center[c] - flat->origin[c] + inner_radius * (double)offset[c]);
            target[c] = (float)((1 - along) * (double)triangle->v[edge][c] +
                                along * (double)triangle->v[(edge + 1) % 3][c]);
        }
        aim(rays[i].origin, target, rays[i].direction);
    }
    trace(&setup->r, KERNEL_intersect_closest, RAYS);
    CHECK(count_misses(RAYS) == 0, "%s: %u of %u rays got out", name, count_misses(RAYS), RAYS);

    double diagonal[3];
    subtract(flat->bounds_max, flat->bounds_min, diagonal);
    for (uint32_t i = 0; i < RAYS; i++)
        for (int c = 0; c < 3; c++)
            rays[i].direction[c] *= (float)(2 * vec3_norm(diagonal));
    trace(&setup->r, KERNEL_intersect_shadow, RAYS);
    CHECK(count_misses(RAYS) == 0, "%s: %u of %u shadow rays got out", name, count_misses(RAYS),
          RAYS);
    setup_close(setup);
}

TEST(nothing_leaves_a_blob)
{
    // A scene of scale 1 at coordinates up to 32 is not moved to the origin when it is loaded.
    static const struct {
        const char *name;
        double scale, center[3];
        struct bvh_method bvh;
    } blobs[] = {{"blob", 1, {0, 0, 0}, {0}},
                 {"blob of 1e-4", 1e-4, {0, 0, 0}, {0}},
                 {"blob of 1e5", 1e5, {0, 0, 0}, {0}},
                 {"blob off centre", 1, {20, -13, 7}, {0}},
                 {"blob, float nodes", 1, {0, 0, 0}, {BVH_SPLIT_SAH, BVH_FLOAT}},
                 {"blob off centre, by mean", 1, {20, -13, 7}, {BVH_SPLIT_MEAN, BVH_FLOAT}}};
    for (size_t i = 0; i < sizeof blobs / sizeof *blobs; i++) {
        struct setup setup;
        scene_start(&setup.scene, 8, 8);
        REQUIRE(add_blob(&setup.scene, 20000, blobs[i].scale, blobs[i].center), "out of memory");
        check_closed(blobs[i].name, &setup, blobs[i].bvh, blobs[i].center, 0.3 * blobs[i].scale);
    }
}

// Adds a cube with corners at -1 and 1.
static void add_cube(struct scene *scene)
{
    float triangles[12][3][3];
    for (int face = 0; face < 6; face++) {
        int axis = face / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
        for (int corner = 0; corner < 6; corner++) {
            // Corners 0 1 3 and 0 3 2 of a square.
            static const int order[6] = {0, 1, 3, 0, 3, 2};
            float *vertex = triangles[2 * face + corner / 3][corner % 3];
            vertex[axis] = face % 2 ? 1.0f : -1.0f;
            vertex[u] = order[corner] & 1 ? 1.0f : -1.0f;
            vertex[v] = order[corner] & 2 ? 1.0f : -1.0f;
        }
    }
    add_triangles(scene, (const float(*)[3][3])triangles, 12, 0);
}

TEST(nothing_leaves_a_cube)
{
    static const double center[3] = {0, 0, 0};
    // From the exact centre, the diagonals and the middles of edges are exact.
    static const double radii[] = {0.5, 0};
    for (int i = 0; i < 4; i++) {
        enum bvh_format format = i < 2 ? BVH_QUANTISED : BVH_FLOAT;
        struct setup setup;
        scene_start(&setup.scene, 8, 8);
        add_cube(&setup.scene);
        check_closed("cube", &setup, (struct bvh_method){BVH_SPLIT_SAH, format}, center,
                     radii[i % 2]);
    }
}

// Paths that start next to an edge hit the adjoining wall, however near it is.
TEST(no_light_enters_a_closed_cube)
{
    struct setup setup;
    struct arena arena = {0};
    struct film_image image = {0};
    struct err err = {0};
    scene_start(&setup.scene, 48, 48);
    setup.scene.environment = (struct environment){.present = true, .radiance = {1e3, 1e3, 1e3}};
    setup.scene.cameras[0].position[2] = 0.9;
    add_cube(&setup.scene);
    OPEN_SETUP(&setup, RAYS);
    bool ok = renderer_render(&setup.r, &(struct render_call){.samples = 64}, &err) &&
              renderer_read(&setup.r, &arena, &image, &err);
    CHECK(ok, "%s", err.msg);
    uint32_t lit = 0;
    for (uint32_t pixel = 0; ok && pixel < 48 * 48; pixel++)
        lit += image.mean[pixel][0] != 0.0f;
    CHECK(lit == 0, "%u of %u pixels", lit, 48 * 48);
    arena_finish(&arena);
    setup_close(&setup);
}

// --- surfaces in one plane -----------------------------------------------------------------------

// Adds two squares with sides of 2 `size`, rotated by a quarter turn, with the same corners.
static void add_coplanar_squares(struct scene *scene, double size, const double center[3],
                                 const double u[3], const double v[3])
{
    static const double corners[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    float triangles[4][3][3];
    for (int i = 0; i < 12; i++) {
        // Diagonals 0 2 and 1 3.
        static const int order[12] = {0, 1, 2, 0, 2, 3, 1, 2, 3, 1, 3, 0};
        const double *corner = corners[order[i]];
        for (int c = 0; c < 3; c++)
            triangles[i / 3][i % 3][c] =
                (float)(center[c] + size * (corner[0] * u[c] + corner[1] * v[c]));
    }
    add_triangles(scene, (const float(*)[3][3])triangles, 4, 0);
}

// Two surfaces in one plane look like one (docs/verification.md, C11): under a constant sky each
// sample is exactly the reflectance, 0.5.
TEST(coplanar_surfaces_do_not_shade_each_other)
{
    static const struct {
        double size, center[3], u[3], v[3];
    } planes[] = {
        {2, {0, 0, 0}, {1, 0, 0}, {0, 0, 1}},
        {2, {0, 0.01, 0}, {1, 0, 0}, {0, 0, 1}},
        {1e-3, {0, 1e-4, 0}, {1, 0, 0}, {0, 0, 1}},
        {1e4, {0, 0.1, 0}, {1, 0, 0}, {0, 0, 1}},
        {2, {0.3, 0.02, -0.2}, {0.8, 0.6, 0}, {-0.36, 0.48, 0.8}},
        {1e3, {30, 2, -20}, {0.8, 0.6, 0}, {-0.36, 0.48, 0.8}},
    };
    for (size_t i = 0; i < sizeof planes / sizeof planes[0]; i++) {
        struct setup setup;
        struct arena arena = {0};
        struct film_image image = {0};
        struct err err = {0};
        scene_start(&setup.scene, 32, 32);
        setup.scene.environment = (struct environment){.present = true, .radiance = {1, 1, 1}};
        add_coplanar_squares(&setup.scene, planes[i].size, planes[i].center, planes[i].u,
                             planes[i].v);
        double normal[3];
        vec3_cross(planes[i].u, planes[i].v, normal);
        struct camera *camera = &setup.scene.cameras[0];
        for (int c = 0; c < 3; c++) {
            camera->position[c] = planes[i].center[c] + planes[i].size * normal[c];
            camera->direction[c] = -normal[c];
            camera->up[c] = planes[i].u[c];
        }
        camera->fov_y = 0.8;
        OPEN_SETUP(&setup, RAYS);
        bool ok = renderer_render(&setup.r, &(struct render_call){.samples = 16}, &err) &&
                  renderer_read(&setup.r, &arena, &image, &err);
        CHECK(ok, "%s", err.msg);
        uint32_t wrong = 0;
        for (uint32_t pixel = 0; ok && pixel < 32 * 32; pixel++)
            wrong += fabsf(image.mean[pixel][0] - 0.5f) > 1e-6f;
        CHECK(wrong == 0, "plane %zu: %u of 1024 pixels", i, wrong);
        arena_finish(&arena);
        setup_close(&setup);
    }
}

// --- equals --------------------------------------------------------------------------------------

// Every triangle occurs twice, with the copies far from the originals in the list. The original's
// id is reported for any tree.
TEST(the_lower_of_two_equal_triangles_wins)
{
    struct setup setup;
    static const double zero[3] = {0, 0, 0};
    enum { COUNT = 1000 };
    scene_start(&setup.scene, 8, 8);
    add_soup(&setup.scene, COUNT, 1, 0.2, zero, 12);
    add_soup(&setup.scene, COUNT, 1, 0.2, zero, 12);
    OPEN_SETUP(&setup, RAYS);
    REQUIRE(setup.r.flat.triangle_count == 2 * COUNT, "%u", setup.r.flat.triangle_count);
    random_closest_rays(&setup.r.flat, RAYS, 13, rays);
    trace(&setup.r, KERNEL_intersect_closest, RAYS);
    uint32_t higher = 0;
    for (uint32_t i = 0; i < RAYS; i++)
        higher += hits[i].primitive != NO_PRIMITIVE && hits[i].primitive >= COUNT;
    CHECK(higher == 0, "%u of %u", higher, RAYS - count_misses(RAYS));
    CHECK(count_misses(RAYS) < RAYS / 2, "%u misses", count_misses(RAYS));
    setup_close(&setup);
}

// Spheres and discs occur twice, and discs lie in a triangle: triangles precede shapes, then the
// lower shape is reported.
TEST(triangles_win_against_equal_shapes)
{
    struct setup setup;
    static const float floor[1][3][3] = {{{-8, 0, -8}, {8, 0, -8}, {0, 0, 8}}};
    scene_start(&setup.scene, 8, 8);
    for (int i = 0; i < 2; i++) {
        add_sphere(&setup.scene, (double[3]){0.25, 0.5, -0.5}, 0.25, 0);
        add_disc(&setup.scene, (double[3]){-0.5, 0.5, 0}, (double[3]){1, 1, 0}, 0.5, 0);
        add_disc(&setup.scene, (double[3]){0, 0, 0}, (double[3]){0, 1, 0}, 0.5, 0);
    }
    add_triangles(&setup.scene, floor, 1, 0);
    OPEN_SETUP(&setup, RAYS);
    struct random random = {14};
    for (uint32_t i = 0; i < RAYS; i++) {
        // The rays go straight down, so all distances to the floor are exact.
        rays[i] = (struct probe_ray){.origin = {(float)random_between(&random, -1, 1), 2,
                                                (float)random_between(&random, -1, 1)},
                                     .direction = {0, -1, 0}};
    }
    trace(&setup.r, KERNEL_intersect_closest, RAYS);
    uint32_t seen[6] = {0}, floor_hits = 0;
    for (uint32_t i = 0; i < RAYS; i++) {
        uint32_t primitive = hits[i].primitive;
        CHECK(primitive == 0 || (primitive & PRIMITIVE_SHAPE && (primitive & 7u) < 6), "0x%x",
              primitive);
        floor_hits += primitive == 0;
        if (primitive & PRIMITIVE_SHAPE && (primitive & 7u) < 6)
            seen[primitive & 7u]++;
    }
    CHECK(floor_hits && seen[0] && seen[1], "floor %u, sphere %u, disc %u", floor_hits, seen[0],
          seen[1]);
    for (int i = 2; i < 6; i++)
        CHECK(seen[i] == 0, "shape %d was seen %u times", i, seen[i]);
    setup_close(&setup);
}

// --- Embree --------------------------------------------------------------------------------------

// Embree computes in single precision, too, and here without its robust mode. If the two differ,
// the judge must find the kernel's result correct.
static void compare_with_embree(const char *name)
{
    struct setup setup;
    struct err err = {0};
    static struct probe_hit embree_hits[RAYS];
    if (!load_mesh_file(name, &setup.scene, &err))
        SKIP("%s (LAMPYRIS_DATA says where data is)", err.msg);
    OPEN_SETUP(&setup, RAYS);
    struct yardstick *embree = yardstick_create(&setup.r.flat, 0);
    if (!embree) {
        setup_close(&setup);
        SKIP("built without Embree");
    }
    random_closest_rays(&setup.r.flat, RAYS, 15, rays);
    trace(&setup.r, KERNEL_intersect_closest, RAYS);
    yardstick_trace(embree, false, rays, RAYS, embree_hits);
    uint32_t differ = 0, delicate = 0, wrong = 0;
    for (uint32_t i = 0; i < RAYS; i++) {
        bool ours = hits[i].primitive != NO_PRIMITIVE;
        bool theirs = embree_hits[i].primitive != NO_PRIMITIVE;
        if (ours == theirs &&
            (!ours || fabsf(hits[i].t - embree_hits[i].t) <= 1e-4f * embree_hits[i].t))
            continue;
        differ += !ray_is_delicate(i);
        delicate += ray_is_delicate(i);
        wrong += !judge_closest(&setup.r.flat, &rays[i], &hits[i]);
    }
    printf("  %s: %u of %u differ from Embree, and %u delicate ones\n", name, differ, RAYS,
           delicate);
    CHECK(wrong == 0, "%s: %u", name, wrong);
    CHECK(differ <= RAYS / 4096, "%s: %u", name, differ);
    yardstick_destroy(embree);
    setup_close(&setup);
}

TEST(embree_agrees_on_nefertiti)
{
    compare_with_embree("nefertiti.obj");
}

TEST(embree_agrees_on_the_bunny)
{
    compare_with_embree("stanford-bunny.obj");
}

TEST_MAIN(TEST_CASE(nothing_leaves_a_blob), TEST_CASE(nothing_leaves_a_cube),
          TEST_CASE(no_light_enters_a_closed_cube),
          TEST_CASE(coplanar_surfaces_do_not_shade_each_other),
          TEST_CASE(the_lower_of_two_equal_triangles_wins),
          TEST_CASE(triangles_win_against_equal_shapes), TEST_CASE(embree_agrees_on_nefertiti),
          TEST_CASE(embree_agrees_on_the_bunny))
