// Tests accumulate and resolve against binned sums, plain sums and running means in C, bit for bit.
#include "film_reference.h"
#include "kernel_fixture.h"

enum { SLOTS = 1024, WIDTH = 16, HEIGHT = 8, PIXELS = WIDTH * HEIGHT };

static float float_of(uint32_t word)
{
    float value;
    memcpy(&value, &word, sizeof value);
    return value;
}

// Adds sample number `count` to a half of a film that stores floats.
static void accumulate_float(uint32_t accumulation, uint32_t *word, float value, uint32_t count)
{
    float kept = float_of(*word);
    kept += accumulation == ACCUMULATION_SUM ? value : (value - kept) / (float)count;
    memcpy(word, &kept, sizeof kept);
}

static struct gpu_film_pixel expected[PIXELS], film[PIXELS];
static float radiance[SLOTS][4];

static void add_floats(uint32_t accumulation, struct gpu_film_pixel *pixel, const float value[3])
{
    bool odd = pixel->samples & 1u; // independent of the index of the sample
    uint32_t count_a = (pixel->digits_b ? pixel->digits_b - 1 : 0) + !odd;
    uint32_t count = odd ? pixel->samples + 1 - count_a : count_a;
    for (int c = 0; c < 3; c++)
        accumulate_float(accumulation, odd ? &pixel->sums_b[4 * c] : &pixel->sums_a[4 * c],
                         value[c], count);
    pixel->digits_a = FILM_HAS_FLOATS;
    pixel->digits_b = accumulation == ACCUMULATION_RUNNING ? count_a + 1 : 0;
}

static void add_to_bins(struct gpu_film_pixel *pixel, const float value[3])
{
    bool odd = pixel->samples & 1u;
    for (uint32_t c = 0; c < 3; c++)
        film_reference_add(odd ? &pixel->sums_b[4 * c] : &pixel->sums_a[4 * c],
                           odd ? &pixel->digits_b : &pixel->digits_a, c, value[c]);
}

static void expect_wave(uint32_t accumulation, const struct gpu_push *push)
{
    for (uint32_t slot = 0; slot < push->pixel_count << push->sample_shift; slot++) {
        struct gpu_film_pixel *pixel =
            &expected[push->first_pixel - push->film_first_pixel + (slot >> push->sample_shift)];
        if (accumulation == ACCUMULATION_BINNED)
            add_to_bins(pixel, radiance[slot]);
        else
            add_floats(accumulation, pixel, radiance[slot]);
        pixel->samples++;
        pixel->dropped += radiance[slot][3] != 0.0f;
    }
}

// Fills radiance over 24 orders of magnitude, with exact zeros, and bright spikes among small
// values. The last channel has the whole range of single precision, with both signs.
static void fill_radiance(struct random *random)
{
    for (uint32_t slot = 0; slot < SLOTS; slot++) {
        for (int c = 0; c < 3; c++) {
            const double range[3] = {12, 1, 37};
            double value = pow(10, random_between(random, -range[c], range[c]));
            value *= c == 2 && random_u32(random) % 2 == 0 ? -1 : 1;
            radiance[slot][c] = random_u32(random) % 8 == 0 ? 0.0f : (float)value;
        }
        radiance[slot][3] = random_u32(random) % 16 == 0 ? 1.0f : 0.0f;
    }
}

static bool accumulate(struct renderer *r, uint32_t part, struct err *err)
{
    bool ok = gpu_upload(r->gpu, &r->buffers[BINDING_RADIANCE], 0, radiance, sizeof radiance, err);
    r->push.part_items = part;
    for (uint32_t first = 0; first < r->push.pixel_count && ok; first += part) {
        uint32_t left = r->push.pixel_count - first;
        r->push.first_item = first;
        ok = run_kernel(r, &r->kernels[KERNEL_accumulate], left < part ? left : part, err);
    }
    return ok && gpu_download(r->gpu, &r->film[0], 0, film, sizeof film, err);
}

static void make_setup_scene(struct scene *scene)
{
    scene_start(scene, WIDTH, HEIGHT);
    scene->environment = (struct environment){.present = true, .radiance = {1, 1, 1}};
}

static uint32_t count_differing(void)
{
    uint32_t differing = 0;
    for (uint32_t i = 0; i < PIXELS; i++)
        differing += memcmp(&film[i], &expected[i], sizeof film[i]) != 0;
    return differing;
}

