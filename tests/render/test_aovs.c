// Tests the AOVs: their values where they are known, that parts of the light add up to the whole,
// and that AOVs change nothing else and depend on nothing that the radiance does not depend on.
#include "base/maths.h"
#include "render/wave.h"
#include "render_fixture.h"
#include "shared/aov.h"
#include <math.h>

enum { SIZE = 32, PIXELS = SIZE * SIZE };
#define ALL (AOV_END - 1u)

// --- the first surface ---------------------------------------------------------------------------

enum object { NOTHING, VEIL, WALL, MIRROR, GLASS };

struct hit {
    enum object object;
    double t, position[3], normal[3];
    bool unsure; // next to an edge
};

static void take(struct hit *hit, enum object object, double t, const double d[3],
                 const double normal[3], double margin)
{
    hit->unsure |= fabs(margin) < 1e-3;
    if (margin <= 0 || (hit->object && hit->t < t))
        return;
    hit->object = object;
    hit->t = t;
    for (int c = 0; c < 3; c++) {
        hit->position[c] = (c == 2 ? 4 : 0) + t * d[c];
        hit->normal[c] = normal[c];
    }
}

// Returns the hit in a pixel of scenes/aovs.json, about (1000, 2000, -500), without the veil.
static struct hit expect(uint32_t pixel)
{
    struct hit hit = {0};
    double d[3] = {(pixel % SIZE + 0.5) / SIZE - 0.5, 0.5 - (pixel / SIZE + 0.5) / SIZE, -1};
    double norm = sqrt(vec3_dot(d, d));
    for (int c = 0; c < 3; c++)
        d[c] /= norm;
    const double up[3] = {0, 0, 1}, mirror[3] = {0.6, 0, 0.8};
    double t = -5 / d[2], x = t * d[0], y = t * d[1];
    take(&hit, WALL, t, d, up, fmin(-x, fmin(x + 3, 3 - fabs(y))));
    const double to_mirror[3] = {0.9, -0.9, -4};
    t = vec3_dot(to_mirror, mirror) / vec3_dot(d, mirror);
    double off[3], square = 0;
    for (int c = 0; c < 3; c++) {
        off[c] = t * d[c] - to_mirror[c];
        square += off[c] * off[c];
    }
    take(&hit, MIRROR, t, d, mirror, 0.25 - square);
    const double to_glass[3] = {0.8, 0.5, -4};
    double along = vec3_dot(to_glass, d),
           under = 0.36 - vec3_dot(to_glass, to_glass) + along * along;
    double normal[3];
    t = along - sqrt(fmax(under, 0));
    for (int c = 0; c < 3; c++)
        normal[c] = (t * d[c] - to_glass[c]) / 0.6;
    take(&hit, GLASS, t, d, normal, under);
    return hit;
}

static double difference(const float a[3], const double b[3])
{
    double worst = 0;
    for (int c = 0; c < 3; c++)
        worst = fmax(worst, fabs((double)a[c] - b[c]));
    return worst;
}

// The wall has a texture of one grey texel, so its albedo is half the colour.
static void paint_wall(struct scene *scene, struct material *wall)
{
    static const float grey[4] = {0.5f, 0.5f, 0.5f, 1};
    struct texture_image *image = scene_add_image(scene, NULL);
    struct texture *texture = scene_add_texture(scene, &wall->first_texture);
    *image = (struct texture_image){.name = "grey", .width = 1, .height = 1};
    image->texels = (const void *)grey;
    memcpy(image->mean, grey, sizeof grey);
    const uint32_t base = TEXTURE_USE_SCALE << TEXTURE_USE_SHIFT |
                          GROUP_BASE << TEXTURE_GROUP_SHIFT | 7u << TEXTURE_MASK_SHIFT |
                          0x24u << TEXTURE_CHANNELS_SHIFT;
    *texture = (struct texture){.flags = base, .transform = {{1, 0, 0}, {0, 1, 0}}};
    wall->texture_count = 1;
}

static uint32_t material_number(const struct scene *scene, const char *name)
{
    for (uint32_t i = 0; i < scene->material_count; i++)
        if (strcmp(scene->materials[i].name, name) == 0)
            return i + 1;
    return 0;
}

