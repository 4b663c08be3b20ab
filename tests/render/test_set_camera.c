// Tests the requests of a viewer to a renderer: another camera and another size without creating it
// again (with the same bits as a new renderer), kernels compiled in the meantime, and small steps.
#include "render/probe/replay.h"
#include "render_fixture.h"
#include "shared/methods.h"
#include <math.h>

#define ROOM_WIDTH 48u // width of the largest picture
#define ROOM_HEIGHT 32u
#define SAMPLES 3u // not a power of two, so that passes have several sizes

struct look_case {
    const char *name, *path;
    struct gpu_limit_overrides limits;
    uint32_t sampler, halves, integrator, camera_kind, aovs;
    bool lens, compile_all, validation;
    double inside[3]; // a point inside a transmissive object; y = 0: there is none
};

#define ALL_AOVS (AOV_END - 1u)

static const struct look_case setups[] = {
    {"plain", "scenes/cornell.json", {0}},
    {"all classes and media",
     "scenes/all_classes.json",
     {0},
     .aovs = ALL_AOVS,
     .inside = {1.25, 0.35, 0.45}},
    {"nested media",
     "scenes/glass.json",
     {0},
     .halves = HALVES_CONTIGUOUS,
     .validation = true,
     .inside = {0.005, 0.03, 0.005}},
    {"film in pieces", "scenes/glow_worms.json", {.storage_range = 1u << 16}},
    {"pieces of layers, copies",
     "scenes/glow_worms.json",
     {.storage_range = 1u << 16, .no_mapped_device = true, .no_texel = true},
     .aovs = ALL_AOVS,
     .validation = true},
    {"blue noise", "scenes/cornell.json", {0}, .sampler = SAMPLER_BLUE_NOISE},
    {"strata, lens", "scenes/cornell.json", {0}, .sampler = SAMPLER_STRATIFIED, .lens = true},
    {"everything", "scenes/all_classes.json", {0}, .compile_all = true},
    {"panorama", "scenes/cornell.json", {0}, .camera_kind = CAMERA_PANORAMIC},
    {"parallel", "scenes/veach_mis.json", {0}, .camera_kind = CAMERA_ORTHOGRAPHIC},
    {"occlusion", "scenes/all_classes.json", {0}, .integrator = INTEGRATOR_AO},
    {"whitted", "scenes/all_classes.json", {0}, .integrator = INTEGRATOR_WHITTED},
};

// A camera and a size, which are set in sequence.
struct look {
    struct camera camera;
    uint32_t width, height;
};
#define LOOKS 6

static const uint32_t sizes[LOOKS][2] = {
    {48, 32}, {24, 16}, {17, 23}, {32, 48}, {1, 1}, {48, 32},
};

static void turn(struct camera *camera, double x, double y)
{
    double square = 0.0;
    camera->direction[0] += x;
    camera->direction[1] += y;
    for (int c = 0; c < 3; c++)
        square += camera->direction[c] * camera->direction[c];
    for (int c = 0; c < 3; c++)
        camera->direction[c] /= sqrt(square);
}

// The scene's camera, others, and the scene's again; one of them is at the place that the case
// gives.
static void choose_looks(const struct look_case *c, const struct scene *scene,
                         struct look looks[LOOKS])
{
    for (int i = 0; i < LOOKS; i++) {
        struct camera *camera = &looks[i].camera;
        *camera = scene->cameras[0];
        looks[i].width = sizes[i][0];
        looks[i].height = sizes[i][1];
        if (i == 0 || i == LOOKS - 1)
            continue;
        turn(camera, 0.07 * i - 0.2, 0.05);
        camera->position[0] += 0.01 * i;
        camera->fov_y *= 1.0 + 0.1 * i;
        camera->height *= 1.0 + 0.1 * i;
        camera->lens_radius *= i == 3 ? 0.0 : i;
        camera->focus_distance *= 0.9;
        if (i == 2 && c->inside[1] != 0.0)
            memcpy(camera->position, c->inside, sizeof c->inside);
    }
}

