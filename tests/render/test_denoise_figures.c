// Measures the error of the denoised preview and of its film: it must be smaller as long as there
// is noise, and not larger if there is little. With LAMPYRIS_PICTURES=FOLDER in the environment,
// the pictures are written there.
#include "denoise_fixture.h"
#include "image/image.h"
#include "metrics/metrics.h"

enum { COUNTS = 5 };
static const uint32_t counts[COUNTS] = {1, 4, 16, 64, 256};

struct case_of_scene {
    const char *name, *path, *width, *height;
    bool painted;
    uint32_t reference;    // number of samples
    double limits[COUNTS]; // limits of the denoised relMSE, as a fraction of the film's
};

// Adds tiles to all white surfaces: squares of two colours, and lines one texel wide.
static void paint_tiles(struct scene *scene)
{
    enum { SIZE = 32 };
    static float texels[SIZE][SIZE][4];
    static const float colors[3][4] = {
        {1, 0.9f, 0.7f, 1}, {0.35f, 0.2f, 0.1f, 1}, {0.1f, 0.1f, 0.1f, 1}};
    uint32_t first;
    struct texture_image *image = scene_add_image(scene, NULL);
    struct texture *texture = scene_add_texture(scene, &first);
    *image = (struct texture_image){.name = "tiles", .width = SIZE, .height = SIZE};
    for (int i = 0; i < SIZE * SIZE; i++) {
        int x = i % SIZE, y = i / SIZE;
        const float *color = colors[x % 8 == 0 || y % 8 == 0 ? 2 : (x / 8 + y / 8) % 2];
        memcpy(texels[y][x], color, sizeof texels[y][x]);
        for (int c = 0; c < 4; c++)
            image->mean[c] += color[c] / (SIZE * SIZE);
    }
    image->texels = (const void *)texels;
    *texture = (struct texture){
        .flags = TEXTURE_USE_SCALE << TEXTURE_USE_SHIFT | GROUP_BASE << TEXTURE_GROUP_SHIFT |
                 7u << TEXTURE_MASK_SHIFT | 0x24u << TEXTURE_CHANNELS_SHIFT,
        .transform = {{2, 0, 0}, {0, 2, 0}},
    };
    for (uint32_t m = 0; m < scene->material_count; m++)
        if (strcmp(scene->materials[m].name, "white") == 0) {
            scene->materials[m].first_texture = first;
            scene->materials[m].texture_count = 1;
        }
}

struct bench {
    struct gpu gpu;
    struct scene scene;
    struct renderer renderer;
    struct denoiser denoiser;
    struct arena arena;
    struct film_image reference;
    float (*denoised)[3];
    struct err err;
};

static bool bench_open(struct bench *b, const struct case_of_scene *c)
{
    const struct scene_override overrides[] = {
        {"film.width", c->width}, {"film.height", c->height}, {0}};
    if (!load_scene(c->path, overrides, &b->scene, &b->err))
        return false;
    if (c->painted)
        paint_tiles(&b->scene);
    const struct renderer_params params = {
        .gpu = &b->gpu, .scene = &b->scene, .aovs = DENOISE_AOVS, .open_ended = true};
    return renderer_create(&params, &b->renderer, &b->err) &&
           denoiser_create(&b->gpu, &b->denoiser, &b->err);
}

static void bench_close(struct bench *b)
{
    denoiser_finish(&b->denoiser);
    renderer_finish(&b->renderer);
    scene_finish(&b->scene);
    arena_finish(&b->arena);
    gpu_close(&b->gpu);
    CHECK(b->gpu.validation_messages == 0, "%u validation messages", b->gpu.validation_messages);
}

static bool bench_render(struct bench *b, uint64_t samples)
{
    const struct render_call call = {.samples = samples};
    return renderer_render(&b->renderer, &call, &b->err);
}

