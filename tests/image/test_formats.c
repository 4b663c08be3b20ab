// Tests the formats without layers: files are read back by the module's own readers.
#include "picture.h"

#include <math.h>
#include <string.h>

#define NAME "the \"name\"\nof it"

static const struct image_attribute attributes[] = {
    {"scene", "scenes/cornell.json"}, {"note", NAME}, {"command", "lampyris render a.json"}};

// The sizes are a single pixel, narrower and wider than HDR encodes, and not a multiple of JPEG's
// blocks.
static const uint32_t sizes[][2] = {{1, 1}, {7, 3}, {8, 1}, {17, 9}, {300, 33}};

static bool write_and_read(const char *path, const struct image *image, unsigned png_bits,
                           struct arena *arena, struct image *out)
{
    const struct image_write_params params = {.path = path,
                                              .image = image,
                                              .attributes = attributes,
                                              .attribute_count = 3,
                                              .png_bits = png_bits,
                                              .tone = TONE_NONE};
    struct err err = {0};
    uint8_t *data = NULL;
    size_t size = 0;
    bool ok = image_encode(&params, arena, &data, &size, &err) &&
              picture_decode(data, size, arena, out, &err);
    CHECK(ok, "%s", err.msg);
    return ok && out->width == image->width && out->height == image->height;
}

// Makes an image with values of many magnitudes, which is smooth in places, so that runs occur.
static struct image create(struct arena *arena, const uint32_t size[2], bool is_wide)
{
    struct image image = picture_create(arena, size[0], size[1]);
    for (uint32_t i = 0; image.pixels && i < size[0] * size[1]; i++)
        for (int c = 0; c < 3; c++) {
            if (i / 11 % 3 == 0)
                image.pixels[i][c] = 0.25f;
            if (is_wide)
                image.pixels[i][c] =
                    ldexpf(image.pixels[i][c] + 0.5f, (int)(i / 5 * 37 % 200) - 100);
        }
    return image;
}

TEST(pfm_keeps_every_bit)
{
    for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++) {
        struct arena arena = {0};
        struct image image = create(&arena, sizes[s], true), read;
        const float extremes[3] = {-0.0f, INFINITY, NAN};
        memcpy(image.pixels[0], extremes, sizeof extremes);
        REQUIRE(write_and_read("a.pfm", &image, 0, &arena, &read));
        CHECK(picture_same_bits(&image, &read));
        arena_finish(&arena);
    }
}

// The error is at most half a step of an 8-bit mantissa, the largest of which is at least 128.
TEST(hdr_is_off_by_half_a_step)
{
    for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++) {
        struct arena arena = {0};
        struct image image = create(&arena, sizes[s], true), read;
        REQUIRE(write_and_read("a.hdr", &image, 0, &arena, &read));
        for (uint32_t i = 0; i < image.width * image.height; i++) {
            const float *p = image.pixels[i];
            float most = fmaxf(fmaxf(p[0], p[1]), p[2]);
            for (int c = 0; c < 3; c++)
                CHECK(fabsf(read.pixels[i][c] - p[c]) <= most / 255.0f, "pixel %u: %g for %g", i,
                      (double)read.pixels[i][c], (double)p[c]);
        }
        arena_finish(&arena);
    }
}

TEST(hdr_changes_what_it_cannot_hold)
{
    struct arena arena = {0};
    struct image image = picture_create(&arena, 9, 1), read;
    const float strange[3][3] = {{-1, NAN, 1}, {INFINITY, 3e38f, 1}, {1e-40f, 0, 1e-41f}};
    memcpy(image.pixels, strange, sizeof strange);
    image.pixels[3][0] = 0.99999f; // the mantissa is rounded up to the next exponent
    image.pixels[3][1] = image.pixels[3][2] = 0.0f;
    REQUIRE(write_and_read("a.hdr", &image, 0, &arena, &read));
    CHECK(read.pixels[0][0] == 0 && read.pixels[0][1] == 0 && read.pixels[0][2] == 1);
    CHECK(read.pixels[1][0] == 0x1.fep126f && read.pixels[1][1] == 0x1.fep126f);
    CHECK(read.pixels[2][0] == 0 && read.pixels[2][2] == 0);
    CHECK(read.pixels[3][0] == 1.0f, "%g", (double)read.pixels[3][0]);
    arena_finish(&arena);
}

