// Tests a plane under environments and suns, whose irradiance is computed by quadrature of the
// image in double precision; src/check/forms_environments.c has closed forms (docs/verification.md,
// B24 and B25). Uses multiple importance sampling, and each estimator that finds the light.
#include "base/clock.h"
#include "check/estimators.h"
#include "check/replicates.h"
#include "environment_reference.h"
#include "render_fixture.h"
#include "scene/core/environment.h"
#include "scene/sky/sky.h"
#include <inttypes.h>

static const double albedo[3] = {0.8, 0.5, 0.2};

// Limits of the half-width of the 95 % confidence interval and of the bias, relative to the value,
// as for closed forms.
#define HALF_WIDTH_MAX 1e-3
#define BIAS_MAX 3e-3
#define ROUNDING_MAX 2e-5
#define MOST_SAMPLES 512

struct form {
    const char *name;
    // Sets the environment of a scene whose plane has this normal, and computes the irradiance.
    bool (*surround)(struct scene *scene, const struct form *form, double irradiance[3],
                     struct err *err);
    double parameter;
    double normal[3];
    double rotation;   // rotation of the environment, in radians
    unsigned alone;    // estimators besides MIS that find the light in reasonable time
    uint32_t filter;   // ENVIRONMENT_FILTER_*
    bool by_luminance; // the short test also runs ESTIMATOR_MIS
};
enum { NEE_ALONE = 1, BSDF_ALONE = 2, EACH_ALONE = 3 };

// --- quadrature ----------------------------------------------------------------------------------

// Integrates max(0, n . d) over a texel, by the centres of PARTS x PARTS patches of equal solid
// angle.
#define PARTS 4

static double cosine_integral(const struct environment *e, uint32_t column, uint32_t row,
                              const double n[3])
{
    double top = cos(M_PI * row / e->height), bottom = cos(M_PI * (row + 1) / e->height), sum = 0;
    for (int i = 0; i < PARTS * PARTS; i++) {
        double y = top + (bottom - top) * (i / PARTS + 0.5) / PARTS, radius = sqrt(1 - y * y);
        double angle = 2 * M_PI * ((column + (i % PARTS + 0.5) / PARTS) / e->width - 0.5);
        angle -= e->rotation; // from +X towards +Z, opposite to the rotation of the environment
        double cosine = n[0] * radius * cos(angle) + n[1] * y + n[2] * radius * sin(angle);
        sum += fmax(cosine, 0);
    }
    return sum / (PARTS * PARTS) * environment_texel_solid_angle(e, row);
}

static void integrate_texels(const struct environment *e, const double n[3], double irradiance[3])
{
    for (uint32_t row = 0; row < e->height; row++)
        for (uint32_t column = 0; column < e->width; column++) {
            const float *texel = e->texels[row * e->width + column];
            if (!(texel[0] > 0 || texel[1] > 0 || texel[2] > 0))
                continue;
            double weight = cosine_integral(e, column, row, n);
            for (int c = 0; c < 3; c++)
                irradiance[c] += weight * (double)texel[c] * (double)e->radiance[c];
        }
}

// Integrates max(0, n . d) times each corner's weight over a cell between the centres of texels, by
// the centres of patches of equal angles.
static void corner_integrals(const struct environment *e, uint32_t column, uint32_t row,
                             const double n[3], double weights[4])
{
    double top = reference_node_angle(e, row), height = reference_node_angle(e, row + 1) - top;
    for (int i = 0; i < PARTS * PARTS; i++) {
        double down = (i / PARTS + 0.5) / PARTS, right = (i % PARTS + 0.5) / PARTS;
        double angle = top + height * down, radius = sin(angle);
        double around = 2 * M_PI * ((column + 0.5 + right) / e->width - 0.5) - e->rotation;
        double cosine = radius * (n[0] * cos(around) + n[2] * sin(around)) + n[1] * cos(angle);
        double part = fmax(cosine, 0) * radius * height * 2 * M_PI / e->width / (PARTS * PARTS);
        for (int corner = 0; corner < 4; corner++)
            weights[corner] +=
                part * (corner / 2 ? down : 1 - down) * (corner % 2 ? right : 1 - right);
    }
}

