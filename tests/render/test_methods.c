// Every method of finding light and of continuing or ending paths estimates the same picture: a
// scene with all kinds of surfaces and lights, as a whole and in 2 x 2 tiles, by pairs of methods
// with 64 replicates each. Also tests closed forms, including the loss caused by settings that lose
// light.
#include "base/clock.h"
#include "metrics/metrics.h"
#include "render_fixture.h"
#include "check/replicates.h"

// --- comparing methods ---------------------------------------------------------------------------

#define WHOLE 4 // the value after those of the tiles
#define MOST_METHODS (140 + SETTINGS_SPLIT_LOBES_MAX)

struct method {
    bool nee;
    uint32_t nee_depth, mis, directions, roulette;
    float mis_exponent; // 0: the default
    float min_density;
    uint32_t split_lobes;
    uint32_t environment_sampling;
};

static void print_method(const struct method *m)
{
    printf("nee %s", !m->nee ? "off" : m->nee_depth == 1 ? "once" : "on");
    printf(" %s %s %s", mis_names[m->mis], directions_names[m->directions],
           roulette_names[m->roulette]);
    if (m->split_lobes > 0)
        printf(" split %u", m->split_lobes);
    if (m->environment_sampling)
        printf(" %s", environment_sampling_names[m->environment_sampling]);
}

// Adds an environment with a bright horizon and a brighter patch.
static void add_surroundings(struct scene *scene)
{
    static float texels[8][3] = {{0.3f, 0.4f, 0.8f}, {0.3f, 0.4f, 0.8f}, {4.0f, 3.0f, 2.0f},
                                 {0.3f, 0.4f, 0.8f}, {0.1f, 0.1f, 0.1f}, {0.2f, 0.2f, 0.1f},
                                 {0.1f, 0.1f, 0.1f}, {0.1f, 0.1f, 0.1f}};
    scene->environment = (struct environment){
        .present = true, .radiance = {1, 1, 1}, .width = 4, .height = 2, .texels = texels};
}

static void render_method(struct gpu *gpu, const struct method *m, uint32_t index, uint64_t samples,
                          struct replicates *out)
{
    uint64_t start = clock_ns();
    struct scene scene;
    struct renderer r;
    struct err err = {0};
    REQUIRE_OK(load_scene("tests/render/scenes/methods.json", NULL, &scene, &err));
    add_surroundings(&scene);
    scene.settings.nee = m->nee;
    scene.settings.nee_depth = m->nee_depth;
    scene.settings.mis = m->mis;
    scene.settings.directions = m->directions;
    scene.settings.direction_exponent = 4.0f;
    scene.settings.roulette = m->roulette;
    scene.settings.split_lobes = m->split_lobes;
    scene.settings.environment_sampling = m->environment_sampling;
    const struct renderer_params params = {.gpu = gpu, .scene = &scene, .merge_classes = true};
    REQUIRE_OK(renderer_create(&params, &r, &err));
    REQUIRE_OK(replicates_render(&r, &MEASURE_2X2_TILES, REPLICATES * index, samples, out, &err));
    struct estimate whole = replicates_estimate(out, WHOLE);
    print_method(m);
    printf(": mean %.6g +-%.2g %%, %.1f s\n", whole.mean, 100 * whole.half_width / whole.mean,
           clock_seconds_since(start));
    renderer_finish(&r);
    scene_finish(&scene);
}

// Returns the |t| that any of all comparisons exceeds by chance with probability 1e-3. Welch's
// degrees of freedom are at least those of one method.
static double t_limit(uint32_t methods)
{
    double comparisons = 0.5 * methods * (methods - 1) * (WHOLE + 1);
    return stats_t_quantile(1.0 - 0.5e-3 / comparisons, REPLICATES - 1);
}