static bool bench_denoise(struct bench *b, const struct camera *camera, bool temporal)
{
    const struct denoise_call call = {
        .renderer = &b->renderer, .camera = camera, .temporal = temporal};
    uint64_t pixels = (uint64_t)b->renderer.frame.width * b->renderer.frame.height;
    float(*picture)[4] = arena_alloc(&b->arena, pixels, sizeof *picture);
    b->denoised = arena_alloc(&b->arena, pixels, sizeof *b->denoised);
    if (!picture || !b->denoised || !denoiser_run(&b->denoiser, &call, &b->err) ||
        !gpu_download(&b->gpu, &b->denoiser.picture, 0, picture, pixels * sizeof *picture, &b->err))
        return false;
    for (uint64_t i = 0; i < pixels; i++)
        memcpy(b->denoised[i], picture[i], sizeof *b->denoised);
    return true;
}

static void write_picture(const struct bench *b, const char *name, const char *kind,
                          uint32_t samples, float (*pixels)[3])
{
    const char *folder = getenv("LAMPYRIS_PICTURES");
    char path[4096];
    struct err err = {0};
    if (!folder)
        return;
    snprintf(path, sizeof path, "%s/%s_%04u_%s.png", folder, name, samples, kind);
    const struct image image = {b->renderer.frame.width, b->renderer.frame.height, pixels};
    const struct image_write_params params = {.path = path,
                                              .image = &image,
                                              .exposure_stops = b->scene.settings.exposure,
                                              .tone = TONE_ACES};
    CHECK(image_write(&params, &err), "%s", err.msg);
}

static double relmse(const struct bench *b, const float (*pixels)[3])
{
    struct metrics metrics;
    metrics_compare(pixels, (const float(*)[3])b->reference.mean,
                    (uint64_t)b->reference.width * b->reference.height, NULL, &metrics);
    CHECK(metrics.nonfinite == 0, "%llu pixels are not finite",
          (unsigned long long)metrics.nonfinite);
    return metrics.relmse;
}

// Returns the mean squared change of pixels, as a fraction of the variance that the halves give.
static double moved(const struct bench *b, const struct film_image *film)
{
    double moves = 0, variances = 0;
    for (uint32_t i = 0; i < film->width * film->height; i++)
        for (int c = 0; c < 3; c++) {
            double truth = (double)b->reference.mean[i][c], weight = 1 / (truth * truth + 0.01);
            double move = (double)b->denoised[i][c] - (double)film->mean[i][c];
            double apart = (double)film->half_a[i][c] - (double)film->half_b[i][c];
            moves += weight * move * move;
            variances += weight * apart * apart / 4;
        }
    return moves / variances;
}

static void compare(struct bench *b, const struct case_of_scene *c)
{
    uint32_t done = 0;
    for (int i = 0; i < COUNTS; done = counts[i++]) {
        struct film_image film;
        REQUIRE(bench_render(b, counts[i] - done) && bench_denoise(b, b->scene.cameras, false) &&
                    renderer_read(&b->renderer, &b->arena, &film, &b->err),
                "%s", b->err.msg);
        double before = relmse(b, (const float(*)[3])film.mean);
        double after = relmse(b, (const float(*)[3])b->denoised);
        double moves = counts[i] > 1 ? moved(b, &film) : 0; // one sample gives no variance
        printf("  %s, %3u spp: relMSE %.6f, denoised %.6f (%.2f); moved by %.2f of the variance\n",
               c->name, counts[i], before, after, after / before, moves);
        CHECK(after <= c->limits[i] * before, "%s, %u spp: %g of the film's relMSE, expected %g",
              c->name, counts[i], after / before, c->limits[i]);
        CHECK(moves < 0.9, "%s, %u spp: moved by %g of the variance", c->name, counts[i], moves);
        write_picture(b, c->name, "film", counts[i], film.mean);
        write_picture(b, c->name, "denoised", counts[i], b->denoised);
    }
}

static void run_case(const struct case_of_scene *c)
{
    struct bench b = {0};
    OPEN_GPU(&b.gpu, .validation = true);
    REQUIRE(bench_open(&b, c) && bench_render(&b, c->reference) &&
                renderer_read(&b.renderer, &b.arena, &b.reference, &b.err) &&
                renderer_restart(&b.renderer, 17, &b.err),
            "%s", b.err.msg);
    write_picture(&b, c->name, "reference", c->reference, b.reference.mean);
    compare(&b, c);
    bench_close(&b);
}

#define CORNELL "scenes/cornell.json"