static void check_pixel(const struct film_aovs *aovs, uint32_t i, const uint32_t materials[5],
                        uint32_t wall_primitives[3])
{
    static const double albedos[][3] = {
        [WALL] = {0.4, 0.2, 0.1}, [MIRROR] = {0.9, 0.8, 0.7}, [GLASS] = {1, 1, 1}};
    // In the file, the mirror and the glass are the first two shapes, and the veil and the wall the
    // first two instances.
    static const uint32_t objects[] = {[VEIL] = 1, [WALL] = 2, [MIRROR] = 3, [GLASS] = 4};
    struct hit hit = expect(i);
    const double origin[3] = {1000, 2000, -500}, nothing[3] = {0, 0, 0};
    if (hit.unsure)
        return;
    const uint32_t *ids = aovs->ids[i];
    if (!hit.object) {
        CHECK(isinf(aovs->depth[i]) && aovs->alpha[i] == 0 && !ids[0] && !ids[1] && !ids[2] &&
                  difference(aovs->position[i], nothing) == 0 &&
                  difference(aovs->normal[i], nothing) == 0 &&
                  difference(aovs->albedo[i], nothing) == 0,
              "pixel %u: not empty", i);
        return;
    }
    for (int c = 0; c < 3; c++)
        hit.position[c] += origin[c];
    CHECK(fabs((double)aovs->depth[i] - hit.t) < 1e-5 && aovs->alpha[i] == 1, "pixel %u: %g m", i,
          (double)aovs->depth[i]);
    // At 2000 m, single precision has steps of 1.2e-4 m.
    CHECK(difference(aovs->position[i], hit.position) < 1.3e-4, "pixel %u: position", i);
    CHECK(difference(aovs->normal[i], hit.normal) < 1e-5 &&
              difference(aovs->normal_geometric[i], hit.normal) < 1e-5,
          "pixel %u: normal", i);
    CHECK(difference(aovs->albedo[i], albedos[hit.object]) < 1e-6, "pixel %u: albedo", i);
    CHECK(ids[0] == objects[hit.object] && ids[1] == materials[hit.object],
          "pixel %u: object %u, material %u", i, ids[0], ids[1]);
    CHECK(ids[2] == 1 || (hit.object == WALL && ids[2] == 2), "pixel %u: primitive %u", i, ids[2]);
    wall_primitives[hit.object == WALL ? ids[2] : 0]++;
}

TEST(first_surfaces)
{
    static const char *const names[] = {"", "veil", "wall", "mirror", "glass"};
    struct gpu gpu;
    struct scene scene;
    struct arena arena = {0};
    struct film_image film;
    struct err err = {0};
    OPEN_GPU(&gpu, .validation = true);
    static const uint32_t integrators[] = {INTEGRATOR_PATH, INTEGRATOR_AO, INTEGRATOR_WHITTED};
    for (int i = 0; i < 3; i++) {
        REQUIRE_OK(load_scene("tests/render/scenes/aovs.json", NULL, &scene, &err));
        uint32_t materials[5], wall_primitives[3] = {0};
        for (int m = 0; m < 5; m++)
            materials[m] = material_number(&scene, names[m]);
        paint_wall(&scene, &scene.materials[materials[WALL] - 1]);
        scene.settings.integrator = integrators[i];
        const struct renderer_params params = {.gpu = &gpu, .scene = &scene, .aovs = ALL};
        REQUIRE_OK(render_film(&params, 3, &arena, &film, NULL, &err));
        for (uint32_t p = 0; p < PIXELS; p++)
            check_pixel(&film.aovs, p, materials, wall_primitives);
        CHECK(wall_primitives[1] && wall_primitives[2], "the wall has two triangles");
        scene_finish(&scene);
    }
    arena_finish(&arena);
    gpu_close(&gpu);
}