static void check_accumulation(uint32_t accumulation)
{
    struct setup setup;
    struct err err = {0};
    struct random random = {61};
    make_setup_scene(&setup.scene);
    setup.scene.settings.accumulation = accumulation;
    OPEN_SETUP(&setup, SLOTS);
    memset(expected, 0, sizeof expected);
    struct gpu_push *push = &setup.r.push;
    // On other devices a division may have an error of 2.5 ulps.
    uint32_t waves = accumulation != ACCUMULATION_RUNNING || setup.gpu.info.is_cpu ? 300 : 0;
    for (uint32_t wave = 0; wave < waves; wave++) {
        push->sample_shift = wave % 5;
        push->pixel_count = 1 + random_u32(&random) % (SLOTS >> push->sample_shift);
        if (push->pixel_count > PIXELS)
            push->pixel_count = PIXELS;
        push->first_pixel = random_u32(&random) % (PIXELS + 1 - push->pixel_count);
        push->first_sample = random_u32(&random);
        // The film's buffer may begin with a later pixel of the image.
        push->film_first_pixel = wave % 3 * 1000;
        push->first_pixel += push->film_first_pixel;
        fill_radiance(&random);
        bool ok = accumulate(&setup.r, wave % 2 ? 32 : PIXELS, &err);
        expect_wave(accumulation, push);
        REQUIRE(ok, "%s", err.msg);
    }
    CHECK(waves == 0 || count_differing() == 0, "%s: %u of %d pixels",
          accumulation_names[accumulation], count_differing(), PIXELS);
    setup_close(&setup);
}

TEST(accumulate_is_as_in_c)
{
    for (uint32_t i = 0; accumulation_names[i]; i++)
        check_accumulation(i);
}

// The sum remains correct where a plain sum stops growing: 2^24, followed by ones.
TEST(accumulate_goes_on_past_2_to_24)
{
    struct setup setup;
    struct err err = {0};
    make_setup_scene(&setup.scene);
    OPEN_SETUP(&setup, SLOTS);
    struct gpu_push *push = &setup.r.push;
    push->pixel_count = 1;
    push->sample_shift = 4;
    bool ok = true;
    for (uint32_t wave = 0; wave < 101 && ok; wave++) {
        push->first_sample = wave * 16;
        for (uint32_t slot = 0; slot < 16; slot++)
            for (int c = 0; c < 3; c++)
                radiance[slot][c] = wave == 0 && slot < 2 ? 0x1p24f : 1.0f;
        ok = accumulate(&setup.r, PIXELS, &err);
    }
    REQUIRE(ok, "%s", err.msg);
    double a = film_reference_value(&film[0].sums_a[0], film[0].digits_a, 0);
    double b = film_reference_value(&film[0].sums_b[8], film[0].digits_b, 2);
    double exact = 0x1p24 + 101 * 8 - 1;
    CHECK(a == exact && b == exact, "%.9g and %.9g, not %.9g", a, b, exact);
    setup_close(&setup);
}

// A wave with a ray that exceeded its budget is discarded: nothing of it may reach the film.
TEST(accumulate_leaves_void_waves_alone)
{
    struct setup setup;
    struct err err = {0};
    struct random random = {62};
    make_setup_scene(&setup.scene);
    OPEN_SETUP(&setup, SLOTS);
    memset(expected, 0, sizeof expected);
    struct renderer *r = &setup.r;
    r->push.pixel_count = PIXELS;
    r->push.sample_shift = 0;
    r->counters->unfinished = 1;
    fill_radiance(&random);
    bool ok = gpu_upload(r->gpu, &r->buffers[BINDING_QUEUES], 0, r->counters, sizeof *r->counters,
                         &err) &&
              accumulate(r, PIXELS, &err);
    REQUIRE(ok, "%s", err.msg);
    CHECK(count_differing() == 0, "%u of %d pixels", count_differing(), PIXELS);
    setup_close(&setup);
}

// --- resolve -------------------------------------------------------------------------------------

// A rounding and a division, which Vulkan requires to be accurate to 2.5 ulps.
static bool is_mean(float mean, double sum, uint32_t samples)
{
    double exact = samples > 0 ? sum / samples : 0;
    return fabs((double)mean - exact) <= 3.5 * 0x1p-23 * fabs(exact);
}

static float random_value(struct random *random, double decades)
{
    float value = (float)pow(10, random_between(random, -decades, decades));
    return random_u32(random) % 4 == 0 ? -value : value;
}

// Makes a pixel in which one value dominates, or none; a film of floats has one value per sum.
static void make_pixel(uint32_t accumulation, uint32_t samples, struct random *random,
                       struct gpu_film_pixel *out)
{
    *out = (struct gpu_film_pixel){.samples = samples, .dropped = random_u32(random) % 100};
    if (accumulation == ACCUMULATION_BINNED) {
        for (uint32_t i = 0; i < samples && i < 8; i++)
            for (uint32_t c = 0; c < 3; c++) {
                film_reference_add(&out->sums_a[4 * c], &out->digits_a, c,
                                   random_value(random, 30));
                if (samples > 1)
                    film_reference_add(&out->sums_b[4 * c], &out->digits_b, c,
                                       random_value(random, 1));
            }
        return;
    }
    for (uint32_t c = 0; c < 3; c++) {
        const float a = random_value(random, 10), b = samples > 1 ? random_value(random, 1) : 0;
        memcpy(&out->sums_a[4 * c], &a, sizeof a);
        memcpy(&out->sums_b[4 * c], &b, sizeof b);
    }
    out->digits_a = FILM_HAS_FLOATS;
    out->digits_b = accumulation == ACCUMULATION_RUNNING ? samples - samples / 2 + 1 : 0;
}