// Returns the greatest |t| between two methods.
static double compare_methods(const struct replicates *a, const struct replicates *b)
{
    double worst = 0.0;
    for (uint32_t v = 0; v < MEASURE_2X2_TILES.count; v++) {
        struct estimate of_a = replicates_estimate(a, v), of_b = replicates_estimate(b, v);
        double error = hypot(of_a.standard_error, of_b.standard_error);
        double t = fabs(of_a.mean - of_b.mean) / error;
        if (t > 3.0)
            printf("value %u: %.6g +-%.2g and %.6g +-%.2g, t %.2f\n", v, of_a.mean, of_a.half_width,
                   of_b.mean, of_b.half_width, t);
        worst = fmax(worst, t);
    }
    return worst;
}

// Also checks that the 95 % intervals of the whole picture are narrower than `half_width` of it,
// because a test with wide intervals would find nothing.
static void check_methods(const struct method *methods, uint32_t count, uint64_t samples,
                          double half_width)
{
    static struct replicates results[MOST_METHODS];
    struct gpu gpu;
    double limit = t_limit(count), worst = 0.0;
    REQUIRE(count <= MOST_METHODS, "%u methods", count);
    OPEN_GPU(&gpu, 0);
    for (uint32_t i = 0; i < count; i++) {
        // Methods that find lights by chance need more samples for the same accuracy.
        render_method(&gpu, &methods[i], i, methods[i].nee ? samples : 4 * samples, &results[i]);
        struct estimate whole = replicates_estimate(&results[i], WHOLE);
        CHECK(whole.half_width <= half_width * whole.mean, "method %u: half-width %.3g", i,
              whole.half_width / whole.mean);
    }
    gpu_close(&gpu);
    for (uint32_t i = 0; i < count; i++) {
        for (uint32_t j = 0; j < i; j++) {
            double t = compare_methods(&results[i], &results[j]);
            worst = fmax(worst, t);
            CHECK(t <= limit, "methods %u and %u: t = %.2f, limit %.2f", j, i, t, limit);
        }
    }
    printf("greatest t %.2f of at most %.2f\n", worst, limit);
}

#define ALL UINT32_MAX

// Each choice of each setting occurs at least once, except Russian roulette by frames: with so few
// samples, its depths dominate.
TEST(agree)
{
    static const struct method methods[] = {
        {true, ALL, MIS_POWER, DIRECTIONS_BSDF, ROULETTE_THROUGHPUT},
        {true, ALL, MIS_BALANCE, DIRECTIONS_COSINE, ROULETTE_CONSTANT},
        {true, ALL, MIS_NONE, DIRECTIONS_POWER_COSINE, ROULETTE_OFF},
        {true, 1, MIS_POWER, DIRECTIONS_HEMISPHERE, ROULETTE_CONSTANT},
        {false, ALL, MIS_POWER, DIRECTIONS_SPHERE, ROULETTE_OFF},
        {true, ALL, MIS_POWER, DIRECTIONS_BSDF, ROULETTE_OFF, .split_lobes = 2},
        {true, ALL, MIS_POWER, DIRECTIONS_BSDF, ROULETTE_THROUGHPUT,
         .environment_sampling = ENVIRONMENT_SAMPLING_COMPENSATED},
    };
    check_methods(methods, sizeof methods / sizeof *methods, 8, 0.02);
}

// Tests all combinations.
TEST(agree_long)
{
    static struct method methods[MOST_METHODS];
    uint32_t count = 0;
    for (uint32_t d = DIRECTIONS_BSDF; d <= DIRECTIONS_POWER_COSINE; d++) {
        for (uint32_t r = ROULETTE_THROUGHPUT; r <= ROULETTE_OFF; r++) {
            methods[count++] = (struct method){false, ALL, MIS_POWER, d, r};
            for (uint32_t m = MIS_POWER; m <= MIS_NONE; m++) {
                methods[count++] = (struct method){true, ALL, m, d, r};
                methods[count++] = (struct method){true, 1, m, d, r};
            }
        }
    }
    for (uint32_t split = 1; split <= SETTINGS_SPLIT_LOBES_MAX; split++)
        methods[count++] = (struct method){
            true, ALL, MIS_POWER, DIRECTIONS_BSDF, ROULETTE_OFF, .split_lobes = split};
    check_methods(methods, count, 16, 0.03);
}

// --- closed forms --------------------------------------------------------------------------------