static bool render_and_read(struct renderer *r, struct arena *arena, struct film_image *film,
                            struct err *err)
{
    const struct render_call call = {.samples = SAMPLES};
    return renderer_render(r, &call, err) && renderer_read(r, arena, film, err);
}

// Renders with a renderer of its own.
static bool render_anew(const struct renderer_params *params, const struct look *look,
                        struct arena *arena, struct film_image *film, struct err *err)
{
    struct scene scene = *params->scene;
    struct camera camera = look->camera;
    struct renderer_params own = *params;
    scene.cameras = &camera;
    scene.settings.width = look->width;
    scene.settings.height = look->height;
    own.scene = &scene;
    return render_film(&own, SAMPLES, arena, film, NULL, err);
}

static bool same_layer(const void *a, const void *b, size_t bytes)
{
    return (!a && !b) || (a && b && memcmp(a, b, bytes) == 0);
}

static bool same_layers(const struct film_aovs *a, const struct film_aovs *b, size_t pixels)
{
    size_t color = pixels * 3 * sizeof(float), scalar = pixels * sizeof(float);
    return same_layer(a->albedo, b->albedo, color) && same_layer(a->normal, b->normal, color) &&
           same_layer(a->normal_geometric, b->normal_geometric, color) &&
           same_layer(a->depth, b->depth, scalar) && same_layer(a->alpha, b->alpha, scalar) &&
           same_layer(a->position, b->position, color) &&
           same_layer(a->ids, b->ids, pixels * sizeof *a->ids) &&
           same_layer(a->emission, b->emission, color) && same_layer(a->direct, b->direct, color) &&
           same_layer(a->indirect, b->indirect, color) &&
           same_layer(a->variance, b->variance, color);
}

static bool same_bits(const struct film_image *a, const struct film_image *b)
{
    size_t pixels = (size_t)a->width * a->height;
    return a->width == b->width && a->height == b->height &&
           memcmp(a->mean, b->mean, pixels * sizeof *a->mean) == 0 &&
           memcmp(a->half_a, b->half_a, pixels * sizeof *a->half_a) == 0 &&
           memcmp(a->half_b, b->half_b, pixels * sizeof *a->half_b) == 0 &&
           memcmp(a->samples, b->samples, pixels * sizeof *a->samples) == 0 &&
           same_layers(&a->aovs, &b->aovs, pixels);
}

static double sum_of(const struct film_image *film)
{
    double sum = 0.0;
    for (size_t i = 0; i < (size_t)film->width * film->height; i++)
        for (int c = 0; c < 3; c++)
            sum += (double)film->mean[i][c];
    return sum;
}

static bool stop_at_once(void *context)
{
    bool *stops = context;
    return *stops;
}

// Interrupts a pass, so that some pixels have more samples than others.
static bool begin_something(struct renderer *r, bool *stops, struct err *err)
{
    bool stopped = false;
    const struct render_call call = {.samples = 16, .stopped = &stopped};
    *stops = true;
    bool ok = renderer_render(r, &call, err);
    *stops = false;
    return ok;
}

static void check_looks(struct renderer *r, const struct look looks[LOOKS],
                        const struct film_image expected[LOOKS], const struct look_case *c,
                        bool *stops)
{
    struct arena arena = {0};
    struct err err = {0};
    struct film_image film;
    double sums[LOOKS];
    for (int i = 0; i < LOOKS; i++) {
        const struct look *look = &looks[i];
        bool fits = false;
        REQUIRE_OK(begin_something(r, stops, &err));
        REQUIRE_OK(renderer_set_camera(r, &look->camera, look->width, look->height, &fits, &err));
        CHECK(fits, "%s: look %d does not fit", c->name, i);
        REQUIRE_OK(render_and_read(r, &arena, &film, &err));
        CHECK(same_bits(&film, &expected[i]), "%s: look %d differs", c->name, i);
        CHECK(expected[i].least_samples == SAMPLES && film.least_samples == SAMPLES,
              "%s: look %d lacks samples", c->name, i);
        sums[i] = sum_of(&film) / ((double)film.width * film.height);
        CHECK(sums[i] > 0.0 || i == 2 || i == 4, "%s: look %d is black", c->name, i);
    }
    CHECK(sums[0] != sums[1] && sums[1] != sums[2] && sums[0] == sums[LOOKS - 1],
          "%s: cameras make no difference", c->name);
    arena_finish(&arena);
}