static void integrate_cells(const struct environment *e, const double n[3], double irradiance[3])
{
    for (uint32_t row = 0; row <= e->height; row++)
        for (uint32_t column = 0; column < e->width; column++) {
            double rgb[4][3], weights[4] = {0, 0, 0, 0}, most = 0;
            reference_corners(e, row, column, rgb);
            for (int i = 0; i < 12; i++)
                most = fmax(most, rgb[i / 3][i % 3]);
            if (most > 0)
                corner_integrals(e, column, row, n, weights);
            for (int i = 0; i < 12; i++)
                irradiance[i % 3] +=
                    weights[i / 3] * rgb[i / 3][i % 3] * (double)e->radiance[i % 3];
        }
}

static void integrate(const struct scene *scene, const double n[3], double irradiance[3])
{
    if (scene->settings.environment_filter == ENVIRONMENT_FILTER_NEAREST)
        integrate_texels(&scene->environment, n, irradiance);
    else
        integrate_cells(&scene->environment, n, irradiance);
}

// --- surroundings --------------------------------------------------------------------------------

static bool set_image(struct scene *scene, uint32_t width, uint32_t height, struct err *err)
{
    struct environment *e = &scene->environment;
    *e = (struct environment){
        .present = true, .radiance = {1, 2, 4}, .width = width, .height = height};
    e->texels = arena_alloc(&scene->arena, (uint64_t)width * height, sizeof *e->texels);
    return e->texels || err_memory(err, "texels", (uint64_t)width * height * sizeof *e->texels);
}

// docs/verification.md, C33: one texel of radiance 1e6, with a width of about a degree of
// longitude, among others of radiance `parameter`. C34: far beyond half precision.
#define SUN_WIDTH 1024
#define SUN_HEIGHT 512
#define SUN_ROW 140
#define SUN_COLUMN 700

static bool surround_with_sun(struct scene *scene, const struct form *form, double irradiance[3],
                              struct err *err)
{
    float sun = 1e6f;
    if (!set_image(scene, SUN_WIDTH, SUN_HEIGHT, err))
        return false;
    for (uint32_t i = 0; i < SUN_WIDTH * SUN_HEIGHT; i++)
        for (int c = 0; c < 3; c++)
            scene->environment.texels[i][c] = (float)form->parameter;
    for (int c = 0; c < 3; c++)
        scene->environment.texels[SUN_ROW * SUN_WIDTH + SUN_COLUMN][c] = sun;
    integrate(scene, form->normal, irradiance);
    return true;
}

// An image with few texels, every third of which is black, so that cells extend across poles and
// edges. The quadrature needs more points than for fine images: 64 x 64 per texel.
static bool surround_with_chart(struct scene *scene, const struct form *form, double irradiance[3],
                                struct err *err)
{
    enum { FINE = 64 };
    uint32_t width = (uint32_t)form->parameter, height = (width + 1) / 2;
    if (!set_image(scene, width, height, err))
        return false;
    struct environment *e = &scene->environment;
    e->rotation = form->rotation;
    for (uint32_t i = 0; i < width * height; i++)
        for (int c = 0; c < 3; c++)
            e->texels[i][c] = i % 3 == 1 ? 0.0f : (float)(1 + i * (1 + (uint32_t)c) % 7);
    for (uint32_t i = 0; i < FINE * FINE * width * height; i++) {
        double angle = M_PI * (i / (FINE * width) + 0.5) / (FINE * height), rgb[3];
        double around = 2 * M_PI * ((i % (FINE * width) + 0.5) / (FINE * width) - 0.5);
        const double d[3] = {sin(angle) * cos(around), cos(angle), sin(angle) * sin(around)};
        const struct reference_place place = reference_place_of(e, d);
        double c = cos(e->rotation), s = sin(e->rotation);
        double cosine = form->normal[0] * (c * d[0] + s * d[2]) + form->normal[1] * d[1] +
                        form->normal[2] * (c * d[2] - s * d[0]);
        double part =
            fmax(cosine, 0) * sin(angle) * 2 * M_PI * M_PI / (FINE * FINE * width * height);
        reference_radiance(e, &place, rgb);
        for (int k = 0; k < 3; k++)
            irradiance[k] += part * rgb[k] * (double)e->radiance[k];
    }
    return true;
}

