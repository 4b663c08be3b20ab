// Tests traversal through instances against the CPU reference in double precision, and exact
// requirements: equal distances, surfaces that rays leave, closed surfaces, and bits that must not
// change.
//
// If kernel and reference disagree, traversal_judge.h decides whether rounding explains it,
// including that of the ray's transformation to the instance's space.
#include "instanced.h"
#include "traversal_judge.h"

enum { RAYS = 50000, INSTANCES = 48 };
// How often rounding may decide; for rays at edges and corners more often.
enum { MOST_EXPLAINED = RAYS / 2048, MOST_DELICATE = RAYS / 16 };

static struct probe_ray rays[RAYS];
static struct probe_hit hits[2][RAYS];

static void trace(struct renderer *r, enum kernel_id kernel, struct probe_hit *out, uint32_t count)
{
    struct err err = {0};
    bool complete = true;
    double ms;
    for (uint32_t first = 0; first < count; first += r->plan.wave_slots) {
        uint32_t part = count - first < r->plan.wave_slots ? count - first : r->plan.wave_slots;
        bool ok = ray_probe_trace(r, kernel, rays + first, part, out + first, &ms, &complete, &err);
        REQUIRE(ok && complete, "%s", ok ? "a ray ran out of its budget" : err.msg);
    }
}

// --- random instances ----------------------------------------------------------------------------

// Makes balls, cubes and single triangles among triangles in world space, within about 5 m.
static void fill_scene(struct scene *scene)
{
    struct random random = {41};
    double m[3][4];
    scene_start(scene, 8, 8);
    add_soup(scene, 200, 8, 1, (const double[3]){0, 0, 0}, 42);
    const uint32_t meshes[3] = {blob_mesh(scene, 2000, 0), cube_mesh(scene, 3, 0),
                                pile_mesh(scene, 1, 0)};
    for (uint32_t i = 0; i < INSTANCES; i++) {
        make_placing((enum placing)(i / 3 % HUGE_SCALE), &random, m);
        for (int c = 0; c < 3; c++)
            m[c][3] = random_between(&random, -4, 4);
        place_mesh(scene, meshes[i % 3], m, SCENE_NONE);
    }
    make_placing(HUGE_SCALE, &random, m);
    place_mesh(scene, meshes[2], m, SCENE_NONE);
}

// Returns a point on an edge of an instance's triangle, one of its corners, or a point inside.
static void random_target(const struct flat_scene *flat, struct random *random, float target[3])
{
    const struct flat_instance *instance =
        &flat->instances[random_u32(random) % flat->placed_count];
    const struct flat_mesh *mesh = &flat->meshes[instance->mesh];
    uint32_t index = mesh->first_triangle + random_u32(random) % mesh->triangle_count;
    double weight[3] = {1, 0, 0}, point[3] = {0};
    uint32_t kind = random_u32(random) % 3;
    if (kind > 0)
        weight[1] = random_unit(random);
    if (kind > 1)
        weight[2] = random_unit(random) * (1 - weight[1]);
    weight[0] -= weight[1] + weight[2];
    for (int i = 0; i < 3; i++)
        for (int c = 0; c < 3; c++)
            point[c] += weight[i] * (double)flat->triangles[index].v[i][c];
    to_world(instance, point, target);
}

// Makes rays in random directions, along axes, and towards instances, in alternation.
static void random_rays(const struct flat_scene *flat, bool segments)
{
    struct random random = {43};
    for (uint32_t i = 0; i < RAYS; i++) {
        float target[3];
        rays[i] = (struct probe_ray){0};
        for (int c = 0; c < 3; c++)
            rays[i].origin[c] = (float)random_between(&random, -6, 6);
        random_direction(&random, rays[i].direction);
        if (i % 4 == 1) {
            memset(rays[i].direction, 0, sizeof rays[i].direction);
            rays[i].direction[random_u32(&random) % 3] = i % 8 == 1 ? 1.0f : -1.0f;
        }
        random_target(flat, &random, target);
        if (i % 4 > 1)
            aim(rays[i].origin, target, rays[i].direction);
        for (int c = 0; c < 3 && segments; c++)
            rays[i].direction[c] *= 3;
    }
}