static const double albedo[3] = {0.8, 0.5, 0.2}, emission[3] = {1, 2, 4};

// Returns Le times the first `bounces` + 1 terms of a geometric series: a closed sphere that emits.
static double furnace(double rho, double le, double bounces)
{
    return le * (1.0 - pow(rho, bounces + 1.0)) / (1.0 - rho);
}

#define MIN_DENSITY 0.125

// Returns the fraction of a cosine lobe above a least density D: all except the cosines below pi D,
// whose fraction of the flux is (pi D)^2.
static double likely_part(void)
{
    return 1.0 - pow(M_PI * MIN_DENSITY, 2.0);
}

static double furnace_of_likely_paths(double rho, double le, double bounces)
{
    return furnace(rho * likely_part(), le, bounces);
}

// Returns the furnace's radiance with shadow rays, which lose nothing: each vertex has all of its
// direct light.
static double furnace_with_shadow_rays(double rho, double le, double bounces)
{
    double onwards = rho * likely_part();
    return le + rho * le * (1.0 - pow(onwards, bounces)) / (1.0 - onwards);
}

// Returns the radiance due to a point light of intensity Le in the centre of a sphere of radius 2.
static double lamp_in_sphere(double rho, double le, double bounces)
{
    return rho / M_PI * le / 4.0 * (1.0 - pow(rho, bounces)) / (1.0 - rho);
}

// Returns the radiance due to a square of side 2 at height 1 above the visible point (Howell, "A
// Catalog of Radiation Heat Transfer Configuration Factors", C-11, four times).
static double square_above(double rho, double le, double unused)
{
    (void)unused;
    return rho * le * 4.0 * atan(1.0 / sqrt(2.0)) / (M_PI * sqrt(2.0));
}

struct form {
    const char *name, *scene;
    double (*radiance)(double rho, double le, double bounces);
    double bounces; // bounces that contribute light
    struct method method;
    uint32_t roulette_most;
    uint64_t samples;
};

static void check_form(struct gpu *gpu, const struct form *form, uint32_t index)
{
    struct scene scene;
    struct renderer r;
    struct replicates results;
    struct err err = {0};
    const struct scene_override light[] = {
        {"light", "{\"type\": \"quad\", \"material\": \"light\", \"corner\": [-1, 1, 1], "
                  "\"u\": [2, 0, 0], \"v\": [0, 0, -2]}"},
        {0}};
    bool has_square = form->radiance == square_above;
    REQUIRE_OK(load_scene(form->scene, has_square ? light : NULL, &scene, &err));
    struct settings *settings = &scene.settings;
    settings->width = settings->height = 16;
    settings->max_bounces = 9;
    settings->nee = form->method.nee;
    settings->nee_depth = form->method.nee_depth;
    settings->mis = form->method.mis;
    settings->directions = form->method.directions;
    settings->roulette = form->method.roulette;
    settings->mis_exponent = form->method.mis_exponent > 0 ? form->method.mis_exponent : 2;
    settings->min_density = form->method.min_density;
    settings->roulette_min_bounces = 1;
    settings->roulette_max_bounces = form->roulette_most;
    const struct renderer_params params = {.gpu = gpu, .scene = &scene};
    REQUIRE_OK(renderer_create(&params, &r, &err));
    REQUIRE_OK(replicates_render(&r, &MEASURE_MEAN, 10000 + REPLICATES * index, form->samples,
                                 &results, &err));
    printf("%-38s", form->name);
    for (uint32_t c = 0; c < 3; c++) {
        struct estimate e = replicates_estimate(&results, c);
        double expected = form->radiance(albedo[c], emission[c], form->bounces);
        double bias = e.mean - expected, t = bias / e.standard_error;
        printf("  %+.1e (t %+.1f) +-%.1e", bias / expected, t, e.half_width / expected);
        // Without variance, only rounding errors remain.
        CHECK(fabs(t) <= REPLICATES_T_MAX || fabs(bias) <= 1e-5 * expected,
              "%s, channel %u: %.9g, not %.9g: t = %.2f", form->name, c, e.mean, expected, t);
        CHECK(e.half_width <= 0.02 * expected, "%s, channel %u: half-width %.3g", form->name, c,
              e.half_width / expected);
    }
    putchar('\n');
    renderer_finish(&r);
    scene_finish(&scene);
}