static bool surround_with_file(struct scene *scene, const struct form *form, const char *file,
                               double irradiance[3], struct err *err)
{
    const float factor[3] = {1, 2, 4};
    if (!scene_set_environment(scene, file, factor, err))
        return false;
    scene->environment.rotation = form->rotation;
    integrate(scene, form->normal, irradiance);
    return true;
}

static bool surround_with_data(struct scene *scene, const struct form *form, double irradiance[3],
                               struct err *err)
{
    static const char *const files[] = {"museum.exr", "std_env.hdr"};
    const char *folder = getenv("LAMPYRIS_DATA"), *root = getenv("LAMPYRIS_SOURCE_ROOT");
    char path[4096];
    if (folder)
        snprintf(path, sizeof path, "%s/env/%s", folder, files[(int)form->parameter]);
    else
        snprintf(path, sizeof path, "%s/../shared/data/env/%s", root ? root : ".",
                 files[(int)form->parameter]);
    FILE *file = fopen(path, "rb");
    if (!file) {
        irradiance[0] = -1; // the light is below the horizon, so nothing is tested
        return true;
    }
    fclose(file);
    return surround_with_file(scene, form, path, irradiance, err);
}

static bool surround_with_sky(struct scene *scene, const struct form *form, double irradiance[3],
                              struct err *err)
{
    struct sky sky = sky_default();
    sky_place_sun(&sky, form->parameter, 130);
    if (!scene_set_sky(scene, &sky, err) ||
        !scene_adjust_environment(scene, form->rotation, 1, err) || !scene_add_sky_sun(scene, err))
        return false;
    integrate(scene, form->normal, irradiance);
    const struct light *sun = &scene->lights[scene->light_count - 1];
    for (int c = 0; c < 3; c++) {
        double cosine = 0;
        for (int i = 0; i < 3; i++)
            cosine -= sun->direction[i] * form->normal[i];
        irradiance[c] += fmax(cosine, 0) * (double)sun->radiant[c];
    }
    return true;
}

// The irradiance of a sun on a plane is the stated one times the cosine, for any width, if all of
// the sun is above the horizon.
static bool surround_with_light(struct scene *scene, const struct form *form, double irradiance[3],
                                struct err *err)
{
    struct light *light = scene_add_light(scene, NULL);
    if (!light)
        return err_memory(err, "a light", sizeof *light);
    *light = (struct light){.name = "",
                            .kind = LIGHT_DIRECTIONAL,
                            .direction = {0, -1, 0},
                            .radiant = {1, 2, 4},
                            .range = INFINITY,
                            .angular_radius = form->parameter * M_PI / 360};
    for (int c = 0; c < 3; c++)
        irradiance[c] = form->normal[1] * (1 << c);
    return true;
}

// A constant image is seen through a veil around the camera, which transmits 0.7, or in a ball of
// glass in place of the plane, through which the environment is visible.
static bool surround_with_shape(struct scene *scene, const struct form *form, double irradiance[3],
                                struct err *err)
{
    bool is_glass = form->parameter > 0;
    if (!set_image(scene, 3, 2, err))
        return false;
    for (int i = 0; i < 18; i++)
        scene->environment.texels[i / 3][i % 3] = 1;
    if (is_glass)
        scene->shape_count = 0;
    struct shape *shape = scene_add_shape(scene, NULL);
    if (!shape)
        return err_memory(err, "a shape", sizeof *shape);
    *shape = (struct shape){.kind = SHAPE_SPHERE, .radius = is_glass ? 2e-4 : 1};
    const char *name = is_glass ? "glass" : "veil";
    while (strcmp(scene->materials[shape->material].name, name) != 0)
        shape->material++;
    // Glass is in the place of the plane, so the visible radiance is the environment's.
    for (int c = 0; c < 3; c++)
        irradiance[c] = M_PI * (1 << c) * (is_glass ? 1 / albedo[c] : 0.7);
    return true;
}

