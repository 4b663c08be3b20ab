#include "picture.h"

// Makes a file from the text of a header and the bytes of the pixels. *size receives its length.
static const uint8_t *hdr_file(const char *header, const void *pixels, size_t count, size_t *size)
{
    static uint8_t file[4096];
    size_t length = strlen(header);
    memcpy(file, header, length);
    memcpy(file + length, pixels, count);
    *size = length + count;
    return file;
}

#define HEADER "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n"

static void check_pixels(const char *header, const void *bytes, size_t count, uint32_t width,
                         uint32_t height, const float (*expected)[3])
{
    size_t size;
    const uint8_t *file = hdr_file(header, bytes, count, &size);
    struct arena arena = {0};
    struct image image;
    struct err err = {0};
    if (picture_decode(file, size, &arena, &image, &err)) {
        CHECK(image.width == width && image.height == height, "%u x %u", image.width, image.height);
        CHECK(memcmp(image.pixels, expected, (size_t)width * height * 12) == 0,
              "first pixel %g %g %g", (double)image.pixels[0][0], (double)image.pixels[0][1],
              (double)image.pixels[0][2]);
    } else {
        CHECK(false, "%s", err.msg);
    }
    arena_finish(&arena);
    picture_check_cuts(file, size);
    picture_check_flips(file, size);
}

static void check_refused(const char *header, const void *bytes, size_t count, const char *reason)
{
    size_t size;
    const uint8_t *file = hdr_file(header, bytes, count, &size);
    struct arena arena = {0};
    struct image image;
    struct err err = {0};
    CHECK(!picture_decode(file, size, &arena, &image, &err) && err.code == ERR_INPUT, "%s", reason);
    CHECK(strstr(err.msg, reason), "\"%s\" should contain \"%s\"", err.msg, reason);
    arena_finish(&arena);
}

// The value is 128 2^(129 - 136) = 1.
TEST(flat_pixels)
{
    static const uint8_t pixels[] = {128, 64, 0, 129, 255, 1, 2, 136, 9, 9, 9, 0};
    static const float expected[][3] = {{1, 0.5f, 0}, {255, 1, 2}, {0, 0, 0}};
    check_pixels(HEADER "-Y 1 +X 3\n", pixels, sizeof pixels, 3, 1, expected);
}

TEST(old_runs)
{
    // A pixel and a run of two more; another pixel and a run of 256 + 1 more, with a count of two
    // bytes.
    static const uint8_t pixels[] = {128, 0,   0, 129, 1, 1, 1, 2, 0, 128,
                                     0,   129, 1, 1,   1, 1, 1, 1, 1, 1};
    static float expected[261][3];
    for (int i = 0; i < 261; i++)
        expected[i][i < 3 ? 0 : 1] = 1;
    check_pixels(HEADER "-Y 1 +X 261\n", pixels, sizeof pixels, 261, 1,
                 (const float(*)[3])expected);
    check_refused(HEADER "-Y 1 +X 3\n", (uint8_t[]){1, 1, 1, 2}, 4, "a run of 2");
    check_refused(HEADER "-Y 1 +X 2\n", (uint8_t[]){7, 1, 1, 2, 1, 1, 1, 9}, 8, "a run of 9");
}

TEST(new_runs)
{
    // With a width of 9, the four components are: a run of 9; 2 literals and a run of 7; 9
    // literals; a run of 9.
    static const uint8_t line[] = {2, 2, 0, 9, 137, 128, 2, 64, 32, 128 + 7, 16, 9,
                                   0, 1, 2, 3, 4,   5,   6, 7,  8,  128 + 9, 129};
    static uint8_t lines[2 * sizeof line];
    memcpy(lines, line, sizeof line);
    memcpy(lines + sizeof line, line, sizeof line);
    lines[sizeof line + 5] = 255; // red component of the second line
    static float expected[18][3];
    for (int i = 0; i < 18; i++) {
        int x = i % 9;
        expected[i][0] = i < 9 ? 1 : 255.0f / 128;
        expected[i][1] = x == 0 ? 0.5f : x == 1 ? 0.25f : 0.125f;
        expected[i][2] = (float)x / 128;
    }
    check_pixels(HEADER "-Y 2 +X 9\n", lines, sizeof lines, 9, 2, (const float(*)[3])expected);
    uint8_t broken[sizeof line];
    memcpy(broken, line, sizeof line);
    broken[4] = 138;
    check_refused(HEADER "-Y 1 +X 9\n", broken, sizeof line,
                  "a run or literal of 10 pixels; expected 1 to 9");
    broken[4] = 0;
    check_refused(HEADER "-Y 1 +X 9\n", broken, sizeof line,
                  "a run or literal of 0 pixels; expected 1 to 9");
}

TEST(orientation_and_exposure)
{
    static const uint8_t pixels[] = {128, 0, 0,   129, 0,   128, 0,   129,
                                     0,   0, 128, 129, 128, 128, 128, 129};
    static const float flipped[][3] = {{1, 1, 1}, {0, 0, 1}, {0, 1, 0}, {1, 0, 0}};
    check_pixels(HEADER "+Y 2 -X 2\n", pixels, sizeof pixels, 2, 2, flipped);
    static const float darker[][3] = {
        {0.125f, 0, 0}, {0, 0.125f, 0}, {0, 0, 0.125f}, {0.125f, 0.125f, 0.125f}};
    size_t size;
    const uint8_t *file = hdr_file("#?RGBE\nEXPOSURE=2\nFORMAT=32-bit_rle_rgbe\nEXPOSURE= 4\n\n"
                                   "-Y 2 +X 2\n",
                                   pixels, sizeof pixels, &size);
    struct arena arena = {0};
    struct image image;
    REQUIRE(picture_decode(file, size, &arena, &image, NULL));
    CHECK(memcmp(image.pixels, darker, sizeof darker) == 0, "%g", (double)image.pixels[0][0]);
    arena_finish(&arena);
}

TEST(bad_headers)
{
    check_refused("#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n", "", 0, "32-bit_rle_xyze");
    check_refused("#?RADIANCE\n\n-Y 1 +X 1\n", "", 0, "no FORMAT");
    check_refused(HEADER "+X 1 -Y 1\n", "", 0, "-Y height +X width");
    check_refused(HEADER "-Y 1 +X 1 z\n", "", 0, "-Y height +X width");
    check_refused(HEADER "-Y 0 +X 1\n", "", 0, "0 pixels");
    check_refused(HEADER "-Y -1 +X 1\n", "", 0, "-Y height");
    check_refused(HEADER "-Y 999999999 +X 999999999\n", "", 0, "any memory");
    check_refused(HEADER "-Y 99999999999 +X 1\n", "", 0, "-Y height");
    check_refused("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=-1\n\n-Y 1 +X 1\n", "", 0,
                  "exposure is -1");
}

TEST_MAIN(TEST_CASE(flat_pixels), TEST_CASE(old_runs), TEST_CASE(new_runs),
          TEST_CASE(orientation_and_exposure), TEST_CASE(bad_headers))