static void compare(const struct renderer *r, bool shadow)
{
    struct arena arena = {0};
    struct reference reference;
    uint32_t explained[2] = {0}, wrong = 0, of_instances = 0, found = 0;
    REQUIRE(reference_create(r, &arena, &reference), "out of memory");
    for (uint32_t i = 0; i < RAYS; i++) {
        const struct probe_hit *hit = &hits[0][i];
        const struct bvh_ray ray = reference_ray(&rays[i], shadow ? 1 : INFINITY);
        bool occluded = hit->primitive != NO_PRIMITIVE;
        found += occluded;
        of_instances += occluded && hit->instance != NO_INSTANCE;
        if (shadow ? occluded == bvh_trace_any(&reference.scene, &ray)
                   : reference_agrees(&reference, &ray, hit, 10))
            continue;
        bool right = shadow ? judge_occluded(&r->flat, &rays[i], occluded)
                            : judge_closest(&r->flat, &rays[i], hit);
        explained[i % 4 > 1] += right;
        wrong += !right;
        if (!right)
            fprintf(stderr, "ray %u: 0x%x of %u at %g\n", i, hit->primitive, hit->instance,
                    (double)hit->t);
    }
    printf("  %s: %u of %u hit; %u differ by rounding, and %u delicate ones\n",
           shadow ? "shadow" : "closest", found, RAYS, explained[0], explained[1]);
    CHECK(wrong == 0, "%u wrong results", wrong);
    CHECK(explained[0] <= MOST_EXPLAINED && explained[1] <= MOST_DELICATE, "%u and %u of %u",
          explained[0], explained[1], RAYS);
    CHECK(shadow || of_instances > RAYS / 4, "%u hits of instances test little", of_instances);
    arena_finish(&arena);
}

static const struct variant {
    const char *name;
    bool no_texel, no_ballot;
    struct bvh_method bvh;
} variants[] = {
    {"texel reads, ballot", false, false, {0}},
    {"storage reads, no ballot", true, true, {0}},
    {"float nodes", false, false, {BVH_SPLIT_MEDIAN, BVH_FLOAT}},
};

static void check_random_instances(enum kernel_id kernel)
{
    bool shadow = kernel == KERNEL_intersect_shadow;
    for (size_t v = 0; v < sizeof variants / sizeof *variants; v++) {
        struct gpu gpu;
        struct renderer r;
        struct scene scene;
        struct err err = {0};
        fill_scene(&scene);
        add_sphere(&scene, (const double[3]){900, 0, 0}, 1,
                   add_material(&scene, &(struct material){.emission = {1, 1, 1}}));
        OPEN_GPU(&gpu,
                 .limits = {.no_texel = variants[v].no_texel, .no_ballot = variants[v].no_ballot});
        const struct renderer_params params = {.gpu = &gpu,
                                               .scene = &scene,
                                               .wave = 16384,
                                               .bvh = variants[v].bvh,
                                               .instancing = INSTANCING_ON};
        REQUIRE(renderer_create(&params, &r, &err), "%s", err.msg);
        CHECK(r.flat.placed_count == INSTANCES + 2, "%u instances", r.flat.placed_count);
        random_rays(&r.flat, shadow);
        trace(&r, kernel, hits[v > 0], RAYS);
        if (v == 0)
            compare(&r, shadow);
        uint32_t differ = 0;
        for (uint32_t i = 0; i < RAYS && v > 0; i++)
            differ += hits[0][i].primitive != hits[1][i].primitive ||
                      (hits[0][i].primitive != NO_PRIMITIVE &&
                       memcmp(&hits[0][i], &hits[1][i], sizeof hits[0][i]) != 0);
        CHECK(differ == 0, "%s: %u of %u differ", variants[v].name, differ, RAYS);
        renderer_finish(&r);
        scene_finish(&scene);
        gpu_close(&gpu);
    }
}

TEST(closest_hits_agree_with_the_reference)
{
    check_random_instances(KERNEL_intersect_closest);
}