static bool load_case(const struct look_case *c, struct scene *scene, struct err *err)
{
    if (!load_scene(c->path, NULL, scene, err))
        return false;
    struct settings *settings = &scene->settings;
    struct camera *camera = &scene->cameras[0];
    settings->width = ROOM_WIDTH;
    settings->height = ROOM_HEIGHT;
    settings->spp = SAMPLES;
    settings->max_bounces = 4;
    settings->sampler = c->sampler;
    settings->halves = c->halves;
    settings->integrator = c->integrator;
    camera->kind = c->camera_kind;
    camera->height = 6.0;
    camera->lens_radius = c->lens ? 0.02 : 0.0;
    camera->focus_distance = 2.0;
    return true;
}

static void check_case(const struct look_case *c)
{
    bool stops = false, ok = true;
    const struct progress progress = {.should_stop = stop_at_once, .context = &stops};
    struct arena arena = {0};
    struct scene scene;
    struct gpu gpu;
    struct renderer r;
    struct look looks[LOOKS];
    struct film_image expected[LOOKS];
    struct err err = {0};
    OPEN_GPU(&gpu, .validation = c->validation, .limits = c->limits);
    REQUIRE_OK(load_case(c, &scene, &err));
    struct renderer_params params = {
        .gpu = &gpu, .scene = &scene, .aovs = c->aovs, .compile_all = c->compile_all, .wave = 2048};
    params.progress = &progress;
    choose_looks(c, &scene, looks);
    for (int i = 0; i < LOOKS && ok; i++)
        ok = render_anew(&params, &looks[i], &arena, &expected[i], &err);
    ok = ok && renderer_create(&params, &r, &err);
    CHECK(ok, "%s: %s", c->name, err.msg);
    if (ok) {
        CHECK(!c->limits.storage_range || r.plan.film_chunks > 1, "%s: one film buffer", c->name);
        check_looks(&r, looks, expected, c, &stops);
        renderer_finish(&r);
    }
    CHECK(gpu.validation_messages == 0, "%s: %u messages", c->name, gpu.validation_messages);
    arena_finish(&arena);
    scene_finish(&scene);
    gpu_close(&gpu);
}

TEST(same_bits_as_a_new_renderer)
{
    for (size_t i = 0; i < sizeof setups / sizeof *setups; i++)
        check_case(&setups[i]);
}

// --- what does not fit ---------------------------------------------------------------------------

static void check_refused(struct renderer *r, const struct camera *camera, uint32_t width,
                          uint32_t height, const char *what)
{
    struct arena arena = {0};
    struct film_image before, after;
    struct err err = {0};
    bool fits = true;
    REQUIRE_OK(renderer_read(r, &arena, &before, &err));
    REQUIRE_OK(renderer_set_camera(r, camera, width, height, &fits, &err));
    CHECK(!fits, "%s fits", what);
    REQUIRE_OK(renderer_read(r, &arena, &after, &err));
    CHECK(same_bits(&before, &after) && before.least_samples == 2, "%s changed the film", what);
    CHECK(memcmp(&r->camera, &r->scene->cameras[0], sizeof r->camera) == 0, "%s was taken", what);
    arena_finish(&arena);
}