// With jitter, pixels are partly covered. Depth and position are means over the covered samples;
// normals and alpha are means over all samples.
TEST(partly_covered_pixels)
{
    static const struct scene_override overrides[] = {
        {"settings.pixel_jitter", "true"}, {"settings.seed", "7"}, {0}};
    struct gpu gpu;
    struct scene scene;
    struct arena arena = {0};
    struct film_image film;
    struct err err = {0};
    OPEN_GPU(&gpu, .validation = false);
    REQUIRE_OK(load_scene("tests/render/scenes/aovs.json", overrides, &scene, &err));
    const struct renderer_params params = {
        .gpu = &gpu, .scene = &scene, .aovs = AOV_DEPTH | AOV_NORMAL};
    REQUIRE_OK(render_film(&params, 16, &arena, &film, NULL, &err));
    CHECK(!film.aovs.alpha && !film.aovs.position && !film.aovs.ids, "only what is asked for");
    // The middle column of the wall, whose edge at x = 0 is shared by two pixels.
    for (uint32_t y = 1; y < SIZE; y++) {
        uint32_t left = y * SIZE + 15;
        CHECK(film.aovs.depth[left] > 4.99f && film.aovs.depth[left] < 5.6f, "depth %g",
              (double)film.aovs.depth[left]);
    }
    uint32_t partial = 0;
    for (uint32_t i = 0; i < PIXELS; i++) {
        double norm = 0;
        for (int c = 0; c < 3; c++)
            norm += (double)film.aovs.normal[i][c] * (double)film.aovs.normal[i][c];
        partial += norm > 1e-6 && norm < 0.9;
        CHECK((norm > 0) == isfinite(film.aovs.depth[i]), "pixel %u", i);
    }
    CHECK(partial > 20, "%u pixels are covered in part", partial);
    scene_finish(&scene);
    arena_finish(&arena);
    gpu_close(&gpu);
}

// --- parts, and what may not matter --------------------------------------------------------------

struct variant {
    const char *name;
    struct gpu_limit_overrides limits;
    uint32_t wave;
    bool compile_all;
    uint32_t first_call;
};

enum { SAMPLES = 20 };

static const struct variant variants[] = {
    {"as it is", {0}},
    {"waves of 352", {0}, .wave = 352},
    {"split", {0}, .first_call = 3},
    {"all features", {0}, .compile_all = true},
    {"no texel buffers, small ranges", {.no_texel = true, .storage_range = 1u << 16}},
};

static bool render_variant(const struct scene *scene, uint32_t aovs, const struct variant *variant,
                           struct arena *arena, struct film_image *film, struct err *err)
{
    struct gpu gpu;
    struct renderer r;
    if (!gpu_open(&(struct gpu_params){.limits = variant->limits}, &gpu, err))
        return false;
    const struct renderer_params params = {.gpu = &gpu,
                                           .scene = scene,
                                           .aovs = aovs,
                                           .wave = variant->wave,
                                           .compile_all = variant->compile_all};
    bool ok = renderer_create(&params, &r, err);
    if (ok) {
        const struct render_call first = {.samples = variant->first_call},
                                 last = {.samples = SAMPLES - variant->first_call};
        ok = renderer_render(&r, &first, err) && renderer_render(&r, &last, err) &&
             renderer_read(&r, arena, film, err);
        renderer_finish(&r);
    }
    gpu_close(&gpu);
    return ok;
}

static bool same(const void *a, const void *b, size_t bytes_a_pixel)
{
    return memcmp(a, b, PIXELS * bytes_a_pixel) == 0;
}

static bool same_aovs(const struct film_image *f, const struct film_image *g)
{
    const struct film_aovs *a = &f->aovs, *b = &g->aovs;
    return same(a->albedo, b->albedo, 12) && same(a->normal, b->normal, 12) &&
           same(a->normal_geometric, b->normal_geometric, 12) && same(a->depth, b->depth, 4) &&
           same(a->position, b->position, 12) && same(a->alpha, b->alpha, 4) &&
           same(a->ids, b->ids, 12) && same(a->emission, b->emission, 12) &&
           same(a->direct, b->direct, 12) && same(a->indirect, b->indirect, 12) &&
           same(a->variance, b->variance, 12) && same(a->steps, b->steps, 4) &&
           same(f->samples, g->samples, 4);
}

static void check_parts(const struct film_image *film)
{
    double worst = 0, sums[3] = {0};
    for (uint32_t i = 0; i < PIXELS; i++)
        for (int c = 0; c < 3; c++) {
            double parts[] = {(double)film->aovs.emission[i][c], (double)film->aovs.direct[i][c],
                              (double)film->aovs.indirect[i][c]};
            double whole = (double)film->mean[i][c];
            worst = fmax(worst, fabs(parts[0] + parts[1] + parts[2] - whole) / fmax(whole, 1e-3));
            for (int p = 0; p < 3; p++)
                sums[p] += parts[p];
            double a = (double)film->half_a[i][c], b = (double)film->half_b[i][c];
            double variance = (a - b) * (a - b) / 4;
            CHECK(fabs((double)film->aovs.variance[i][c] - variance) <= 1e-6 * variance, "pixel %u",
                  i);
        }
    // A path's contributions are summed with at most 9 roundings, once all together and once by
    // parts. Sums over samples add no error.
    CHECK(worst < 32 * 0x1p-24, "parts differ from the whole by %g", worst);
    CHECK(sums[0] > 1 && sums[1] > 1 && sums[2] > 1, "parts of %g, %g and %g", sums[0], sums[1],
          sums[2]);
    printf("  parts: within %.2g of the whole\n", worst);
}