TEST(shadow_rays_agree_with_the_reference)
{
    check_random_instances(KERNEL_intersect_shadow);
}

// --- ties, and what a ray leaves -----------------------------------------------------------------

// If instances are at the same place, the first one is visible. A ray that leaves one of its
// triangles hits the same triangle of the others, but never its own.
TEST(an_instance_is_left_and_its_twin_is_met)
{
    enum { COUNT = 4096 };
    struct setup setup;
    struct random random = {51};
    double m[3][4];
    scene_start(&setup.scene, 8, 8);
    make_placing(SHEARED, &random, m);
    uint32_t mesh = blob_mesh(&setup.scene, 2000, 0);
    for (int i = 0; i < 3; i++)
        place_mesh(&setup.scene, mesh, m, SCENE_NONE);
    OPEN_SETUP_WITH(&setup, .wave = COUNT, .instancing = INSTANCING_ON);
    const struct flat_scene *flat = &setup.r.flat;
    for (uint32_t i = 0; i < COUNT; i++) {
        float target[3];
        rays[i] = (struct probe_ray){0};
        random_direction(&random, rays[i].origin);
        for (int c = 0; c < 3; c++)
            rays[i].origin[c] *= 8;
        random_target(flat, &random, target);
        aim(rays[i].origin, target, rays[i].direction);
    }
    trace(&setup.r, KERNEL_intersect_closest, hits[0], COUNT);
    uint32_t others = 0, own = 0, found = 0, twins = 0;
    for (uint32_t i = 0; i < COUNT; i++) {
        const struct probe_hit *hit = &hits[0][i];
        others += hit->primitive != NO_PRIMITIVE && hit->instance != 0;
        rays[i].leaves = hit->primitive != NO_PRIMITIVE;
        rays[i].from = hit->primitive;
        rays[i].from_instance = 0;
    }
    CHECK(others == 0, "%u of the others", others);
    trace(&setup.r, KERNEL_intersect_closest, hits[1], COUNT);
    for (uint32_t i = 0; i < COUNT; i++) {
        const struct probe_hit *hit = &hits[1][i];
        if (!rays[i].leaves)
            continue;
        found++;
        own += hit->primitive == rays[i].from && hit->instance == 0;
        twins += hit->primitive == rays[i].from && hit->instance == 1;
    }
    CHECK(own == 0, "%u of %u are met again", own, found);
    CHECK(found > COUNT / 2 && twins > found / 2, "%u of %u meet the twin", twins, found);
    setup_close(&setup);
}

// --- pictures ------------------------------------------------------------------------------------

// Renders a ball of 2 m under a constant sky, or a cube from inside. With `far`, the scene is so
// large that it stays far from the origin.
static void render_convex(enum placing placing, const double center[3], bool far, bool inside,
                          struct arena *arena, struct film_image *image)
{
    struct setup setup;
    struct err err = {0};
    struct random random = {61 + (uint64_t)placing};
    double m[3][4], scales[2];
    scene_start(&setup.scene, 32, 32);
    setup.scene.environment = (struct environment){.present = true, .radiance = {1, 1, 1}};
    setup.scene.settings.max_bounces = inside ? 4 : 1;
    make_placing(placing, &random, m);
    placing_scales(placing, scales);
    for (int c = 0; c < 3; c++)
        m[c][3] = (far ? 1 : scales[1]) * center[c];
    uint32_t mesh = inside ? cube_mesh(&setup.scene, 4, 0) : ball_mesh(&setup.scene, 2, 0);
    place_mesh(&setup.scene, mesh, m, SCENE_NONE);
    if (far)
        add_anchor(&setup.scene, (const double[3]){-center[0], -center[1], -center[2]});
    struct camera *camera = &setup.scene.cameras[0];
    // Everything that the sky illuminates is within the ball of the least radius.
    double distance = inside ? 0 : 4 * scales[1];
    float towards[3];
    random_direction(&random, towards);
    for (int c = 0; c < 3; c++) {
        camera->direction[c] = (double)towards[c];
        camera->position[c] = m[c][3] - distance * (double)towards[c];
        camera->up[c] = c == 1;
    }
    camera->fov_y = inside ? 1.5 : 0.9 * scales[0] / distance;
    OPEN_SETUP_WITH(&setup, .wave = 16384, .instancing = INSTANCING_ON);
    CHECK(setup.r.flat.placed_count == (far ? 2 : 1), "%u instances", setup.r.flat.placed_count);
    // If the distance exceeds 4096 times the size, coordinates are relative to the camera.
    double origin = setup.r.flat.origin[0];
    CHECK(!far || origin == 0 || fabs(origin - m[0][3]) <= distance + 2 * scales[1], "moved to %g",
          origin);
    bool ok = renderer_render(&setup.r, &(struct render_call){.samples = 16}, &err) &&
              renderer_read(&setup.r, arena, image, &err);
    REQUIRE(ok, "%s", err.msg);
    setup_close(&setup);
}