static void refuse(struct gpu *gpu, const struct scene *scene, bool tiles)
{
    struct renderer r;
    struct err err = {0};
    const struct renderer_params params = {.gpu = gpu, .scene = scene, .tiles = tiles};
    const struct render_call call = {.samples = 2};
    const struct camera own = scene->cameras[0];
    struct camera camera = own;
    REQUIRE_OK(renderer_create(&params, &r, &err));
    REQUIRE_OK(tiles || renderer_render(&r, &call, &err));
    if (tiles) {
        bool fits = true;
        REQUIRE_OK(renderer_set_camera(&r, &own, 4, 4, &fits, &err));
        CHECK(!fits, "tiles fit");
    } else {
        check_refused(&r, &own, ROOM_WIDTH, ROOM_HEIGHT + 1, "a larger picture");
        camera.kind = CAMERA_PANORAMIC;
        check_refused(&r, &camera, 4, 4, "another kind of camera");
        camera = own;
        camera.lens_radius = 0.1;
        camera.focus_distance = 1.0;
        check_refused(&r, &camera, 4, 4, "a lens");
        camera = own;
        for (uint32_t i = 0; i < scene->shape_count; i++) {
            const struct shape *shape = &scene->shapes[i];
            if (shape->kind != SHAPE_SPHERE)
                continue;
            memcpy(camera.position, shape->center, sizeof camera.position);
            camera.position[1] += shape->radius * (1.0 + 1.0 / 4096.0);
        }
        check_refused(&r, &camera, 4, 4, "a camera close to a sphere");
    }
    renderer_finish(&r);
}

TEST(what_does_not_fit_changes_nothing)
{
    const struct scene_override size[] = {{"film.width", "48"}, {"film.height", "32"}, {0}};
    struct scene scene;
    struct gpu gpu;
    struct err err = {0};
    OPEN_GPU(&gpu, .validation = true);
    REQUIRE_OK(load_scene("scenes/all_classes.json", size, &scene, &err));
    refuse(&gpu, &scene, false);
    refuse(&gpu, &scene, true);
    CHECK(gpu.validation_messages == 0, "%u messages", gpu.validation_messages);
    scene_finish(&scene);
    gpu_close(&gpu);
}

// --- kernels from elsewhere ----------------------------------------------------------------------

// Copies the embedded code, as if a compiler had just produced it.
static bool copy_kernels(const struct gpu *gpu, struct arena *arena, struct kernel_set *out)
{
    *out = (struct kernel_set){0};
    for (int id = 0; id < KERNEL_COUNT; id++) {
        struct kernel_code code = kernel_code((enum kernel_id)id, gpu->has_ballot);
        uint32_t *copy = ARENA_NEW(arena, uint32_t, code.bytes / sizeof(uint32_t));
        if (!copy)
            return false;
        memcpy(copy, code.spirv, code.bytes);
        out->codes[id] = (struct kernel_code){.spirv = copy, .bytes = code.bytes};
    }
    return true;
}

#define SPIRV_HEADER 5u
#define OP_CONSTANT 43u
#define ONE 0x3f800000u
#define HALF 0x3f000000u

// Changes a constant so that camera rays have half their weight.
static bool halve_a_constant(struct kernel_code *code, struct arena *arena)
{
    size_t words = code->bytes / sizeof(uint32_t);
    uint32_t *copy = ARENA_NEW(arena, uint32_t, words);
    if (!copy)
        return false;
    memcpy(copy, code->spirv, code->bytes);
    code->spirv = copy;
    for (size_t i = SPIRV_HEADER; i < words && copy[i] >> 16; i += copy[i] >> 16)
        if ((copy[i] & 0xffffu) == OP_CONSTANT && copy[i + 3] == ONE) {
            copy[i + 3] = HALF;
            return true;
        }
    return false;
}