TEST(parts_and_same_bits)
{
    static const struct scene_override overrides[] = {{"film", "{\"width\": 32, \"height\": 32}"},
                                                      {0}};
    struct scene scene;
    struct arena arena = {0};
    struct film_image plain, film, other;
    struct err err = {0};
    struct gpu gpu;
    OPEN_GPU(&gpu, .validation = false);
    gpu_close(&gpu);
    REQUIRE_OK(load_scene("scenes/cornell.json", overrides, &scene, &err));
    REQUIRE_OK(render_variant(&scene, 0, &variants[0], &arena, &plain, &err));
    REQUIRE_OK(render_variant(&scene, ALL, &variants[0], &arena, &film, &err));
    CHECK(same(plain.half_a, film.half_a, 12) && same(plain.half_b, film.half_b, 12),
          "the radiance is another with AOVs");
    check_parts(&film);
    for (size_t i = 1; i < sizeof variants / sizeof variants[0]; i++) {
        REQUIRE_OK(render_variant(&scene, ALL, &variants[i], &arena, &other, &err));
        CHECK(same(other.half_a, film.half_a, 12) && same_aovs(&other, &film), "%s",
              variants[i].name);
    }
    scene_finish(&scene);
    arena_finish(&arena);
}

// Parts include all branches; the first surface is the one at which they begin.
TEST(split_paths)
{
    static const struct scene_override overrides[] = {{"film", "{\"width\": 32, \"height\": 32}"},
                                                      {0}};
    struct scene scene;
    struct arena arena = {0};
    struct film_image film, split;
    struct err err = {0};
    struct gpu gpu;
    OPEN_GPU(&gpu, .validation = false);
    gpu_close(&gpu);
    REQUIRE_OK(load_scene("scenes/phong_lobes.json", overrides, &scene, &err));
    REQUIRE_OK(render_variant(&scene, ALL, &variants[0], &arena, &film, &err));
    scene.settings.split_lobes = 2;
    REQUIRE_OK(render_variant(&scene, ALL, &variants[0], &arena, &split, &err));
    check_parts(&split);
    const struct film_aovs *a = &film.aovs, *b = &split.aovs;
    CHECK(same(a->albedo, b->albedo, 12) && same(a->normal, b->normal, 12) &&
              same(a->depth, b->depth, 4) && same(a->position, b->position, 12) &&
              same(a->alpha, b->alpha, 4) && same(a->ids, b->ids, 12),
          "the first surface is another");
    CHECK(same(a->emission, b->emission, 12) && !same(a->indirect, b->indirect, 12),
          "nothing is split, or too early");
    scene_finish(&scene);
    arena_finish(&arena);
}

// --- steps ---------------------------------------------------------------------------------------

static bool render_steps(struct renderer *r, const struct renderer_params *params, bool counts,
                         uint32_t budget, struct arena *arena, struct film_image *film,
                         struct err *err)
{
    const struct render_call call = {.samples = 5};
    if (!renderer_create(params, r, err))
        return false;
    if (budget)
        r->specialization.iteration_budget = budget;
    return (!counts || wave_count_steps(r, true, err)) &&
           (!budget || renderer_resize(r, 1024, 64, err)) && renderer_render(r, &call, err) &&
           renderer_read(r, arena, film, err);
}

