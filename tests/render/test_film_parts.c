// Parts of a film, each with a range of the samples, add up to the same bits as the whole, in any
// order and grouping.
#include "render/film_copy.h"
#include "render_fixture.h"

enum { PARTS = 6, LAYERS = AOV_ALBEDO | AOV_DEPTH | AOV_IDS | AOV_EMISSION | AOV_BY_EMITTER };
// The numbers are even.
static const uint64_t part_samples[PARTS] = {2, 6, 2, 4, 8, 2};

struct bench {
    struct gpu gpu;
    struct scene scene;
    struct renderer r;
    struct arena arena;
    struct film_copy whole, parts[PARTS];
    struct err err;
};

// Renders the records of each part, and those of a film with all samples.
static bool render_parts(struct bench *b)
{
    uint64_t samples = 0;
    for (int i = 0; i < PARTS; i++) {
        const struct render_call call = {.samples = part_samples[i]};
        if (!renderer_render(&b->r, &call, &b->err) ||
            !film_copy_take(&b->r, false, &b->arena, &b->parts[i], &b->err) ||
            !renderer_clear(&b->r, &b->err))
            return false;
        samples += part_samples[i];
    }
    const struct render_call all = {.samples = samples};
    return renderer_restart(&b->r, b->r.frame.seed, &b->err) &&
           renderer_render(&b->r, &all, &b->err) &&
           film_copy_take(&b->r, false, &b->arena, &b->whole, &b->err);
}

static bool open_bench(struct bench *b, const struct scene_override *overrides)
{
    const struct renderer_params params = {
        .gpu = &b->gpu, .scene = &b->scene, .aovs = LAYERS, .wave = 1024};
    return load_scene("scenes/classical.json", overrides, &b->scene, &b->err) &&
           renderer_create(&params, &b->r, &b->err) && render_parts(b);
}

static void close_bench(struct bench *b)
{
    renderer_finish(&b->r);
    scene_finish(&b->scene);
    arena_finish(&b->arena);
    gpu_close(&b->gpu);
}

// Returns one of `count` numbers, by SplitMix64 (Steele, Lea and Flood 2014).
static uint32_t choose(uint64_t *state, uint32_t count)
{
    uint64_t z = *state += UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
    return (uint32_t)((z ^ z >> 31) % count);
}

// Adds two of the remaining parts, chosen at random, until one is left.
static bool add_at_random(struct bench *b, uint64_t *state, struct film_copy *out)
{
    const uint64_t bytes = film_copy_bytes(&b->r);
    struct film_copy left[PARTS];
    for (int i = 0; i < PARTS; i++) {
        left[i] = b->parts[i];
        left[i].records = arena_alloc(&b->arena, bytes, 1);
        if (!left[i].records)
            return err_memory(&b->err, "parts", bytes);
        memcpy(left[i].records, b->parts[i].records, bytes);
    }
    for (uint32_t count = PARTS; count > 1; count--) {
        uint32_t to = choose(state, count), part = choose(state, count - 1);
        part += part >= to;
        if (!film_copy_add(&b->r, &left[part], &left[to], &b->err))
            return false;
        left[part] = left[count - 1];
        to = to == count - 1 ? part : to;
        *out = left[to];
    }
    return true;
}

// Under a sky of radiance 1, and of radiances from 1e-20 to 1e20 side by side.
TEST(any_order_gives_the_bits_of_the_whole)
{
    static const char *const skies[] = {"[1, 0.8, 0.6]", "[1e20, 0.3, 1e-20]"};
    for (int s = 0; s < 2; s++) {
        const struct scene_override overrides[] = {
            {"film.width", "24"}, {"film.height", "18"}, {"environment.radiance", skies[s]}, {0}};
        struct bench b = {0};
        uint64_t state = 7;
        OPEN_GPU(&b.gpu, .validation = false);
        REQUIRE(open_bench(&b, overrides), "%s", b.err.msg);
        for (int trial = 0; trial < 8; trial++) {
            struct film_copy sum = {0};
            REQUIRE(add_at_random(&b, &state, &sum), "%s", b.err.msg);
            CHECK(memcmp(sum.records, b.whole.records, film_copy_bytes(&b.r)) == 0,
                  "sky %s, trial %d: other bits", skies[s], trial);
            CHECK(sum.emptied_at == 0 && sum.next_sample == b.whole.next_sample,
                  "samples %llu to %llu", (unsigned long long)sum.emptied_at,
                  (unsigned long long)sum.next_sample);
        }
        close_bench(&b);
    }
}

static void check_refused(struct bench *b, const char *words)
{
    b->err = (struct err){0};
    CHECK(!film_copy_add(&b->r, &b->parts[0], &b->parts[1], &b->err), "added, though %s", words);
    CHECK(strstr(b->err.msg, words), "%s", b->err.msg);
}

TEST(what_has_an_order_is_refused)
{
    const struct scene_override small[] = {{"film.width", "4"}, {"film.height", "4"}, {0}};
    struct bench b = {0};
    OPEN_GPU(&b.gpu, .validation = false);
    REQUIRE(open_bench(&b, small), "%s", b.err.msg);
    b.parts[0].seed++;
    check_refused(&b, "of seed 1 cannot be added to one of seed 0");
    b.parts[0].seed--;
    b.parts[0].emptied_at = 3;
    check_refused(&b, "first samples are 3 and 2");
    uint32_t done = 2;
    b.parts[0].done = &done;
    check_refused(&b, "tiles");
    // As if from renderers with other settings.
    b.r.specialization.halves = HALVES_CONTIGUOUS;
    check_refused(&b, "--halves independent");
    b.r.specialization.accumulation = ACCUMULATION_SUM;
    check_refused(&b, "--accumulation binned");
    close_bench(&b);
}

TEST_MAIN(TEST_CASE(any_order_gives_the_bits_of_the_whole), TEST_CASE(what_has_an_order_is_refused))
