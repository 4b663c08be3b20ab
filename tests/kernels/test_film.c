// accumulate and resolve against compensated and plain sums and running means in C, bit for bit;
// and how far each drifts, against closed forms.
#include "kernel_fixture.h"

enum { SLOTS = 1024, WIDTH = 16, HEIGHT = 8, PIXELS = WIDTH * HEIGHT };

// Kahan 1965; the tests are compiled without contraction.
static void add(float *sum, float *lost, float value)
{
    float y = value - *lost;
    float t = *sum + y;
    *lost = (t - *sum) - y;
    *sum = t;
}

// Sample number `count` of a half.
static void accumulate_one(uint32_t accumulation, float *sum, float *lost, float value,
                           uint32_t count)
{
    if (accumulation == ACCUMULATION_COMPENSATED)
        add(sum, lost, value);
    else if (accumulation == ACCUMULATION_SUM)
        *sum += value;
    else
        *sum += (value - *sum) / (float)count;
}

static struct gpu_film_pixel expected[PIXELS], film[PIXELS];
static float radiance[SLOTS][4];

static void expect_wave(uint32_t accumulation, const struct gpu_push *push)
{
    for (uint32_t slot = 0; slot < push->pixel_count << push->sample_shift; slot++) {
        struct gpu_film_pixel *pixel =
            &expected[push->first_pixel - push->film_first_pixel + (slot >> push->sample_shift)];
        bool odd = pixel->samples & 1u; // whatever the index of the sample
        uint32_t count_a = (pixel->means_a ? pixel->means_a - 1 : 0) + !odd;
        uint32_t count = odd ? pixel->samples + 1 - count_a : count_a;
        for (int c = 0; c < 3; c++)
            accumulate_one(accumulation, odd ? &pixel->sum_b[c] : &pixel->sum_a[c],
                           odd ? &pixel->lost_b[c] : &pixel->lost_a[c], radiance[slot][c], count);
        pixel->means_a = accumulation == ACCUMULATION_RUNNING ? count_a + 1 : 0;
        pixel->samples++;
        pixel->dropped += radiance[slot][3] != 0.0f;
    }
}

// Over 24 orders of magnitude, with exact zeros, and bright spikes among small values.
static void fill_radiance(struct random *random)
{
    for (uint32_t slot = 0; slot < SLOTS; slot++) {
        for (int c = 0; c < 3; c++) {
            double exponent =
                c == 0 ? random_between(random, -12, 12) : random_between(random, -1, 1);
            radiance[slot][c] = random_u32(random) % 8 == 0 ? 0.0f : (float)pow(10, exponent);
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
    // Elsewhere a division may be off by 2.5 units in the last place.
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

// The sum stays right where a plain one stands still: 2^24 and then ones.
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
    double a = (double)film[0].sum_a[0] - (double)film[0].lost_a[0];
    double b = (double)film[0].sum_b[2] - (double)film[0].lost_b[2];
    double exact = 0x1p24 + 101 * 8 - 1;
    CHECK(fabs(a - exact) <= 1 && fabs(b - exact) <= 1, "%.9g and %.9g, not %.9g", a, b, exact);
    setup_close(&setup);
}

// A wave with a ray that ran out of its budget is void: nothing of it reaches the film.
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

// A subtraction and a division, which Vulkan wants good to 2.5 ulp.
static bool is_mean(float mean, float sum, float lost, uint32_t samples)
{
    if (samples == 0)
        return mean == 0.0f;
    double exact = (double)(sum - lost) / samples;
    return fabs((double)mean - exact) <= 3 * 0x1p-23 * fabs(exact);
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
    for (uint32_t i = 0; i < PIXELS; i++) {
        struct gpu_film_pixel *pixel = &film[i];
        pixel->samples = counts[i % 6];
        pixel->dropped = i;
        for (int c = 0; c < 3; c++) {
            pixel->sum_a[c] = (float)pow(10, random_between(&random, -10, 10));
            pixel->sum_b[c] = pixel->samples > 1 ? (float)random_unit(&random) : 0.0f;
            pixel->lost_a[c] = has_means ? 0 : pixel->sum_a[c] * 0x1p-24f;
            pixel->lost_b[c] = has_means ? 0 : pixel->sum_b[c] * -0x1p-24f;
        }
        pixel->means_a = has_means ? pixel->samples - pixel->samples / 2 + 1 : 0;
    }
    struct arena arena = {0};
    struct film_image image;
    bool ok = gpu_upload(r->gpu, &r->film[0], 0, film, sizeof film, &err) &&
              renderer_read(r, &arena, &image, &err);
    REQUIRE(ok, "%s", err.msg);
    uint32_t wrong = 0;
    uint64_t dropped = 0;
    for (uint32_t i = 0; i < PIXELS; i++) {
        uint32_t samples_b = film[i].samples / 2, samples_a = film[i].samples - samples_b;
        samples_a = has_means ? samples_a > 0 : samples_a; // of a mean, one
        samples_b = has_means ? samples_b > 0 : samples_b;
        for (int c = 0; c < 3; c++)
            wrong += !is_mean(image.half_a[i][c], film[i].sum_a[c], film[i].lost_a[c], samples_a) ||
                     !is_mean(image.half_b[i][c], film[i].sum_b[c], film[i].lost_b[c], samples_b);
        wrong += image.samples[i] != film[i].samples;
        dropped += film[i].dropped;
    }
    CHECK(wrong == 0, "%u of %d pixels", wrong, PIXELS);
    CHECK(image.dropped == dropped, "%llu dropped, not %llu", (unsigned long long)image.dropped,
          (unsigned long long)dropped);
    CHECK(image.least_samples == 0 && image.most_samples == 1000001, "%llu to %llu samples",
          (unsigned long long)image.least_samples, (unsigned long long)image.most_samples);
    arena_finish(&arena);
    setup_close(&setup);
}

TEST(resolve_takes_means)
{
    check_resolve(ACCUMULATION_COMPENSATED);
    check_resolve(ACCUMULATION_RUNNING);
}

// --- both ----------------------------------------------------------------------------------------

// Every sample sees radiance 1, so that all means are 1 exactly, also those of halves.
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