// clang-format off
#define UP {0, 1, 0}
#define TILTED {0.48, 0.6, 0.64}
#define ASIDE {-0.64, 0.48, -0.6}
// clang-format on

static const struct form forms[] = {
    {"C33 texel, tilted", surround_with_sun, 0.5, TILTED, 0, NEE_ALONE},
    {"C33 patch, tilted", surround_with_sun, 0.5, TILTED, 0, NEE_ALONE, ENVIRONMENT_FILTER_NEAREST},
    {"4 x 2", surround_with_chart, 4, TILTED, 1, EACH_ALONE, .by_luminance = true},
    {"5 x 3", surround_with_chart, 5, ASIDE, 0, EACH_ALONE},
    {"museum of patches", surround_with_data, 0, ASIDE, 1, EACH_ALONE, ENVIRONMENT_FILTER_NEAREST,
     true},
    {"museum", surround_with_data, 0, UP, 0, EACH_ALONE},
    {"museum, tilted, turned", surround_with_data, 0, TILTED, 1.25, EACH_ALONE,
     .by_luminance = true},
    {"museum, aside", surround_with_data, 0, ASIDE, -2, EACH_ALONE},
    {"std_env", surround_with_data, 1, UP, 0, EACH_ALONE},
    {"std_env, tilted, turned", surround_with_data, 1, TILTED, 4, EACH_ALONE},
    {"sky, sun at 60 degrees", surround_with_sky, 60, UP, 0, NEE_ALONE, .by_luminance = true},
    {"sky, sun at 10, turned", surround_with_sky, 10, TILTED, 2, NEE_ALONE},
    {"sun of 0.0001 degrees", surround_with_light, 1e-4, TILTED, 0, NEE_ALONE},
    {"sun of 0.53 degrees", surround_with_light, 0.53, TILTED, 0, NEE_ALONE},
    {"sun of 20 degrees", surround_with_light, 20, TILTED, 0, EACH_ALONE},
    {"even image, veiled", surround_with_shape, 0, UP, 0, EACH_ALONE},
    {"even image behind glass", surround_with_shape, 1, UP, 0, 0},
    {"sun of 180 degrees", surround_with_light, 180, UP, 0, EACH_ALONE},
};

#define FORM_COUNT (sizeof forms / sizeof forms[0])

// --- trials --------------------------------------------------------------------------------------

static bool load_plane(const struct form *form, struct scene *scene, double irradiance[3],
                       struct err *err)
{
    const double *n = form->normal;
    char normal[128], eye[128];
    snprintf(normal, sizeof normal, "[%.17g, %.17g, %.17g]", n[0], n[1], n[2]);
    snprintf(eye, sizeof eye, "[%.17g, %.17g, %.17g]", n[0] * 5e-4, n[1] * 5e-4, n[2] * 5e-4);
    const struct scene_override overrides[] = {{"normal", normal}, {"eye", eye}, {0}};
    if (!load_scene("src/check/scenes/plane.json", overrides, scene, err))
        return false;
    scene->environment = (struct environment){0};
    scene->settings.environment_filter = form->filter;
    for (int c = 0; c < 3; c++)
        irradiance[c] = 0;
    return form->surround(scene, form, irradiance, err);
}

static void check_channel(const struct form *form, const struct replicates *replicates, int c,
                          double irradiance, double half_width)
{
    struct estimate e = replicates_estimate(replicates, (uint32_t)c);
    double expected = albedo[c] / M_PI * irradiance, bias = e.mean - expected;
    double t = bias / e.standard_error;
    printf("  %+.1e (t %+.1f) +-%.1e", bias / expected, t, e.half_width / expected);
    CHECK(fabs(t) <= REPLICATES_T_MAX || fabs(bias) <= ROUNDING_MAX * expected,
          "%s, channel %d: mean %.9g, expected %.9g: t = %.2f", form->name, c, e.mean, expected, t);
    CHECK(e.half_width <= half_width * expected, "%s, channel %d: half-width %.3g of the value",
          form->name, c, e.half_width / expected);
    CHECK(fabs(bias) <= (BIAS_MAX + half_width) * expected, "%s, channel %d: mean %.9g, not %.9g",
          form->name, c, e.mean, expected);
}