#define FURNACE "src/check/scenes/sphere_furnace.json"
#define LAMP "src/check/scenes/sphere_lamp.json"
#define SQUARE "src/check/scenes/floor_light.json"

// Only shadow rays find the lamp in the sphere, so `nee_depth` of its bounces remain.
TEST(closed_forms)
{
    static const struct form forms[] = {
        {"roulette by throughput",
         FURNACE,
         furnace,
         9,
         {false, ALL, MIS_POWER, DIRECTIONS_BSDF, ROULETTE_THROUGHPUT},
         ALL,
         16},
        {"roulette by a constant",
         FURNACE,
         furnace,
         9,
         {false, ALL, MIS_POWER, DIRECTIONS_BSDF, ROULETTE_CONSTANT},
         ALL,
         16},
        {"roulette of frames",
         FURNACE,
         furnace,
         9,
         {false, ALL, MIS_POWER, DIRECTIONS_BSDF, ROULETTE_FRAME},
         ALL,
         256},
        {"roulette of frames, capped at 4",
         FURNACE,
         furnace,
         4,
         {false, ALL, MIS_POWER, DIRECTIONS_BSDF, ROULETTE_FRAME},
         4,
         256},
        {"uniform over the sphere",
         FURNACE,
         furnace,
         9,
         {false, ALL, MIS_POWER, DIRECTIONS_SPHERE, ROULETTE_OFF},
         ALL,
         64},
        {"uniform over the hemisphere",
         FURNACE,
         furnace,
         9,
         {false, ALL, MIS_POWER, DIRECTIONS_HEMISPHERE, ROULETTE_OFF},
         ALL,
         16},
        {"shadow rays at 2 vertices",
         FURNACE,
         furnace,
         9,
         {true, 2, MIS_BALANCE, DIRECTIONS_BSDF, ROULETTE_OFF},
         ALL,
         16},
        {"a lamp, shadow rays at 1 vertex",
         LAMP,
         lamp_in_sphere,
         1,
         {true, 1, MIS_POWER, DIRECTIONS_BSDF, ROULETTE_OFF},
         ALL,
         4},
        {"a lamp, shadow rays at 3 vertices",
         LAMP,
         lamp_in_sphere,
         3,
         {true, 3, MIS_POWER, DIRECTIONS_BSDF, ROULETTE_OFF},
         ALL,
         4},
        {"power heuristic",
         SQUARE,
         square_above,
         1,
         {true, ALL, MIS_POWER, DIRECTIONS_BSDF, ROULETTE_OFF},
         ALL,
         16},
        {"balance heuristic",
         SQUARE,
         square_above,
         1,
         {true, ALL, MIS_BALANCE, DIRECTIONS_COSINE, ROULETTE_OFF},
         ALL,
         16},
        {"no heuristic",
         SQUARE,
         square_above,
         1,
         {true, ALL, MIS_NONE, DIRECTIONS_HEMISPHERE, ROULETTE_OFF},
         ALL,
         16},
        {"power heuristic, hemisphere",
         SQUARE,
         square_above,
         1,
         {true, ALL, MIS_POWER, DIRECTIONS_HEMISPHERE, ROULETTE_OFF},
         ALL,
         16},
        {"power heuristic, sphere",
         SQUARE,
         square_above,
         1,
         {true, ALL, MIS_POWER, DIRECTIONS_SPHERE, ROULETTE_OFF},
         ALL,
         32},
        {"power heuristic, exponent 0.5",
         SQUARE,
         square_above,
         1,
         {true, ALL, MIS_POWER, DIRECTIONS_BSDF, ROULETTE_OFF, .mis_exponent = 0.5f},
         ALL,
         16},
        {"power heuristic, exponent 16",
         SQUARE,
         square_above,
         1,
         {true, ALL, MIS_POWER, DIRECTIONS_BSDF, ROULETTE_OFF, .mis_exponent = 16},
         ALL,
         16},
        {"a least density",
         FURNACE,
         furnace_of_likely_paths,
         9,
         {false, ALL, MIS_POWER, DIRECTIONS_BSDF, ROULETTE_OFF, .min_density = MIN_DENSITY},
         ALL,
         64},
        {"a least density, shadow rays",
         FURNACE,
         furnace_with_shadow_rays,
         9,
         {true, ALL, MIS_POWER, DIRECTIONS_BSDF, ROULETTE_OFF, .min_density = MIN_DENSITY},
         ALL,
         64},
        {"balance heuristic, lobe",
         SQUARE,
         square_above,
         1,
         {true, ALL, MIS_BALANCE, DIRECTIONS_POWER_COSINE, ROULETTE_OFF},
         ALL,
         32},
    };
    struct gpu gpu;
    OPEN_GPU(&gpu, 0);
    for (uint32_t i = 0; i < sizeof forms / sizeof *forms; i++)
        check_form(&gpu, &forms[i], i);
    gpu_close(&gpu);
}

