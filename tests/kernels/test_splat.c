// Thousands of threads splat to a few pixels. The sums must have the same bits as in C, in any
// order.
#include "film_reference.h"
#include "kernel_fixture.h"
#include "splat_test.spv.h"

enum { SLOTS = 4096, SPLATS = 2 * SLOTS, PIXELS = 3 };

struct splat {
    float value[3];
    uint32_t place; // two times the pixel plus the half
};
static struct splat splats[SPLATS];
static struct gpu_film_pixel expected[PIXELS], film[PIXELS];

// Makes pixels with radiance from 1e-20 to 1e20, with the whole range of single precision, and with
// values near 1 that often carry. Signs differ, there are zeros, and some values are not finite.
static void make_splats(struct random *random)
{
    static const double decades[PIXELS] = {20, 38, 0.5};
    for (int i = 0; i < SPLATS; i++) {
        uint32_t pixel = random_u32(random) % PIXELS;
        splats[i].place = 2 * pixel + random_u32(random) % 2;
        for (int c = 0; c < 3; c++) {
            double value = pow(10, random_between(random, -decades[pixel], decades[pixel]));
            value *= random_u32(random) % 4 == 0 ? -1 : 1;
            splats[i].value[c] = random_u32(random) % 16 == 0 ? 0.0f : (float)value;
        }
        if (random_u32(random) % 64 == 0)
            splats[i].value[random_u32(random) % 3] = random_u32(random) % 2 ? INFINITY : NAN;
    }
}

static void expect_all(void)
{
    for (int i = 0; i < SPLATS; i++) {
        struct gpu_film_pixel *pixel = &expected[splats[i].place / 2];
        bool second = splats[i].place & 1u;
        for (uint32_t c = 0; c < 3; c++)
            if (isfinite(splats[i].value[c]))
                film_reference_add(second ? &pixel->sums_b[4 * c] : &pixel->sums_a[4 * c],
                                   second ? &pixel->digits_b : &pixel->digits_a, c,
                                   splats[i].value[c]);
    }
}

static void shuffle(struct random *random)
{
    for (uint32_t i = SPLATS - 1; i > 0; i--) {
        uint32_t other = random_u32(random) % (i + 1);
        struct splat kept = splats[i];
        splats[i] = splats[other];
        splats[other] = kept;
    }
}

// Adds the splats to an empty film, at most `part` at a time.
static bool add_all(struct renderer *r, const struct gpu_kernel *kernel, uint32_t part,
                    struct err *err)
{
    memset(film, 0, sizeof film);
    bool ok = gpu_upload(r->gpu, &r->film[0], 0, film, sizeof film, err);
    for (uint32_t first = 0; first < SPLATS && ok; first += part) {
        uint32_t left = SPLATS - first;
        r->push.part_items = left < part ? left : part;
        ok = gpu_upload(r->gpu, &r->buffers[BINDING_PATHS], 0, &splats[first],
                        r->push.part_items * sizeof *splats, err);
        for (r->push.bounce = 0; r->push.bounce < 2 && ok; r->push.bounce++)
            ok = run_kernel(r, kernel, r->push.part_items, err);
    }
    return ok && gpu_download(r->gpu, &r->film[0], 0, film, sizeof film, err);
}

// Checks the rounding error against the bounds of film_sums.h, with sums that are accurate to 2^-64
// of their terms.
static void check_value(uint32_t place, uint32_t c)
{
    const struct gpu_film_pixel *pixel = &film[place / 2];
    const uint32_t *sum = place & 1u ? &pixel->sums_b[4 * c] : &pixel->sums_a[4 * c];
    long double exact = 0, magnitude = 0;
    double greatest = 0, count = 0;
    for (int i = 0; i < SPLATS; i++) {
        double value = (double)splats[i].value[c];
        if (splats[i].place != place || !isfinite(value))
            continue;
        exact += (long double)value;
        magnitude += fabsl((long double)value);
        greatest = fmax(greatest, fabs(value));
        count++;
    }
    double found = film_reference_value(sum, place & 1u ? pixel->digits_b : pixel->digits_a, c);
    double allowed = count * greatest * 0x1p-32 + (double)magnitude * 0x1p-50;
    CHECK(fabs(found - (double)exact) <= allowed, "place %u, channel %u: %.12g, not %.12g", place,
          c, found, (double)exact);
}

TEST(any_order_gives_the_same_bits)
{
    struct setup setup;
    struct gpu_kernel kernel = {0};
    struct err err = {0};
    struct random random = {65};
    scene_start(&setup.scene, PIXELS, 1);
    setup.scene.environment = (struct environment){.present = true, .radiance = {1, 1, 1}};
    OPEN_SETUP(&setup, SLOTS);
    const struct gpu_kernel_params params = {
        .name = "splat",
        .spirv = splat_spirv,
        .spirv_bytes = sizeof splat_spirv,
        .constants = (const uint32_t *)&setup.r.specialization,
        .constant_count = CONSTANT_COUNT,
    };
    REQUIRE(gpu_kernel_create(&setup.gpu, &params, &kernel, &err), "%s", err.msg);
    make_splats(&random);
    expect_all();
    static const uint32_t parts[] = {SPLATS, SPLATS, 1000, 63};
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++) {
        bool ok = add_all(&setup.r, &kernel, parts[i], &err);
        REQUIRE(ok, "%s", err.msg);
        CHECK(memcmp(film, expected, sizeof film) == 0, "%u at once: other bits", parts[i]);
        shuffle(&random);
    }
    for (uint32_t place = 0; place < 2 * PIXELS; place++)
        for (uint32_t c = 0; c < 3; c++)
            check_value(place, c);
    gpu_kernel_finish(&setup.gpu, &kernel);
    setup_close(&setup);
}

TEST_MAIN(TEST_CASE(any_order_gives_the_same_bits))