static void check_form(struct gpu *gpu, uint32_t index, enum light_estimator estimator,
                       uint64_t most, double half_width)
{
    static const char *const names[] = {
        [ESTIMATOR_MIS] = "mis",
        [ESTIMATOR_NEE] = "nee",
        [ESTIMATOR_BSDF] = "bsdf",
        [ESTIMATOR_COMPENSATED] = "compensated",
    };
    const struct form *form = &forms[index];
    uint64_t start = clock_ns(), samples;
    double irradiance[3];
    struct scene scene;
    struct renderer r;
    struct replicates replicates;
    struct err err = {0};
    REQUIRE_OK(load_plane(form, &scene, irradiance, &err));
    if (irradiance[0] < 0) {
        printf("%-26s no data\n", form->name);
        scene_finish(&scene);
        return;
    }
    set_estimator(&scene.settings, estimator);
    const struct renderer_params params = {.gpu = gpu, .scene = &scene};
    REQUIRE_OK(renderer_create(&params, &r, &err));
    REQUIRE_OK(replicates_pilot(&r, &MEASURE_MEAN, half_width, most, &samples, &err));
    REQUIRE_OK(replicates_render(&r, &MEASURE_MEAN, 6400 + 200 * index + REPLICATES * estimator,
                                 samples, &replicates, &err));
    printf("%-26s %-11s", form->name, names[estimator]);
    for (int c = 0; c < 3; c++)
        check_channel(form, &replicates, c, irradiance[c], half_width);
    printf("  %" PRIu64 " spp, %.1f s\n", samples, clock_seconds_since(start));
    renderer_finish(&r);
    scene_finish(&scene);
}

TEST(by_default)
{
    struct gpu gpu;
    OPEN_GPU(&gpu, 0);
    for (uint32_t i = 0; i < FORM_COUNT; i++) {
        check_form(&gpu, i, ESTIMATOR_COMPENSATED, MOST_SAMPLES, 3e-3);
        if (forms[i].by_luminance)
            check_form(&gpu, i, ESTIMATOR_MIS, MOST_SAMPLES, 3e-3);
    }
    gpu_close(&gpu);
}

TEST(by_every_estimator)
{
    struct gpu gpu;
    OPEN_GPU(&gpu, 0);
    for (uint32_t i = 0; i < FORM_COUNT; i++) {
        check_form(&gpu, i, ESTIMATOR_MIS, MOST_SAMPLES, HALF_WIDTH_MAX);
        check_form(&gpu, i, ESTIMATOR_COMPENSATED, MOST_SAMPLES, HALF_WIDTH_MAX);
        if (forms[i].alone & NEE_ALONE)
            check_form(&gpu, i, ESTIMATOR_NEE, 4 * MOST_SAMPLES, HALF_WIDTH_MAX);
        if (forms[i].alone & BSDF_ALONE)
            check_form(&gpu, i, ESTIMATOR_BSDF, 8 * MOST_SAMPLES, 2 * HALF_WIDTH_MAX);
    }
    gpu_close(&gpu);
}

// --- what the camera sees ------------------------------------------------------------------------

