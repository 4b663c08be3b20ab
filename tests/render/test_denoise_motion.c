// Tests that the denoised preview after an object has moved is nearer to the truth with its history
// than without.
#include "denoise_fixture.h"

#define MOVED_BY 0.4
enum { SEEDS = 4, REFERENCE = 128 };

// The regions in which errors are measured: the moved box, its former place, and the rest.
enum region { REGION_BOX, REGION_UNCOVERED, REGION_ELSEWHERE, REGION_ALL, REGIONS };
static const char *const region_names[] = {"the box", "uncovered", "elsewhere", "all"};

struct side {
    struct scene scene;
    struct renderer renderer;
    struct film_image reference;
};

struct box {
    struct gpu gpu;
    struct side before, after;
    struct denoiser denoiser;
    struct arena arena;
    float (*picture)[4];
    double errors[2][REGIONS]; // without and with the history
    struct err err;
};

static bool render(struct renderer *renderer, uint32_t seed, uint64_t samples, struct err *err)
{
    const struct render_call call = {.samples = samples};
    return renderer_restart(renderer, seed, err) && renderer_render(renderer, &call, err);
}

static bool open_side(struct box *b, struct side *side, const char *left, const char *right,
                      const char *sky, const char *lamp)
{
    const struct scene_override overrides[] = {{"film.width", "128"},
                                               {"film.height", "86"},
                                               {"left", left},
                                               {"right", right},
                                               {"sky", sky},
                                               {"lamp", lamp},
                                               {0}};
    if (!load_scene("tests/render/scenes/moved_box.json", overrides, &side->scene, &b->err))
        return false;
    const struct renderer_params params = {
        .gpu = &b->gpu, .scene = &side->scene, .aovs = DENOISE_AOVS, .open_ended = true};
    return renderer_create(&params, &side->renderer, &b->err) &&
           render(&side->renderer, 999, REFERENCE, &b->err) &&
           renderer_read(&side->renderer, &b->arena, &side->reference, &b->err);
}

static bool open(struct box *b, const char *sky, const char *lamp)
{
    if (!open_side(b, &b->before, "-0.5", "0.5", sky, lamp) ||
        !open_side(b, &b->after, "-0.1", "0.9", sky, lamp))
        return false;
    uint64_t pixels = (uint64_t)b->after.reference.width * b->after.reference.height;
    b->picture = arena_alloc(&b->arena, pixels, sizeof *b->picture);
    return b->picture && denoiser_create(&b->gpu, &b->denoiser, &b->err);
}

static void close_side(struct side *side)
{
    renderer_finish(&side->renderer);
    scene_finish(&side->scene);
}

static void close(struct box *b)
{
    denoiser_finish(&b->denoiser);
    close_side(&b->before);
    close_side(&b->after);
    arena_finish(&b->arena);
    gpu_close(&b->gpu);
    CHECK(b->gpu.validation_messages == 0, "%u validation messages", b->gpu.validation_messages);
}

static void add_errors(struct box *b, int which)
{
    const struct film_image *truth = &b->after.reference;
    const uint32_t box = b->after.scene.instance_count + 1;
    for (uint32_t i = 0; i < truth->width * truth->height; i++) {
        bool is = truth->aovs.ids[i][0] == box, was = b->before.reference.aovs.ids[i][0] == box;
        enum region region = is ? REGION_BOX : was ? REGION_UNCOVERED : REGION_ELSEWHERE;
        for (int c = 0; c < 3; c++) {
            double want = (double)truth->mean[i][c], off = (double)b->picture[i][c] - want;
            double error = off * off / (want * want + 0.01);
            b->errors[which][region] += error;
            b->errors[which][REGION_ALL] += error;
        }
    }
}

static bool denoise(struct box *b, const struct denoise_call *call, int which)
{
    const struct gpu_frame *frame = &call->renderer->frame;
    uint64_t bytes = (uint64_t)frame->width * frame->height * sizeof *b->picture;
    if (!denoiser_run(&b->denoiser, call, &b->err) ||
        !gpu_download(&b->gpu, &b->denoiser.picture, 0, b->picture, bytes, &b->err))
        return false;
    add_errors(b, which);
    return true;
}

// Renders `samples` with the box at its former place, and one at its new place with the same random
// numbers, as the viewer does.
static bool move(struct box *b, uint32_t seed, uint64_t samples)
{
    const struct denoise_motion motion = {
        PRIMITIVE_SHAPE, 1, NO_INSTANCE, {{1, 0, 0, -MOVED_BY}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    const struct camera *camera = &b->after.scene.cameras[0];
    const struct denoise_call keep = {.renderer = &b->before.renderer, .camera = camera};
    struct denoise_call call = {.renderer = &b->after.renderer, .camera = camera};
    if (!render(&b->before.renderer, seed, samples, &b->err) ||
        !render(&b->after.renderer, seed, 1, &b->err) || !denoise(b, &call, 0) ||
        !denoiser_keep(&b->denoiser, &keep, &b->err))
        return false;
    call.temporal = call.has_changed = true;
    call.motions = &motion;
    call.motion_count = 1;
    bool ok = denoise(b, &call, 1);
    denoiser_forget(&b->denoiser);
    return ok;
}

struct move_case {
    const char *name, *sky, *lamp;
    // Limits of the error with a history of 64 samples, as a fraction of that without a history.
    double limits[REGIONS];
};

static void compare(struct box *b, const struct move_case *c, uint64_t samples)
{
    double count = 3.0 * SEEDS * b->after.reference.width * b->after.reference.height;
    memset(b->errors, 0, sizeof b->errors);
    for (uint32_t seed = 1; seed <= SEEDS; seed++)
        REQUIRE(move(b, seed, samples), "%s", b->err.msg);
    printf("  %s after %u samples: relMSE %.5f, with the history %.5f\n", c->name,
           (unsigned)samples, b->errors[0][REGION_ALL] / count, b->errors[1][REGION_ALL] / count);
    for (int i = 0; i < REGIONS; i++) {
        double part = b->errors[1][i] / b->errors[0][i], limit = samples < 4 ? 1 : c->limits[i];
        printf("    %s: %.2f\n", region_names[i], part);
        CHECK(part <= limit, "%s, %s: %g of the error without a history, expected %g", c->name,
              region_names[i], part, limit);
    }
}

// A history of one sample has too little information: it makes no difference.
static void run(const struct move_case *c)
{
    struct box b = {0};
    OPEN_GPU(&b.gpu, .validation = true);
    REQUIRE(open(&b, c->sky, c->lamp), "%s", b.err.msg);
    compare(&b, c, 64);
    compare(&b, c, 1);
    close(&b);
}

#define WHITE "[1, 1, 1]"
#define DARK "[0.1, 0.12, 0.15]"

TEST(under_a_sky)
{
    run(&(struct move_case){"even sky", WHITE, "[0, 0, 0]", {1.0, 1.0, 0.95, 0.95}});
}

// The shadow of the box moves with it.
TEST(beside_a_lamp)
{
    run(&(struct move_case){"lamp", DARK, "[20, 20, 20]", {1.1, 1.1, 1.0, 1.0}});
}

TEST_MAIN(TEST_CASE(under_a_sky), TEST_CASE(beside_a_lamp))