static void check_convex(bool inside)
{
    static const struct {
        double center[3];
        bool far;
    } places[] = {{{0, 0, 0}, false},
                  {{20, -13, 7}, false},
                  {{20, -13, 7}, true},
                  {{148376, 1234, -223423}, true}};
    const float expected = inside ? 0 : 0.5f;
    for (int i = 0; i < 4 * PLACINGS; i++) {
        enum placing placing = (enum placing)(i / 4);
        int place = i % 4;
        // If the spacing of coordinates is not small relative to the body, the origin of a ray is
        // not known accurately enough to be inside its edges.
        if ((inside && places[place].far) ||
            (place == 3 && (placing == TINY || placing == SQUASHED)))
            continue;
        struct arena arena = {0};
        struct film_image image;
        render_convex(placing, places[place].center, places[place].far, inside, &arena, &image);
        uint32_t wrong = 0;
        for (uint32_t pixel = 0; pixel < 32 * 32; pixel++)
            wrong += fabsf(image.mean[pixel][0] - expected) > 1e-6f;
        CHECK(wrong == 0, "%s, place %d: %u of 1024 pixels", placing_name(placing), place, wrong);
        arena_finish(&arena);
    }
}

// A convex instance receives all light of a constant sky: none of its rays may hit it again.
TEST(no_ray_comes_back_to_a_convex_instance)
{
    check_convex(false);
}

TEST(no_light_enters_a_closed_instance)
{
    check_convex(true);
}

// --- bits ----------------------------------------------------------------------------------------

static void render(struct scene *scene, const struct gpu_limit_overrides *limits,
                   struct renderer_params params, struct arena *arena, struct film_image *film,
                   uint64_t *suspended)
{
    struct gpu gpu;
    struct renderer r;
    struct err err = {0};
    OPEN_GPU(&gpu, .limits = *limits, .validation = params.wave < 4096);
    params.gpu = &gpu;
    params.scene = scene;
    params.instancing = INSTANCING_ON;
    bool ok = renderer_create(&params, &r, &err) &&
              renderer_render(&r, &(struct render_call){.samples = 4}, &err) &&
              renderer_read(&r, arena, film, &err);
    REQUIRE(ok, "%s", err.msg);
    CHECK(r.flat.placed_count > 0, "no instances");
    *suspended = r.stats.suspended;
    CHECK(gpu.validation_messages == 0, "%u", gpu.validation_messages);
    renderer_finish(&r);
    gpu_close(&gpu);
}

static void check_same(const char *name, const struct film_image *a, const struct film_image *b)
{
    size_t bytes = (size_t)a->width * a->height * sizeof *a->mean;
    CHECK(memcmp(a->half_a, b->half_a, bytes) == 0 && memcmp(a->half_b, b->half_b, bytes) == 0,
          "%s: the pictures differ", name);
}