// The camera looks upwards. In each pixel, the radiance of a sun is its irradiance over pi sin^2 of
// its radius, added to the environment behind it.
TEST(seen_by_the_camera)
{
    static const struct form form = {"", surround_with_light, 2, UP, 0, 0};
    struct gpu gpu;
    struct scene scene;
    struct arena arena = {0};
    struct film_image film;
    struct err err = {0};
    double irradiance[3];
    OPEN_GPU(&gpu, .validation = true);
    REQUIRE_OK(load_plane(&form, &scene, irradiance, &err));
    REQUIRE_OK(set_image(&scene, 1, 1, &err));
    scene.environment.texels[0][0] = 7;
    scene.cameras[0].direction[1] = 1;
    const struct renderer_params params = {.gpu = &gpu, .scene = &scene};
    REQUIRE_OK(render_film(&params, 1, &arena, &film, NULL, &err));
    double sine = sin(M_PI / 180), worst = 0;
    for (uint32_t i = 0; i < film.width * film.height; i++)
        for (int c = 0; c < 3; c++) {
            double expected = (1 << c) / (M_PI * sine * sine) + (c == 0 ? 7 : 0);
            worst = fmax(worst, fabs((double)film.mean[i][c] / expected - 1));
        }
    printf("  off by %.1e at most\n", worst);
    CHECK(worst <= 1e-6, "%g", worst);
    CHECK(gpu.validation_messages == 0, "%u messages", gpu.validation_messages);
    arena_finish(&arena);
    scene_finish(&scene);
    gpu_close(&gpu);
}

// There is no light because of the texels, of the factor, or because only texels below the plane
// emit (docs/verification.md, C35).
static bool surround_with_black(struct scene *scene, const struct form *form, double irradiance[3],
                                struct err *err)
{
    if (!set_image(scene, 5, 3, err))
        return false;
    float *texel = scene->environment.texels[form->parameter == 1 ? 2 : 12];
    for (int c = 0; c < 3; c++) {
        texel[c] = form->parameter > 0 ? 1e6f : 0;
        irradiance[c] = 0;
        if (form->parameter == 1)
            scene->environment.radiance[c] = 0;
    }
    return true;
}

TEST(black_surroundings)
{
    struct gpu gpu;
    OPEN_GPU(&gpu, .validation = true);
    for (int variant = 0; variant < 3; variant++) {
        const struct form form = {"", surround_with_black, variant, UP, 0, 0};
        struct scene scene;
        struct arena arena = {0};
        struct film_image film;
        struct render_stats stats;
        struct err err = {0};
        double irradiance[3], sum = 0;
        REQUIRE_OK(load_plane(&form, &scene, irradiance, &err));
        const struct renderer_params params = {.gpu = &gpu, .scene = &scene};
        REQUIRE_OK(render_film(&params, 4, &arena, &film, &stats, &err));
        for (uint32_t i = 0; i < film.width * film.height; i++)
            for (int c = 0; c < 3; c++)
                sum += fabs((double)film.mean[i][c]);
        CHECK(sum == 0, "variant %d: %g", variant, sum);
        for (int site = 0; site < SITE_COUNT; site++)
            CHECK(stats.nonfinite.count[site] == 0, "variant %d, site %d", variant, site);
        arena_finish(&arena);
        scene_finish(&scene);
    }
    CHECK(gpu.validation_messages == 0, "%u messages", gpu.validation_messages);
    gpu_close(&gpu);
}

// Other wave sizes, and all features compiled in, give the same bits.
TEST(same_bits)
{
    static const struct form form = {"", surround_with_sky, 40, TILTED, 1, 0};
    static const struct renderer_params kinds[3] = {
        {.wave = 0}, {.wave = 1024}, {.compile_all = true}};
    struct gpu gpu;
    struct scene scene;
    struct arena arena = {0};
    struct film_image films[3];
    struct err err = {0};
    double irradiance[3];
    OPEN_GPU(&gpu, 0);
    REQUIRE_OK(load_plane(&form, &scene, irradiance, &err));
    for (int i = 0; i < 3; i++) {
        struct renderer_params params = kinds[i];
        params.gpu = &gpu;
        params.scene = &scene;
        REQUIRE_OK(render_film(&params, 8, &arena, &films[i], NULL, &err));
        size_t bytes = (size_t)films[i].width * films[i].height * sizeof *films[i].mean;
        CHECK(memcmp(films[i].mean, films[0].mean, bytes) == 0, "picture %d differs", i);
    }
    arena_finish(&arena);
    scene_finish(&scene);
    gpu_close(&gpu);
}

TEST_MAIN(TEST_CASE(seen_by_the_camera), TEST_CASE(black_surroundings), TEST_CASE(same_bits),
          TEST_CASE(by_default), TEST_CASE(by_every_estimator))
