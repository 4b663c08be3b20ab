// Tests instances against flattened copies: their pictures must agree.
#include "instanced.h"

// --- pictures ------------------------------------------------------------------------------------

enum { SIZE = 40 };

// Makes balls with normals, smooth or anisotropic, with all kinds of placement, one of them in
// glass, on a floor.
static void fill_scene(struct scene *scene, uint32_t integrator)
{
    static const float floor[1][3][3] = {{{-40, -1.5f, -20}, {0, -1.5f, 60}, {40, -1.5f, -20}}};
    struct random random = {95};
    double m[3][4];
    scene_start(scene, SIZE, SIZE);
    scene->settings.max_bounces = 4;
    scene->settings.integrator = integrator;
    scene->environment = (struct environment){.present = true, .radiance = {0.5f, 0.6f, 0.8f}};
    scene->cameras[0].position[2] = 9;
    add_triangles(scene, floor, 1, 0);
    struct material brushed = scene->materials[0];
    brushed.model = MATERIAL_PRINCIPLED;
    brushed.metallic = 1;
    brushed.roughness = 0.4f;
    brushed.anisotropic = 0.8f;
    struct material glass = scene->materials[0];
    glass.model = MATERIAL_DIELECTRIC;
    glass.ior = 1.5f;
    const uint32_t materials[3] = {SCENE_NONE, add_material(scene, &brushed),
                                   add_material(scene, &glass)};
    uint32_t mesh = blob_mesh(scene, 3000, 0);
    for (int i = 0; i < 9; i++) {
        make_placing((enum placing)(i % TINY), &random, m);
        for (int row = 0; row < 3; row++)
            for (int c = 0; c < 3; c++)
                m[row][c] *= 0.6;
        m[0][3] = 2 * (i % 3) - 2;
        m[1][3] = 2 * (i / 3) - 1.5;
        place_mesh(scene, mesh, m, materials[i % 3]);
    }
    add_sphere(scene, (const double[3]){3, 6, 4}, 0.5,
               add_material(scene, &(struct material){.emission = {60, 60, 60}}));
}

static void render(uint32_t integrator, enum instancing instancing, struct arena *arena,
                   struct film_image *film)
{
    struct setup setup;
    struct err err = {0};
    fill_scene(&setup.scene, integrator);
    OPEN_SETUP_WITH(&setup, .wave = 16384, .instancing = instancing,
                    .aovs = AOV_NORMAL | AOV_NORMAL_GEOMETRIC | AOV_DEPTH | AOV_POSITION | AOV_IDS);
    bool ok = renderer_render(&setup.r, &(struct render_call){.samples = 16}, &err) &&
              renderer_read(&setup.r, arena, film, &err);
    REQUIRE(ok, "%s", err.msg);
    setup_close(&setup);
}

static uint32_t pixels_apart(const float *a, const float *b, uint32_t components, float most)
{
    uint32_t apart = 0;
    for (uint32_t pixel = 0; pixel < SIZE * SIZE; pixel++) {
        bool far = false;
        for (uint32_t c = 0; c < components; c++) {
            float x = a[pixel * components + c], y = b[pixel * components + c];
            far |= x != y && !(fabsf(x - y) <= most * fmaxf(1, fabsf(x)));
        }
        apart += far;
    }
    return apart;
}

// Both renders trace the same paths except for rounding, so only few pixels have a path with
// another end.
static void check_pictures(uint32_t integrator)
{
    struct arena arena = {0};
    struct film_image films[2];
    render(integrator, INSTANCING_OFF, &arena, &films[0]);
    render(integrator, INSTANCING_ON, &arena, &films[1]);
    const struct film_aovs *a = &films[0].aovs, *b = &films[1].aovs;
    const uint32_t pixels = SIZE * SIZE;
    uint32_t color = pixels_apart(films[0].mean[0], films[1].mean[0], 3, 1e-2f);
    // Vertex normals have 16 bits in the space of their mesh. If that space is scaled to a
    // hundredth, fewer bits remain.
    uint32_t normals = pixels_apart(a->normal[0], b->normal[0], 3, 1e-2f) +
                       pixels_apart(a->normal_geometric[0], b->normal_geometric[0], 3, 1e-3f);
    uint32_t places = pixels_apart(a->position[0], b->position[0], 3, 1e-3f) +
                      pixels_apart(a->depth, b->depth, 1, 1e-3f);
    uint32_t ids = 0;
    double sums[2] = {0, 0};
    for (uint32_t pixel = 0; pixel < pixels; pixel++) {
        ids += memcmp(a->ids[pixel], b->ids[pixel], sizeof a->ids[pixel]) != 0;
        for (int i = 0; i < 2; i++)
            sums[i] += (double)films[i].mean[pixel][1];
    }
    printf("  of %u pixels %u differ, %u in normals, %u in places, %u in ids; means %.6g, %.6g\n",
           pixels, color, normals, places, ids, sums[0] / pixels, sums[1] / pixels);
    CHECK(color <= pixels / 100, "%u", color);
    CHECK(normals <= pixels / 200 && places <= pixels / 200 && ids <= pixels / 200, "%u, %u, %u",
          normals, places, ids);
    CHECK(fabs(sums[0] / sums[1] - 1) < 0.003, "means %g and %g", sums[0], sums[1]);
    arena_finish(&arena);
}

TEST(paths_see_what_flattened_instances_show)
{
    check_pictures(INTEGRATOR_PATH);
}

TEST(whitted_and_ao_see_the_same)
{
    check_pictures(INTEGRATOR_WHITTED);
    check_pictures(INTEGRATOR_AO);
}

TEST_MAIN(TEST_CASE(paths_see_what_flattened_instances_show),
          TEST_CASE(whitted_and_ao_see_the_same))
