// Tests scene buffers that exceed the range of a storage buffer: divided among several bindings,
// they give the same bits. If that is impossible, they are refused with a message.
#include "render_fixture.h"

#define SAMPLES 3
#define TRIANGLES "4600"
#define SKY_WIDTH 96u
#define SKY_HEIGHT 48u

// A mesh with normals under an environment image: nodes, triangles, attributes and environment are
// all longer than 32 KiB.
static bool load_long_scene(struct scene *scene, struct err *err)
{
    const struct scene_override size[] = {
        {"film.width", "24"}, {"film.height", "18"}, {"shapes.0.triangles", TRIANGLES}, {0}};
    if (!load_scene("tests/render/scenes/blob.json", size, scene, err))
        return false;
    struct environment *environment = &scene->environment;
    environment->texels =
        arena_alloc(&scene->arena, (size_t)SKY_WIDTH * SKY_HEIGHT, sizeof *environment->texels);
    if (!environment->texels)
        return err_memory(err, "the sky", 0);
    environment->width = SKY_WIDTH;
    environment->height = SKY_HEIGHT;
    for (uint32_t i = 0; i < SKY_WIDTH * SKY_HEIGHT; i++)
        for (uint32_t c = 0; c < 3; c++)
            environment->texels[i][c] = 0.1f + 0.001f * (float)((i * 7 + c * 13) % 997);
    return true;
}

static bool same_bits(const struct film_image *a, const struct film_image *b)
{
    size_t bytes = (size_t)a->width * a->height * sizeof *a->mean;
    return a->width == b->width && a->height == b->height && memcmp(a->mean, b->mean, bytes) == 0 &&
           memcmp(a->half_a, b->half_a, bytes) == 0;
}

// The result of rendering the scene on a device with these limits.
struct outcome {
    bool rendered;
    struct film_image film;
    uint32_t parts, messages; // the parts, as bits PARTS; messages of the validation layers
    uint32_t features;
    struct err err;
};

static void render_limited(const struct scene *scene, const struct gpu_params *params,
                           struct arena *arena, struct outcome *out)
{
    struct gpu gpu;
    struct renderer r;
    const struct render_call call = {.samples = SAMPLES};
    *out = (struct outcome){0};
    if (!gpu_open(params, &gpu, &out->err))
        return;
    const struct renderer_params renderer = {.gpu = &gpu, .scene = scene};
    if (renderer_create(&renderer, &r, &out->err)) {
        out->rendered = renderer_render(&r, &call, &out->err) &&
                        renderer_read(&r, arena, &out->film, &out->err);
        out->parts = r.specialization.parts;
        out->features = r.specialization.features;
        renderer_finish(&r);
    }
    out->messages = gpu.validation_messages;
    gpu_close(&gpu);
}

static uint32_t count_split(uint32_t parts)
{
    uint32_t split = 0;
    for (uint32_t b = 0; b <= BINDING_TEXELS; b++)
        split += PARTS_OF(parts, b) > 0;
    return split;
}

// Opens a device of the machine, or ends the test, and renders the scene there.
#define EXPECT(scene, arena, expected)                                                             \
    do {                                                                                           \
        struct gpu first_gpu;                                                                      \
        OPEN_GPU(&first_gpu, 0);                                                                   \
        gpu_close(&first_gpu);                                                                     \
        REQUIRE_OK(load_long_scene((scene), &err));                                                \
        render_limited((scene), NULL, (arena), (expected));                                        \
        REQUIRE((expected)->rendered, "%s", (expected)->err.msg);                                  \
    } while (0)

