// Compares pictures with instances to those of the flattened scene: they differ only by rounding.
#include "base/log.h"
#include "render_fixture.h"
#include "shared/aov.h"
#include <math.h>

#define SCENE "tests/render/scenes/instances.json"
#define ASPECTS                                                                                    \
    (AOV_IDS | AOV_DEPTH | AOV_POSITION | AOV_NORMAL | AOV_NORMAL_GEOMETRIC | AOV_ALBEDO)

static void ignore(void *context, enum log_level level, const char *message)
{
    (void)context;
    (void)level;
    (void)message;
}

struct pair {
    struct scene scene;
    struct arena arena;
    struct film_image flat, two;
    uint32_t placed; // number of instances in the second scene
};

static bool render_pair(struct pair *p, const char *path, const struct scene_override *overrides,
                        uint32_t integrator, uint64_t samples, struct err *err)
{
    struct gpu gpu;
    const struct gpu_params device = {.validation = true};
    log_configure(LOG_ERROR, ignore, NULL);
    if (!load_scene(path, overrides, &p->scene, err) || !gpu_open(&device, &gpu, err))
        return false;
    p->scene.settings.integrator = integrator;
    bool ok = true;
    for (int level = 0; level < 2 && ok; level++) {
        struct renderer r;
        const struct render_call call = {.samples = samples};
        const struct renderer_params params = {
            .gpu = &gpu,
            .scene = &p->scene,
            .instancing = level ? INSTANCING_ON : INSTANCING_OFF,
            .aovs = ASPECTS,
        };
        ok = renderer_create(&params, &r, err);
        if (!ok)
            break;
        p->placed = r.flat.placed_count;
        CHECK((p->placed > 0) == (level == 1));
        CHECK(!!(r.specialization.geometry & GEOMETRY_INSTANCES) == (level == 1));
        ok = renderer_render(&r, &call, err) &&
             renderer_read(&r, &p->arena, level ? &p->two : &p->flat, err);
        renderer_finish(&r);
    }
    CHECK(gpu.validation_messages == 0);
    gpu_close(&gpu);
    return ok;
}

static void finish(struct pair *p)
{
    arena_finish(&p->arena);
    scene_finish(&p->scene);
    log_configure(LOG_WARN, NULL, NULL);
}

// --- what camera rays meet -----------------------------------------------------------------------

static double distance(const float a[3], const float b[3])
{
    double square = 0;
    for (int c = 0; c < 3; c++)
        square += ((double)a[c] - (double)b[c]) * ((double)a[c] - (double)b[c]);
    return sqrt(square);
}

// Checks that object, material and triangle are the same in all pixels except those whose ray
// passes an edge, and that positions and normals agree within rounding. `scale` multiplies the
// rounding errors.
static void compare_first_hits(const struct pair *p, double scale)
{
    const struct film_aovs *a = &p->flat.aovs, *b = &p->two.aovs;
    uint32_t pixels = p->flat.width * p->flat.height, other = 0, objects = 0, moved = 0, turned = 0;
    for (uint32_t i = 0; i < pixels; i++) {
        objects = a->ids[i][0] > objects ? a->ids[i][0] : objects;
        if (memcmp(a->ids[i], b->ids[i], sizeof a->ids[i])) {
            other++;
            continue;
        }
        bool nothing = a->ids[i][0] == 0;
        moved += !nothing && (distance(a->position[i], b->position[i]) > 1e-5 * scale ||
                              fabs((double)a->depth[i] - (double)b->depth[i]) > 1e-5 * scale);
        turned += distance(a->normal[i], b->normal[i]) > 1e-3 ||
                  distance(a->normal_geometric[i], b->normal_geometric[i]) > 1e-3 ||
                  distance(a->albedo[i], b->albedo[i]) > 1e-3;
    }
    CHECK(objects >= 5, "%u", objects);
    CHECK(other <= pixels / 100, "%u of %u pixels show another triangle", other, pixels);
    CHECK(moved <= pixels / 100, "%u of %u pixels are elsewhere", moved, pixels);
    CHECK(turned <= pixels / 50, "%u of %u pixels look another way", turned, pixels);
}

// --- light ---------------------------------------------------------------------------------------

// Paths of both renders have the same random numbers, so pixels differ only by paths that rounding
// sends elsewhere: the differences are independent between pixels and have mean zero. |t| exceeds 4
// with a probability of 6e-5. `most` is the greatest relative difference of the whole picture.
static void compare_light(const struct pair *p, double most)
{
    uint32_t pixels = p->flat.width * p->flat.height, same = 0;
    CHECK(p->flat.dropped == 0 && p->two.dropped == 0);
    for (int c = 0; c < 3; c++) {
        double sum = 0, squares = 0, whole = 0;
        for (uint32_t i = 0; i < pixels; i++) {
            double x = (double)p->flat.mean[i][c], y = (double)p->two.mean[i][c];
            sum += y - x;
            squares += (y - x) * (y - x);
            whole += x;
            same += fabs(y - x) <= 1e-3 * x;
        }
        double mean = sum / pixels;
        double deviation = sqrt(fmax(squares / pixels - mean * mean, 0) / (pixels - 1));
        CHECK(fabs(mean) <= 4 * deviation + 1e-6 * whole / pixels,
              "channel %d: %g is off by %g, a deviation is %g", c, whole / pixels, mean, deviation);
        CHECK(fabs(sum) <= most * whole, "channel %d: off by %g of %g", c, sum, whole);
    }
    CHECK(most > 0.01 || same > 3 * pixels / 2, "%u of %u values are the same within 0.1 %%", same,
          3 * pixels);
}