TEST(png_of_16_bits_is_257_times_finer)
{
    for (int bits = 8; bits <= 16; bits += 8)
        for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++) {
            struct arena arena = {0};
            struct image image = create(&arena, sizes[s], false), read;
            float most = 0.0f;
            REQUIRE(write_and_read("a.png", &image, (unsigned)bits, &arena, &read));
            for (uint32_t i = 0; i < image.width * image.height * 3; i++)
                most = fmaxf(most, fabsf(image_srgb_from_linear(read.pixels[i / 3][i % 3]) -
                                         image_srgb_from_linear(image.pixels[i / 3][i % 3])));
            float step = bits == 8 ? 1 / 255.0f : 1 / 65535.0f;
            CHECK(most <= 0.5f * step + 2e-6f, "%d bits: %g", bits, (double)most);
            if (bits == 8 && image.width * image.height > 100)
                CHECK(most > 0.25f * step, "the measure sees no step");
            arena_finish(&arena);
        }
}

// A constant image only has the error of the colour conversion.
TEST(jpeg_is_close)
{
    struct arena arena = {0};
    struct image image = picture_create(&arena, 19, 13), read;
    for (uint32_t i = 0; i < 19 * 13; i++)
        for (int c = 0; c < 3; c++)
            image.pixels[i][c] = 0.1f + 0.3f * (float)c;
    REQUIRE(write_and_read("a.jpg", &image, 0, &arena, &read));
    for (uint32_t i = 0; i < 19 * 13 * 3; i++) {
        float difference = image_srgb_from_linear(read.pixels[i / 3][i % 3]) -
                           image_srgb_from_linear(image.pixels[i / 3][i % 3]);
        CHECK(fabsf(difference) <= 2.5f / 255.0f, "%g", (double)difference);
    }
    for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++) {
        image = create(&arena, sizes[s], false);
        CHECK(write_and_read("b.JPEG", &image, 0, &arena, &read));
    }
    arena_finish(&arena);
}

TEST(pfm_of_others)
{
    static const struct {
        const char *text;
        size_t size;
        float first, last; // expected values; 0: the file is refused
    } cases[] = {
        {"PF\n1 1\n1.0\n\x3f\x80\0\0\x40\0\0\0\x40\x40\0\0", 23, 1, 3}, // big-endian
        // grey, rows from the bottom
        {"Pf\n1 2\n-1\n\0\0\x80\x3f\0\0\0\x40", 18, 2, 1},
        {"PF\n1 1\n-2.0\n\0\0\x80\x3f\0\0\0\x40\0\0\x40\x40", 24, 2, 6}, // with a scale
        {"PF\n1 1\n-1.0\n\0\0\x80\x3f\0\0\0\x40\0\0\x40", 23, 0, 0},     // too few bytes
        {"PF\n1 1\n0\n\0\0\x80\x3f\0\0\0\x40\0\0\x40\x40", 21, 0, 0},    // no byte order
        {"PF\n-1 1\n-1\n\0\0\x80\x3f\0\0\0\x40\0\0\x40\x40", 23, 0, 0},  // a negative width
        {"PF\n1\n", 5, 0, 0},
        {"PF\n999999999 999999999\n-1.0\n", 28, 0, 0},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct arena arena = {0};
        struct image image;
        struct err err = {0};
        bool ok = picture_decode(cases[i].text, cases[i].size, &arena, &image, &err);
        CHECK(ok == (cases[i].first > 0), "case %zu: %s", i, err.msg);
        if (ok) {
            size_t last = (size_t)image.width * image.height - 1;
            CHECK(image.pixels[0][0] == cases[i].first && image.pixels[last][2] == cases[i].last,
                  "case %zu: %g, %g", i, (double)image.pixels[0][0], (double)image.pixels[last][2]);
        } else {
            CHECK(err.code == ERR_INPUT || err.code == ERR_BUDGET, "case %zu: %s", i, err.msg);
        }
        arena_finish(&arena);
    }
}

TEST(pfm_survives_damage)
{
    struct arena arena = {0};
    const struct image image = create(&arena, sizes[1], true);
    struct err err = {0};
    uint8_t *data;
    size_t size;
    REQUIRE(image_encode(&(struct image_write_params){.path = "a.pfm", .image = &image}, &arena,
                         &data, &size, &err));
    picture_check_cuts(data, size);
    picture_check_flips(data, size);
    arena_finish(&arena);
}

TEST_MAIN(TEST_CASE(pfm_keeps_every_bit), TEST_CASE(hdr_is_off_by_half_a_step),
          TEST_CASE(hdr_changes_what_it_cannot_hold), TEST_CASE(png_of_16_bits_is_257_times_finer),
          TEST_CASE(jpeg_is_close), TEST_CASE(pfm_of_others), TEST_CASE(pfm_survives_damage))