TEST(split_buffers_give_the_same_bits)
{
    static const struct {
        const char *name;
        struct gpu_limit_overrides limits;
        uint32_t split; // number of buffers that were divided
        bool validation;
    } cases[] = {
        {"128 KiB", {.no_texel = true, .storage_range = 1u << 17}, 1},
        {"64 KiB", {.no_texel = true, .storage_range = 1u << 16}, 4},
        {"32 KiB", {.no_texel = true, .storage_range = 1u << 15}, 4, .validation = true},
        {"not a power of two", {.no_texel = true, .storage_range = 100000}, 2},
        {"texels too long", {.storage_range = 1u << 16, .texel_elements = 4096}, 4},
        {"as few bindings as suffice",
         {.no_texel = true, .storage_range = 1u << 16, .storage_count = 16 + 6},
         4,
         .validation = true},
    };
    struct scene scene;
    struct arena arena = {0};
    struct outcome expected, seen;
    struct err err = {0};
    EXPECT(&scene, &arena, &expected);
    CHECK(expected.parts == 0, "parts 0x%x", expected.parts);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const struct gpu_params params = {.limits = cases[i].limits,
                                          .validation = cases[i].validation};
        render_limited(&scene, &params, &arena, &seen);
        if (cases[i].validation && strstr(seen.err.msg, "is not installed"))
            continue;
        CHECK(seen.rendered, "%s: %s", cases[i].name, seen.err.msg);
        CHECK(!seen.rendered || same_bits(&seen.film, &expected.film), "%s: other bits",
              cases[i].name);
        CHECK(count_split(seen.parts) == cases[i].split, "%s: parts 0x%x", cases[i].name,
              seen.parts);
        CHECK(seen.messages == 0, "%s: %u validation messages", cases[i].name, seen.messages);
        CHECK(!(seen.features & FEATURE_TEXEL_SCENE), "%s: texels", cases[i].name);
    }
    scene_finish(&scene);
    arena_finish(&arena);
}

// A device with the fewest bindings that Vulkan guarantees has none for parts.
TEST(without_bindings_it_is_refused)
{
    const struct gpu_params params = {
        .limits = {.no_texel = true, .storage_range = 1u << 16, .storage_count = 16}};
    struct scene scene;
    struct arena arena = {0};
    struct outcome expected, seen;
    struct err err = {0};
    EXPECT(&scene, &arena, &expected);
    render_limited(&scene, &params, &arena, &seen);
    CHECK(!seen.rendered && seen.err.code == ERR_GPU && strstr(seen.err.msg, "64.0 KiB") &&
              strstr(seen.err.msg, "buffer nodes needs") && strstr(seen.err.msg, "expected"),
          "%s", seen.err.msg);
    scene_finish(&scene);
    arena_finish(&arena);
}

// --- any limits ----------------------------------------------------------------------------------

static uint64_t random_between(uint64_t *state, uint32_t least_bits, uint32_t most_bits)
{
    // A multiplicative congruential generator (Steele and Vigna 2021, table 5).
    *state = *state * UINT64_C(0xd1342543de82ef95) + 1;
    uint64_t number = *state >> 16;
    uint32_t bits = least_bits + (uint32_t)(number % (most_bits - least_bits + 1));
    return (UINT64_C(1) << bits) + ((number >> 8) & ((UINT64_C(1) << bits) - 1));
}

// For any limits, the result has the same bits, or an error names the limit and what was expected.
static void check_random_limits(int count)
{
    struct scene scene;
    struct arena arena = {0};
    struct outcome expected, seen;
    struct err err = {0};
    uint64_t state = 4711;
    int rendered = 0, split = 0;
    EXPECT(&scene, &arena, &expected);
    for (int i = 0; i < count; i++) {
        const struct gpu_params params = {
            .limits = {
                .storage_range = random_between(&state, 9, 18),
                .storage_count = 16 + random_between(&state, 0, 3),
                .no_texel = i % 3 != 0,
                .texel_elements = random_between(&state, 0, 14),
                .allocation = i % 4 == 0 ? random_between(&state, 10, 22) : 0,
            }};
        render_limited(&scene, &params, &arena, &seen);
        if (seen.rendered)
            CHECK(same_bits(&seen.film, &expected.film), "trial %d: other bits", i);
        else
            CHECK(seen.err.code == ERR_GPU &&
                      (strstr(seen.err.msg, "expected") || strstr(seen.err.msg, "limit")),
                  "trial %d: code %d: %s", i, seen.err.code, seen.err.msg);
        rendered += seen.rendered;
        split += seen.rendered && seen.parts;
    }
    printf("%d limits: %d rendered, %d of them split\n", count, rendered, split);
    CHECK(rendered > count / 10 && rendered < count && split > 0, "%d of %d, %d split", rendered,
          count, split);
    scene_finish(&scene);
    arena_finish(&arena);
}

TEST(random_limits)
{
    check_random_limits(30);
}

TEST(random_limits_long)
{
    check_random_limits(400);
}

TEST_MAIN(TEST_CASE(split_buffers_give_the_same_bits), TEST_CASE(without_bindings_it_is_refused),
          TEST_CASE(random_limits), TEST_CASE(random_limits_long))