// --- clamping ------------------------------------------------------------------------------------

static double mean_luminance(const struct film_image *film)
{
    double sum = 0.0;
    uint64_t pixels = (uint64_t)film->width * film->height;
    for (uint64_t i = 0; i < pixels; i++)
        sum += 0.2126 * (double)film->mean[i][0] + 0.7152 * (double)film->mean[i][1] +
               0.0722 * (double)film->mean[i][2];
    return sum / (double)pixels;
}

static double render_clamped(struct gpu *gpu, float limit, bool compile_all,
                             struct render_stats *stats)
{
    const struct scene_override size[] = {{"film.width", "32"}, {"film.height", "32"}, {0}};
    struct scene scene;
    struct arena arena = {0};
    struct film_image film = {0};
    struct err err = {0};
    if (!load_scene("scenes/cornell.json", size, &scene, &err))
        return NAN;
    scene.settings.clamp_limit = limit;
    const struct renderer_params params = {.gpu = gpu, .scene = &scene, .compile_all = compile_all};
    bool ok = render_film(&params, 16, &arena, &film, stats, &err);
    double mean = ok ? mean_luminance(&film) : NAN;
    arena_finish(&arena);
    scene_finish(&scene);
    return mean;
}

// Renders the same paths with and without a limit: the light missing in the picture must be that
// which is reported.
TEST(clamp_reports_what_it_takes)
{
    struct gpu gpu;
    struct render_stats stats = {0}, free = {0};
    OPEN_GPU(&gpu, .validation = true);
    double whole = render_clamped(&gpu, 0.0f, false, &free);
    double clamped = render_clamped(&gpu, 0.5f, false, &stats);
    double lost = stats.clamped_light / (double)stats.paths;
    printf("%.6g of %.6g lost, %.6g reported, in %llu contributions\n", whole - clamped, whole,
           lost, (unsigned long long)stats.clamped);
    CHECK(stats.paths == 32u * 32u * 16u, "%llu paths", (unsigned long long)stats.paths);
    CHECK(whole - clamped > 0.01 * whole, "%.6g and %.6g", whole, clamped);
    // The reported sum counts whole units of 2^-10 of the limit, rounded.
    CHECK(fabs(whole - clamped - lost) <= 1e-3 * lost, "%.6g lost, %.6g reported", whole - clamped,
          lost);
    CHECK(free.clamped == 0 && free.clamped_light == 0.0, "clamped without a limit");
    double compiled_in = render_clamped(&gpu, 0.0f, true, &free);
    CHECK(compiled_in == whole && free.clamped == 0, "compiled in: %.9g, not %.9g", compiled_in,
          whole);
    CHECK(gpu.validation_messages == 0, "%u messages", gpu.validation_messages);
    gpu_close(&gpu);
}

TEST_MAIN(TEST_CASE(agree), TEST_CASE(agree_long), TEST_CASE(closed_forms),
          TEST_CASE(clamp_reports_what_it_takes))