static void check_kernels(const struct renderer *r, const struct kernel_set *set, const char *path)
{
    for (int id = 0; id < KERNEL_COUNT; id++)
        CHECK(!r->kernels[id].pipeline || r->kernels[id].spirv == set->codes[id].spirv,
              "%s: kernel %s is another", path, r->kernels[id].name);
    bool has_fields = r->specialization.geometry & GEOMETRY_SDFS;
    CHECK((r->kernels[KERNEL_intersect_closest].variant != 0) == has_fields,
          "%s: the programs of distance fields are not in", path);
}

static void compare_kernels(struct gpu *gpu, const char *path)
{
    const struct look_case c = {.path = path};
    struct arena arena = {0};
    struct scene scene;
    struct kernel_set set, other;
    struct renderer r;
    struct film_image embedded, copied, changed;
    struct err err = {0};
    REQUIRE_OK(load_case(&c, &scene, &err));
    REQUIRE(copy_kernels(gpu, &arena, &set), "no memory");
    struct renderer_params params = {.gpu = gpu, .scene = &scene};
    REQUIRE_OK(render_film(&params, SAMPLES, &arena, &embedded, NULL, &err));
    params.kernels = &set;
    REQUIRE_OK(renderer_create(&params, &r, &err));
    check_kernels(&r, &set, path);
    REQUIRE_OK(render_and_read(&r, &arena, &copied, &err));
    renderer_finish(&r);
    CHECK(same_bits(&embedded, &copied), "%s: copied kernels differ", path);
    other = set;
    for (int id = 0; id < KERNEL_COUNT; id++)
        if (id != KERNEL_generate_rays)
            other.codes[id].spirv = NULL; // the embedded code
    REQUIRE(halve_a_constant(&other.codes[KERNEL_generate_rays], &arena), "no constant to change");
    params.kernels = &other;
    REQUIRE_OK(render_film(&params, SAMPLES, &arena, &changed, NULL, &err));
    CHECK(!same_bits(&embedded, &changed), "%s: another kernel makes no difference", path);
    for (int id = 0; id < KERNEL_COUNT; id++) {
        gpu_kernels_forget(gpu, set.codes[id].spirv);
        gpu_kernels_forget(gpu, other.codes[id].spirv);
    }
    arena_finish(&arena); // frees the code, too
    scene_finish(&scene);
}

TEST(kernels_from_elsewhere)
{
    struct gpu gpu;
    OPEN_GPU(&gpu, .validation = true);
    compare_kernels(&gpu, "scenes/cornell.json");
    compare_kernels(&gpu, "scenes/sdf_csg.json");
    CHECK(gpu.validation_messages == 0, "%u messages", gpu.validation_messages);
    gpu_close(&gpu);
}

// --- in small steps ------------------------------------------------------------------------------

// Pixels from the top on have one sample, with its final value, and the others have none.
static void check_unfinished(const struct film_image *film, const struct film_image *whole,
                             uint64_t done)
{
    size_t wrong = 0;
    for (size_t i = 0; i < (size_t)film->width * film->height; i++) {
        static const float black[3] = {0.0f, 0.0f, 0.0f};
        const float *want = i < done ? whole->mean[i] : black;
        wrong += film->samples[i] != (i < done) ||
                 memcmp(film->mean[i], want, sizeof film->mean[i]) != 0;
    }
    CHECK(wrong == 0, "%zu pixels are wrong after %llu", wrong, (unsigned long long)done);
}