// Glass, a surface with opacity, and others, in front of a sky and lit by a small light.
static void fill_picture(struct scene *scene, uint32_t integrator)
{
    double m[3][4];
    struct random random = {71};
    fill_scene(scene);
    scene->settings.width = scene->settings.height = 16;
    scene->settings.integrator = integrator;
    scene->settings.max_bounces = 4;
    scene->environment = (struct environment){.present = true, .radiance = {1, 1, 1}};
    struct material glass = scene->materials[0];
    glass.model = MATERIAL_DIELECTRIC;
    glass.ior = 1.5f;
    struct material half = scene->materials[0];
    half.opacity = 0.5f;
    const uint32_t materials[3] = {add_material(scene, &glass), add_material(scene, &half),
                                   SCENE_NONE};
    for (uint32_t i = 0; i < 12; i++) {
        make_placing(MIRRORED, &random, m);
        for (int c = 0; c < 3; c++)
            m[c][3] = random_between(&random, -2, 2);
        place_mesh(scene, 1, m, materials[i % 3]);
    }
    add_sphere(scene, (const double[3]){2, 5, 2}, 0.2,
               add_material(scene, &(struct material){.emission = {20, 20, 20}}));
}

TEST(nothing_changes_the_bits)
{
    static const struct {
        const char *name;
        struct gpu_limit_overrides limits;
        struct renderer_params params;
    } ways[] = {
        {"as it is", {0}, {.wave = 4096}},
        {"small waves", {0}, {.wave = 256, .workgroup = 32}},
        {"storage reads, no ballot",
         {.no_texel = true, .no_ballot = true},
         {.wave = 4096, .merge_classes = true}},
        {"everything, another tree",
         {0},
         {.wave = 4096, .compile_all = true, .bvh = {BVH_SPLIT_MEAN, BVH_FLOAT}}},
        {"leaves of 8", {0}, {.wave = 4096, .bvh = {BVH_SPLIT_MIDDLE, .max_leaf = 8}}},
    };
    static const uint32_t integrators[] = {INTEGRATOR_PATH, INTEGRATOR_AO, INTEGRATOR_WHITTED};
    for (size_t i = 0; i < 3; i++) {
        struct arena arena = {0};
        struct film_image first = {0};
        for (size_t w = 0; w < (i == 0 ? sizeof ways / sizeof *ways : 2); w++) {
            struct scene scene;
            struct film_image film;
            uint64_t suspended;
            fill_picture(&scene, integrators[i]);
            render(&scene, &ways[w].limits, ways[w].params, &arena, &film, &suspended);
            if (w == 0)
                first = film;
            check_same(ways[w].name, &first, &film);
            scene_finish(&scene);
        }
        arena_finish(&arena);
    }
}

// There are more triangles at one place than a dispatch has steps. Traversals are suspended inside
// an instance, continue later, and find the same as for one triangle.
TEST(what_is_suspended_goes_on_in_its_instance)
{
    static const uint32_t counts[2] = {1, 20000};
    struct arena arena = {0};
    struct film_image films[2];
    for (int i = 0; i < 2; i++) {
        struct scene scene;
        struct random random = {81};
        uint64_t suspended;
        double m[3][4];
        scene_start(&scene, 16, 16);
        scene.environment = (struct environment){.present = true, .radiance = {1, 1, 1}};
        uint32_t mesh = pile_mesh(&scene, counts[i], 0);
        for (int k = 0; k < 2; k++) {
            make_placing(k ? MIRRORED : SHEARED, &random, m);
            place_mesh(&scene, mesh, m, SCENE_NONE);
        }
        render(&scene, &(struct gpu_limit_overrides){0}, (struct renderer_params){.wave = 1024},
               &arena, &films[i], &suspended);
        CHECK((suspended > 0) == (i == 1), "%u triangles: %u continuations", counts[i],
              (unsigned)suspended);
        scene_finish(&scene);
    }
    check_same("pile", &films[0], &films[1]);
    arena_finish(&arena);
}

TEST_MAIN(TEST_CASE(closest_hits_agree_with_the_reference),
          TEST_CASE(shadow_rays_agree_with_the_reference),
          TEST_CASE(an_instance_is_left_and_its_twin_is_met),
          TEST_CASE(no_ray_comes_back_to_a_convex_instance),
          TEST_CASE(no_light_enters_a_closed_instance), TEST_CASE(nothing_changes_the_bits),
          TEST_CASE(what_is_suspended_goes_on_in_its_instance))