// --- tests ---------------------------------------------------------------------------------------

static const char *image(void)
{
    static char path[4096];
    const char *root = getenv("LAMPYRIS_SOURCE_ROOT");
    snprintf(path, sizeof path, "%s/tests/fuzz/corpus/png/palette.png", root ? root : ".");
    return path;
}

static void check(const struct scene_override *overrides, uint32_t integrator, uint64_t samples,
                  double scale)
{
    struct pair p = {0};
    struct err err = {0};
    REQUIRE_OK(render_pair(&p, SCENE, overrides, integrator, samples, &err));
    compare_first_hits(&p, scale);
    compare_light(&p, 0.005);
    finish(&p);
}

TEST(a_path_traced_picture)
{
    const struct scene_override overrides[] = {
        {"image", image()}, {"materials.veil.opacity", "1"}, {NULL, NULL}};
    check(overrides, INTEGRATOR_PATH, 64, 1);
}

// Everything is 4e5 m away, and is moved back in double precision for both renders.
TEST(a_picture_far_from_the_origin)
{
    const struct scene_override overrides[] = {
        {"image", image()},
        {"materials.veil.opacity", "1"},
        {"at", "[400000, -300000, 12345.6]"},
        {"eye", "[400000, -299997.4, 12350.6]"},
        {"target", "[400000, -299999.2, 12345.6]"},
        {NULL, NULL},
    };
    check(overrides, INTEGRATOR_PATH, 16, 4e4); // positions are stored as floats of the world
}

TEST(pictures_of_other_integrators)
{
    const struct scene_override overrides[] = {
        {"image", image()}, {"materials.veil.opacity", "1"}, {NULL, NULL}};
    check(overrides, INTEGRATOR_AO, 16, 1);
    check(overrides, INTEGRATOR_WHITTED, 4, 1);
}

// Each triangle's number decides about opacity, and differs between these renders: pictures have
// the same mean but different noise.
TEST(a_picture_with_alpha)
{
    const struct scene_override overrides[] = {{"image", image()}, {NULL, NULL}};
    struct pair p = {0};
    struct err err = {0};
    REQUIRE_OK(render_pair(&p, SCENE, overrides, INTEGRATOR_PATH, 64, &err));
    compare_light(&p, 0.02);
    finish(&p);
}

// There are ten thousand cubes, whose flattened triangles still fit into memory.
TEST(ten_thousand_instances)
{
    struct pair p = {0};
    struct err err = {0};
    REQUIRE_OK(render_pair(&p, "tests/render/scenes/strewn.json", NULL, INTEGRATOR_PATH, 16, &err));
    CHECK(p.placed == 10001, "%u", p.placed);
    compare_first_hits(&p, 30);
    compare_light(&p, 0.005);
    finish(&p);
}

// A million trees, for which 20 GiB of triangles are not stored.
TEST(a_million_instances)
{
    struct gpu gpu;
    struct scene scene;
    struct renderer r;
    struct film_image film;
    struct arena arena = {0};
    struct err err = {0};
    const struct scene_override overrides[] = {
        {"film.width", "64"}, {"film.height", "36"}, {NULL, NULL}};
    OPEN_GPU(&gpu, .validation = true);
    REQUIRE_OK(load_scene("scenes/forest.json", overrides, &scene, &err));
    const struct renderer_params params = {.gpu = &gpu, .scene = &scene};
    const struct render_call call = {.samples = 4};
    REQUIRE_OK(renderer_create(&params, &r, &err));
    CHECK(r.flat.placed_count == 1000000 && r.flat.triangle_count < 5000);
    CHECK(r.plan.total_bytes < 256 << 20, "%llu", (unsigned long long)r.plan.total_bytes);
    REQUIRE_OK(renderer_render(&r, &call, &err));
    REQUIRE_OK(renderer_read(&r, &arena, &film, &err));
    CHECK(film.dropped == 0 && gpu.validation_messages == 0);
    renderer_finish(&r);
    gpu_close(&gpu);
    scene_finish(&scene);
    arena_finish(&arena);
}

int main(int argc, char **argv)
{
    static const struct test_case cases[] = {
        TEST_CASE(a_path_traced_picture),         TEST_CASE(a_picture_far_from_the_origin),
        TEST_CASE(pictures_of_other_integrators), TEST_CASE(ten_thousand_instances),
        TEST_CASE(a_picture_with_alpha),          TEST_CASE(a_million_instances),
    };
    return test_run(cases, sizeof cases / sizeof *cases, argc, argv);
}