// If nothing is scattered, all counted rays are camera rays. Suspended traversals give the same
// counts, also for distance fields and instances.
TEST(steps)
{
    static const char *const paths[] = {"scenes/cornell.json", "scenes/sdf_csg.json",
                                        "scenes/teapots.json"};
    static const struct scene_override overrides[] = {
        {"film", "{\"width\": 32, \"height\": 32}"}, {"settings.max_bounces", "0"}, {0}};
    for (size_t i = 0; i < sizeof paths / sizeof paths[0]; i++) {
        struct gpu gpu;
        struct scene scene;
        struct renderer r;
        struct arena arena = {0};
        struct film_image film, pieces;
        struct err err = {0};
        OPEN_GPU(&gpu, .validation = true);
        REQUIRE_OK(load_scene(paths[i], overrides, &scene, &err));
        const struct renderer_params params = {
            .gpu = &gpu, .scene = &scene, .aovs = AOV_STEPS, .instancing = INSTANCING_ON};
        REQUIRE_OK(render_steps(&r, &params, true, 0, &arena, &film, &err));
        double sum = 0,
               counted = (double)(r.stats.steps[STEPS_CLOSEST] + r.stats.steps[STEPS_CLOSEST + 1]);
        for (uint32_t p = 0; p < PIXELS; p++)
            sum += 5 * (double)film.aovs.steps[p];
        CHECK(fabs(sum - counted) < 1e-6 * counted && counted > PIXELS * 5,
              "%s: %.9g steps in the picture, %.9g in all", paths[i], sum, counted);
        renderer_finish(&r);
        REQUIRE_OK(render_steps(&r, &params, false, 3, &arena, &pieces, &err));
        CHECK(r.stats.suspended > 0, "%s: no traversal was suspended", paths[i]);
        CHECK(same(film.aovs.steps, pieces.aovs.steps, 4), "%s: others in pieces", paths[i]);
        renderer_finish(&r);
        scene_finish(&scene);
        arena_finish(&arena);
        gpu_close(&gpu);
    }
}

// --- memory --------------------------------------------------------------------------------------

// Only requested AOVs take memory: words of 16 bytes per slot and, per pixel, 64 bytes for four
// sums and 16 for the digits of up to 16 sums.
TEST(memory)
{
    static const struct {
        uint32_t aovs, sums, ids;
    } cases[] = {{0, 0, 0},
                 {AOV_SAMPLES | AOV_VARIANCE | AOV_HALVES, 0, 0},
                 {AOV_ALBEDO, 1, 0},
                 {AOV_ALPHA, 1, 0},
                 {AOV_STEPS, 1, 0},
                 {AOV_DEPTH, 1, 0},
                 {AOV_POSITION, 1, 0}, // with the fraction of samples over which the position is a
                                       // mean
                 {AOV_POSITION | AOV_ALPHA, 1, 0},
                 {AOV_IDS, 0, 1},
                 {AOV_NORMAL | AOV_NORMAL_GEOMETRIC, 2, 0},
                 {AOV_EMISSION | AOV_DIRECT | AOV_INDIRECT, 3, 0},
                 {ALL, 6, 1}};
    struct gpu gpu;
    struct scene scene;
    struct err err = {0};
    OPEN_GPU(&gpu, .validation = false);
    REQUIRE_OK(load_scene("tests/render/scenes/aovs.json", NULL, &scene, &err));
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct renderer r;
        const struct renderer_params params = {
            .gpu = &gpu, .scene = &scene, .wave = 1024, .aovs = cases[i].aovs};
        REQUIRE_OK(renderer_create(&params, &r, &err));
        const struct planned_buffer *plan = r.plan.buffers;
        uint64_t sums = 16 * cases[i].sums, ids = 16 * cases[i].ids;
        uint64_t digits = 16 * ((cases[i].sums + 3) / 4);
        CHECK(plan[BINDING_RADIANCE].bytes == 1024 * (16 + sums + ids), "0x%x: %llu bytes of slots",
              cases[i].aovs, (unsigned long long)plan[BINDING_RADIANCE].bytes);
        CHECK(plan[BINDING_FILM].bytes == PIXELS * (112 + 4 * sums + digits + ids),
              "0x%x: %llu of film", cases[i].aovs, (unsigned long long)plan[BINDING_FILM].bytes);
        CHECK(plan[BINDING_RESOLVED].bytes == PIXELS * (32 + sums + ids), "0x%x: %llu to read",
              cases[i].aovs, (unsigned long long)plan[BINDING_RESOLVED].bytes);
        renderer_finish(&r);
    }
    scene_finish(&scene);
    gpu_close(&gpu);
}

TEST_MAIN(TEST_CASE(first_surfaces), TEST_CASE(partly_covered_pixels),
          TEST_CASE(parts_and_same_bits), TEST_CASE(split_paths), TEST_CASE(steps),
          TEST_CASE(memory))