// Renders like a viewer: one sample per call, stopped after each wave and read in between.
TEST(stops_after_every_wave)
{
    const struct look_case c = {.path = "scenes/cornell.json"};
    bool stops = false;
    const struct progress progress = {.should_stop = stop_at_once, .context = &stops};
    struct arena arena = {0};
    struct scene scene;
    struct gpu gpu;
    struct renderer r;
    struct film_image whole, film;
    struct render_stats stats;
    struct err err = {0};
    OPEN_GPU(&gpu, .validation = true);
    REQUIRE_OK(load_case(&c, &scene, &err));
    struct renderer_params params = {.gpu = &gpu, .scene = &scene, .wave = 512};
    REQUIRE_OK(render_film(&params, 1, &arena, &whole, &stats, &err));
    CHECK(stats.waves == 3, "%llu waves, expected 3", (unsigned long long)stats.waves);
    params.progress = &progress;
    REQUIRE_OK(renderer_create(&params, &r, &err));
    stops = true;
    for (uint64_t wave = 1; wave <= stats.waves; wave++) {
        bool stopped = false;
        const struct render_call call = {.samples = 1, .stopped = &stopped};
        REQUIRE_OK(renderer_render(&r, &call, &err));
        CHECK(r.stats.waves == wave && stopped == (wave < stats.waves),
              "call %llu: %llu waves, stopped %d", (unsigned long long)wave,
              (unsigned long long)r.stats.waves, stopped);
        REQUIRE_OK(renderer_read(&r, &arena, &film, &err));
        check_unfinished(&film, &whole, wave * 512);
    }
    CHECK(same_bits(&film, &whole) && r.next_sample == 1, "the picture in steps is another");
    CHECK(r.stats.paths == stats.paths && r.stats.closest_rays == stats.closest_rays,
          "stopping costs %llu rays", (unsigned long long)(r.stats.closest_rays));
    for (int k = 0; k < KERNEL_COUNT; k++)
        CHECK(k == KERNEL_resolve || r.stats.kernels[k].launches == stats.kernels[k].launches,
              "stopping costs launches of kernel %d", k);
    renderer_finish(&r);
    CHECK(gpu.validation_messages == 0, "%u messages", gpu.validation_messages);
    arena_finish(&arena);
    scene_finish(&scene);
    gpu_close(&gpu);
}

// A path is followed in an unfinished picture, as if somebody had clicked in it: in the middle of a
// pass and between two, and at another size than the renderer's first one.
TEST(following_a_path_changes_nothing)
{
    const struct look_case c = {.path = "scenes/all_classes.json"};
    bool stops = false;
    const struct progress progress = {.should_stop = stop_at_once, .context = &stops};
    struct arena arena = {0};
    struct scene scene;
    struct gpu gpu;
    struct renderer r;
    struct film_image whole, film;
    struct replay replay;
    struct err err = {0};
    OPEN_GPU(&gpu, .validation = true);
    REQUIRE_OK(load_case(&c, &scene, &err));
    const struct renderer_params params = {
        .gpu = &gpu, .scene = &scene, .wave = 512, .progress = &progress};
    const struct look look = {.camera = scene.cameras[0], .width = 30, .height = 20};
    const struct render_call first = {.samples = 1}, rest = {.samples = SAMPLES - 1};
    REQUIRE_OK(render_anew(&params, &look, &arena, &whole, &err));
    REQUIRE_OK(renderer_create(&params, &r, &err));
    bool fits;
    REQUIRE_OK(renderer_set_camera(&r, &look.camera, look.width, look.height, &fits, &err));
    stops = true;
    for (int i = 0; r.next_sample == 0 && i < 10; i++) {
        REQUIRE_OK(renderer_render(&r, &first, &err));
        REQUIRE_OK(renderer_replay(&r, 15, 12, 0, &arena, &replay, &err));
        CHECK(replay.vertex_count > 0 && replay.vertices[0].t > 0.0f, "nothing was met");
    }
    stops = false;
    REQUIRE_OK(renderer_render(&r, &rest, &err) && renderer_read(&r, &arena, &film, &err));
    CHECK(same_bits(&film, &whole), "the picture is another");
    renderer_finish(&r);
    CHECK(gpu.validation_messages == 0, "%u messages", gpu.validation_messages);
    arena_finish(&arena);
    scene_finish(&scene);
    gpu_close(&gpu);
}

TEST_MAIN(TEST_CASE(same_bits_as_a_new_renderer), TEST_CASE(what_does_not_fit_changes_nothing),
          TEST_CASE(kernels_from_elsewhere), TEST_CASE(stops_after_every_wave),
          TEST_CASE(following_a_path_changes_nothing))