// Returns the sum of a channel that a half-buffer stores, or its mean.
static double kept_of(uint32_t accumulation, const struct gpu_film_pixel *pixel, bool second,
                      uint32_t c)
{
    const uint32_t *sum = second ? &pixel->sums_b[4 * c] : &pixel->sums_a[4 * c];
    if (accumulation == ACCUMULATION_BINNED)
        return film_reference_value(sum, second ? pixel->digits_b : pixel->digits_a, c);
    return (double)float_of(*sum);
}

static void check_resolve(uint32_t accumulation)
{
    const bool has_means = accumulation == ACCUMULATION_RUNNING;
    struct setup setup;
    struct err err = {0};
    struct random random = {63};
    make_setup_scene(&setup.scene);
    setup.scene.settings.accumulation = accumulation;
    OPEN_SETUP(&setup, SLOTS);
    struct renderer *r = &setup.r;
    static const uint32_t counts[] = {0, 1, 2, 3, 64, 1000001};
    for (uint32_t i = 0; i < PIXELS; i++)
        make_pixel(accumulation, counts[i % 6], &random, &film[i]);
    struct arena arena = {0};
    struct film_image image;
    bool ok = gpu_upload(r->gpu, &r->film[0], 0, film, sizeof film, &err) &&
              renderer_read(r, &arena, &image, &err);
    REQUIRE(ok, "%s", err.msg);
    uint32_t wrong = 0;
    uint64_t dropped = 0;
    for (uint32_t i = 0; i < PIXELS; i++) {
        uint32_t samples_b = film[i].samples / 2, samples_a = film[i].samples - samples_b;
        samples_a = has_means ? samples_a > 0 : samples_a; // a mean counts as one sample
        samples_b = has_means ? samples_b > 0 : samples_b;
        for (uint32_t c = 0; c < 3; c++)
            wrong +=
                !is_mean(image.half_a[i][c], kept_of(accumulation, &film[i], false, c),
                         samples_a) ||
                !is_mean(image.half_b[i][c], kept_of(accumulation, &film[i], true, c), samples_b);
        wrong += image.samples[i] != film[i].samples;
        dropped += film[i].dropped;
    }
    CHECK(wrong == 0, "%s: %u of %d pixels", accumulation_names[accumulation], wrong, PIXELS);
    CHECK(image.dropped == dropped, "%llu dropped, not %llu", (unsigned long long)image.dropped,
          (unsigned long long)dropped);
    CHECK(image.least_samples == 0 && image.most_samples == 1000001, "%llu to %llu samples",
          (unsigned long long)image.least_samples, (unsigned long long)image.most_samples);
    arena_finish(&arena);
    setup_close(&setup);
}

TEST(resolve_takes_means)
{
    for (uint32_t i = 0; accumulation_names[i]; i++)
        check_resolve(i);
}

// --- both ----------------------------------------------------------------------------------------

// Every sample has radiance 1, so that all means, also those of the halves, are exactly 1.
static void check_emptied_film(struct renderer *r, uint64_t before, uint64_t samples)
{
    struct arena arena = {0};
    struct film_image image;
    struct err err = {0};
    const struct render_call first = {.samples = before}, second = {.samples = samples};
    bool ok = renderer_render(r, &first, &err) && renderer_clear(r, &err) &&
              renderer_render(r, &second, &err) && renderer_read(r, &arena, &image, &err);
    REQUIRE(ok, "%s", err.msg);
    uint32_t wrong = 0;
    for (uint32_t i = 0; i < PIXELS; i++)
        wrong += image.samples[i] != samples || image.mean[i][0] != 1.0f ||
                 image.half_a[i][1] != 1.0f || image.half_b[i][2] != (samples > 1 ? 1.0f : 0.0f);
    CHECK(wrong == 0, "%llu samples after %llu that are gone: %u of %d pixels",
          (unsigned long long)samples, (unsigned long long)before, wrong, PIXELS);
    arena_finish(&arena);
}

TEST(an_emptied_film_begins_with_its_first_half)
{
    struct setup setup;
    make_setup_scene(&setup.scene);
    OPEN_SETUP(&setup, SLOTS);
    for (uint64_t before = 1; before <= 2; before++)
        for (uint64_t samples = 1; samples <= 4; samples++)
            check_emptied_film(&setup.r, before, samples);
    setup_close(&setup);
}

TEST_MAIN(TEST_CASE(accumulate_is_as_in_c), TEST_CASE(accumulate_goes_on_past_2_to_24),
          TEST_CASE(accumulate_leaves_void_waves_alone), TEST_CASE(resolve_takes_means),
          TEST_CASE(an_emptied_film_begins_with_its_first_half))