TEST(cornell)
{
    run_case(&(struct case_of_scene){
        "cornell", CORNELL, "80", "80", false, 512, {0.3, 0.3, 0.4, 0.6, 0.9}});
}

TEST(tiles)
{
    run_case(&(struct case_of_scene){
        "tiles", CORNELL, "80", "80", true, 512, {0.6, 0.6, 0.65, 0.8, 0.95}});
}

TEST(spheres)
{
    run_case(&(struct case_of_scene){
        "spheres", "scenes/spheres.json", "96", "60", false, 512, {1, 0.9, 0.9, 1.1, 1.25}});
}

static const struct case_of_scene long_cases[] = {
    {"cornell", CORNELL, "128", "128", false, 2048, {0.3, 0.3, 0.3, 0.5, 0.8}},
    {"tiles", CORNELL, "128", "128", true, 2048, {0.6, 0.6, 0.6, 0.8, 0.95}},
    {"spheres", "scenes/spheres.json", "160", "100", false, 2048, {1, 0.9, 0.9, 1.1, 1.25}},
};

TEST(figures_long)
{
    for (int i = 0; i < 3; i++)
        run_case(&long_cases[i]);
}

// --- while the camera moves ----------------------------------------------------------------------

// Rotates the camera about +Y, around the middle of the box.
static void turn(struct camera *camera, double degrees)
{
    const double a = degrees * M_PI / 180, middle[] = {0.278, 0.273, 0.28};
    double x = camera->position[0] - middle[0], z = camera->position[2] - middle[2];
    double dx = camera->direction[0], dz = camera->direction[2];
    camera->position[0] = middle[0] + x * cos(a) + z * sin(a);
    camera->position[2] = middle[2] - x * sin(a) + z * cos(a);
    camera->direction[0] = dx * cos(a) + dz * sin(a);
    camera->direction[2] = -dx * sin(a) + dz * cos(a);
}

// There is one sample per frame and a degree between frames, so the history replaces samples.
static void move(struct bench *b)
{
    struct camera camera = b->scene.cameras[0], end = camera;
    uint32_t width = b->renderer.frame.width, height = b->renderer.frame.height;
    const struct denoise_call keep = {
        .renderer = &b->renderer, .camera = &camera, .temporal = true};
    bool fits = true;
    turn(&end, 8);
    REQUIRE(renderer_set_camera(&b->renderer, &end, width, height, &fits, &b->err) && fits &&
                bench_render(b, 512) &&
                renderer_read(&b->renderer, &b->arena, &b->reference, &b->err),
            "%s", b->err.msg);
    for (int frame = 0; frame <= 8; frame++) {
        camera = b->scene.cameras[0];
        turn(&camera, frame);
        b->renderer.frame.seed = 100 + (uint32_t)frame;
        REQUIRE(renderer_set_camera(&b->renderer, &camera, width, height, &fits, &b->err) && fits &&
                    bench_render(b, 1),
                "%s", b->err.msg);
        if (frame < 8)
            REQUIRE(denoiser_keep(&b->denoiser, &keep, &b->err), "%s", b->err.msg);
    }
    REQUIRE(bench_denoise(b, &camera, false), "%s", b->err.msg);
    write_picture(b, "moving", "alone", 1, b->denoised);
    double alone = relmse(b, (const float(*)[3])b->denoised);
    REQUIRE(bench_denoise(b, &camera, true), "%s", b->err.msg);
    write_picture(b, "moving", "history", 1, b->denoised);
    double with_history = relmse(b, (const float(*)[3])b->denoised);
    printf("  after 8 frames of one sample: relMSE %.5f alone, %.5f with the history\n", alone,
           with_history);
    CHECK(with_history < 0.85 * alone, "%g of %g", with_history, alone);
}

TEST(moving)
{
    struct bench b = {0};
    OPEN_GPU(&b.gpu, .validation = true);
    REQUIRE(bench_open(&b, &(struct case_of_scene){"moving", CORNELL, "96", "96"}), "%s",
            b.err.msg);
    move(&b);
    bench_close(&b);
}

TEST_MAIN(TEST_CASE(cornell), TEST_CASE(tiles), TEST_CASE(spheres), TEST_CASE(moving),
          TEST_CASE(figures_long))
