#define _GNU_SOURCE // nftw
#include "base/temporary_folder.h"
#include "image/image_internal.h"
#include "picture.h"

#include <png.h>

static char folder[512];

static void encode(const struct image_write_params *params, struct byte_buffer *out)
{
    struct err err = {0};
    uint8_t *codes = NULL;
    CHECK(image_display_codes(params, &codes, &err) && image_png_write(params, codes, out, &err), "%s",
          err.msg);
    free(codes);
}

// The linear value of every 8-bit code is written as that code, and read as that value.
TEST(all_codes_come_back)
{
    struct arena arena = {0};
    struct byte_buffer file = {0};
    float pixels[256][3];
    for (int i = 0; i < 256; i++)
        for (int c = 0; c < 3; c++)
            pixels[i][c] = image_srgb_to_linear((float)((i + 85 * c) % 256) / 255);
    struct image image = {32, 8, pixels}, back;
    encode(&(struct image_write_params){.path = "m", .image = &image}, &file);
    REQUIRE(picture_decode(file.data, file.size, &arena, &back, NULL));
    CHECK(picture_same_bits(&image, &back));
    byte_buffer_finish(&file);
    arena_finish(&arena);
}

TEST(values_are_clamped_and_exposed)
{
    struct arena arena = {0};
    struct byte_buffer file = {0};
    float pixels[2][3] = {{-1, NAN, INFINITY}, {7, 0.25f, 0}};
    struct image image = {2, 1, pixels}, back;
    encode(&(struct image_write_params){.path = "m", .image = &image, .exposure_stops = 1}, &file);
    REQUIRE(picture_decode(file.data, file.size, &arena, &back, NULL));
    CHECK(back.pixels[0][0] == 0 && back.pixels[0][1] == 0 && back.pixels[0][2] == 1);
    CHECK(back.pixels[1][0] == 1 && fabsf(back.pixels[1][1] - 0.5f) < 0.003f);
    byte_buffer_finish(&file);
    arena_finish(&arena);
}

// The chunks, in their order, are read without the library (PNG specification, 5.3).
TEST(file_has_the_expected_chunks)
{
    struct arena arena = {0};
    struct byte_buffer file = {0};
    struct image image = picture_create(&arena, 3, 2);
    const struct image_attribute attributes[] = {{"seed", "7"}, {"device", "Gerät"}};
    encode(
        &(struct image_write_params){
            .path = "m", .image = &image, .attributes = attributes, .attribute_count = 2},
        &file);
    static const char *const expected[] = {"IHDR", "sRGB", "tEXt", "iTXt", "IDAT", "IEND"};
    size_t at = 8;
    for (int i = 0; i < 6; i++) {
        REQUIRE(at + 12 <= file.size);
        const uint8_t *chunk = file.data + at;
        CHECK(memcmp(chunk + 4, expected[i], 4) == 0, "%.4s, expected %s", (const char *)chunk + 4,
              expected[i]);
        at += 12 + ((size_t)chunk[0] << 24 | (size_t)chunk[1] << 16 | (size_t)chunk[2] << 8 |
                    (size_t)chunk[3]);
    }
    CHECK(at == file.size);
    // 3 x 2 pixels, 8 bits, RGB.
    CHECK(memcmp(file.data + 16, "\0\0\0\3\0\0\0\2\10\2\0\0\0", 13) == 0);
    byte_buffer_finish(&file);
    arena_finish(&arena);
}

TEST(attributes_come_back)
{
    REQUIRE(temporary_enter(folder, sizeof folder));
    struct arena arena = {0};
    struct image image = picture_create(&arena, 3, 2);
    const struct image_attribute attributes[] = {
        {"lampyris.command", "render a.json -o \"b c.png\""}, {"device", "Gerät"}, {"empty", ""}};
    struct err err = {0};
    struct image_write_params params = {
        .path = "p.png", .image = &image, .attributes = attributes, .attribute_count = 3};
    REQUIRE(image_write(&params, &err), "%s", err.msg);
    struct image_attribute *got;
    uint32_t count;
    REQUIRE(image_read_attributes("p.png", &arena, &got, &count, &err), "%s", err.msg);
    CHECK(count == 3, "%u", count);
    for (uint32_t i = 0; i < count && i < 3; i++)
        CHECK(strcmp(got[i].key, attributes[i].key) == 0 &&
                  strcmp(got[i].value, attributes[i].value) == 0,
              "%s = %s", got[i].key, got[i].value);
    arena_finish(&arena);
    temporary_leave(folder);
}

#define TEN_BYTES "1234567890"
#define EIGHTY_BYTES TEN_BYTES TEN_BYTES TEN_BYTES TEN_BYTES TEN_BYTES TEN_BYTES TEN_BYTES TEN_BYTES

TEST(bad_keys_are_refused)
{
    static const char *const keys[] = {"", " a", "a ", "a  b", "Gerät", "a\nb", EIGHTY_BYTES};
    struct arena arena = {0};
    struct image image = picture_create(&arena, 1, 1);
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++) {
        struct byte_buffer file = {0};
        const struct image_attribute attribute = {keys[i], "value"};
        struct err err = {0};
        static const uint8_t codes[3];
        CHECK(!image_png_write(
                  &(struct image_write_params){
                      .path = "m", .image = &image, .attributes = &attribute, .attribute_count = 1},
                  codes, &file, &err) &&
                  err.code == ERR_OUTPUT,
              "\"%s\"", keys[i]);
        byte_buffer_finish(&file);
    }
    arena_finish(&arena);
}

// Rows of noise take more bytes if they are predicted from neighbours, and noise of 64 codes has 6
// bits of information in 8.
TEST(noise_is_not_filtered)
{
    enum { SIDE = 128, COUNT = 3 * SIDE * SIDE };
    static uint8_t codes[COUNT];
    uint32_t state = 1;
    for (size_t i = 0; i < COUNT; i++) {
        state = state * 1664525u + 1013904223u;
        codes[i] = (uint8_t)(state >> 26 << 2);
    }
    struct arena arena = {0};
    struct err err = {0};
    uint8_t *file;
    size_t size = 0;
    CHECK(image_encode_codes(codes, SIDE, SIDE, &arena, &file, &size, &err), "%s", err.msg);
    struct byte_buffer filtered = {0};
    const struct image shape = {.width = SIDE, .height = SIDE};
    const struct image_write_params params = {.path = "codes.png", .image = &shape};
    CHECK(image_png_write(&params, codes, &filtered, &err), "%s", err.msg);
    CHECK(size < filtered.size && size < COUNT * 80 / 100, "%zu bytes, filtered %zu", size,
          filtered.size);
    byte_buffer_finish(&filtered);
    arena_finish(&arena);
}

// --- files that image_write cannot make ----------------------------------------------------------
static void store(png_structp png, png_bytep data, size_t size)
{
    struct byte_buffer *out = png_get_io_ptr(png);
    if (!byte_buffer_write(out, out->size, data, size))
        png_error(png, "out of memory");
}

// Writes an image of 4 x 4 pixels whose samples are 0, 1, 2 … in the file's own units.
static void write_png(int colour_type, int depth, int interlace, struct byte_buffer *out)
{
    enum { SIDE = 4 };
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
    png_infop info = png_create_info_struct(png);
    png_set_write_fn(png, out, store, NULL);
    png_set_IHDR(png, info, SIDE, SIDE, depth, colour_type, interlace, PNG_COMPRESSION_TYPE_DEFAULT,
                 PNG_FILTER_TYPE_DEFAULT);
    png_color palette[16];
    for (int i = 0; i < 16; i++)
        palette[i] = (png_color){(png_byte)(10 * i), (png_byte)(11 * i), (png_byte)(12 * i)};
    if (colour_type == PNG_COLOR_TYPE_PALETTE)
        png_set_PLTE(png, info, palette, 16);
    png_write_info(png, info);
    uint8_t bytes[SIDE][SIDE * 8];
    png_bytep rows[SIDE];
    int channels = png_get_channels(png, info), sample = 0;
    memset(bytes, 0, sizeof bytes);
    for (int y = 0; y < SIDE; y++) {
        rows[y] = bytes[y];
        for (int i = 0; i < SIDE * channels; i++, sample++) {
            if (depth == 16) {
                bytes[y][2 * i] = (uint8_t)sample;
                bytes[y][2 * i + 1] = 200;
            } else {
                bytes[y][i * depth / 8] |=
                    (uint8_t)((sample & ((1 << depth) - 1)) << (8 - depth - i * depth % 8));
            }
        }
    }
    png_write_image(png, rows);
    png_write_end(png, NULL);
    png_destroy_write_struct(&png, &info);
}

static float expected_value(int colour_type, int depth, int pixel, int c)
{
    int channels = colour_type == PNG_COLOR_TYPE_RGB          ? 3
                   : colour_type == PNG_COLOR_TYPE_RGB_ALPHA  ? 4
                   : colour_type == PNG_COLOR_TYPE_GRAY_ALPHA ? 2
                                                              : 1;
    int sample = channels * pixel + (channels >= 3 ? c : 0);
    if (colour_type == PNG_COLOR_TYPE_PALETTE)
        return image_srgb_to_linear((float)((10 + c) * sample) / 255);
    if (depth == 16)
        return image_srgb_to_linear((float)(sample * 256 + 200) / 65535);
    int greatest = (1 << depth) - 1;
    return image_srgb_to_linear((float)(sample & greatest) / (float)greatest);
}

TEST(all_colour_types_are_read)
{
    static const struct {
        int colour_type, depth;
    } types[] = {
        {PNG_COLOR_TYPE_GRAY, 1},        {PNG_COLOR_TYPE_GRAY, 2},
        {PNG_COLOR_TYPE_GRAY, 4},        {PNG_COLOR_TYPE_GRAY, 8},
        {PNG_COLOR_TYPE_GRAY, 16},       {PNG_COLOR_TYPE_RGB, 8},
        {PNG_COLOR_TYPE_RGB, 16},        {PNG_COLOR_TYPE_PALETTE, 4},
        {PNG_COLOR_TYPE_PALETTE, 8},     {PNG_COLOR_TYPE_GRAY_ALPHA, 8},
        {PNG_COLOR_TYPE_GRAY_ALPHA, 16}, {PNG_COLOR_TYPE_RGB_ALPHA, 8},
        {PNG_COLOR_TYPE_RGB_ALPHA, 16},
    };
    for (size_t i = 0; i < sizeof types / sizeof types[0]; i++)
        for (int interlace = 0; interlace < 2; interlace++) {
            struct byte_buffer file = {0};
            struct arena arena = {0};
            struct image image;
            struct err err = {0};
            write_png(types[i].colour_type, types[i].depth, interlace, &file);
            REQUIRE(picture_decode(file.data, file.size, &arena, &image, &err), "%s", err.msg);
            for (int k = 0; k < 48; k++) {
                float value = expected_value(types[i].colour_type, types[i].depth, k / 3, k % 3);
                CHECK(fabsf(image.pixels[k / 3][k % 3] - value) <= 1e-6f * value,
                      "type %d, depth %d, interlace %d, sample %d: %g, expected %g",
                      types[i].colour_type, types[i].depth, interlace, k,
                      (double)image.pixels[k / 3][k % 3], (double)value);
            }
            picture_check_cuts(file.data, file.size);
            picture_check_flips(file.data, file.size);
            arena_finish(&arena);
            byte_buffer_finish(&file);
        }
}

static uint32_t crc_of(const uint8_t *data, size_t size) // PNG specification, annex D
{
    uint32_t crc = UINT32_MAX;
    for (size_t i = 0; i < size; i++) {
        crc ^= data[i];
        for (int k = 0; k < 8; k++)
            crc = crc & 1 ? 0xedb88320u ^ crc >> 1 : crc >> 1;
    }
    return ~crc;
}

TEST(sizes_are_checked_before_allocation)
{
    static const uint8_t sides[][8] = {{0x7f, 255, 255, 255, 0x7f, 255, 255, 255},
                                       {0, 1, 0, 0, 0, 1, 0, 0},
                                       {0, 0, 0, 0, 0, 0, 0, 1},
                                       {255, 255, 255, 255, 0, 0, 0, 1}};
    for (int i = 0; i < 4; i++) {
        struct byte_buffer file = {0};
        struct arena arena = {0};
        struct image image;
        struct err err = {0};
        write_png(PNG_COLOR_TYPE_RGB, 8, 0, &file);
        memcpy(file.data + 16, sides[i], 8);
        uint32_t crc = crc_of(file.data + 12, 17);
        for (int k = 0; k < 4; k++)
            file.data[29 + k] = (uint8_t)(crc >> (24 - 8 * k));
        CHECK(!picture_decode(file.data, file.size, &arena, &image, &err) &&
                  (err.code == ERR_BUDGET || err.code == ERR_INPUT) && arena.used_bytes == 0,
              "%s", err.msg);
        arena_finish(&arena);
        byte_buffer_finish(&file);
    }
}

TEST(layers_are_refused)
{
    struct byte_buffer file = {0};
    struct arena arena = {0};
    struct image image;
    struct err err = {0};
    write_png(PNG_COLOR_TYPE_RGB, 8, 0, &file);
    struct image_read_params params = {.path = "m", .layer = "albedo"};
    CHECK(!image_decode(file.data, file.size, &params, &arena, &image, &err));
    CHECK(strstr(err.msg, "albedo"), "%s", err.msg);
    byte_buffer_finish(&file);
}

TEST(damaged_files)
{
    struct arena arena = {0};
    struct byte_buffer file = {0};
    struct image image = picture_create(&arena, 7, 5);
    const struct image_attribute attributes[] = {{"seed", "7"}, {"device", "Gerät"}};
    encode(
        &(struct image_write_params){
            .path = "m", .image = &image, .attributes = attributes, .attribute_count = 2},
        &file);
    picture_check_cuts(file.data, file.size);
    picture_check_flips(file.data, file.size);
    byte_buffer_finish(&file);
    arena_finish(&arena);
}

TEST_MAIN(TEST_CASE(all_codes_come_back), TEST_CASE(values_are_clamped_and_exposed),
          TEST_CASE(file_has_the_expected_chunks), TEST_CASE(attributes_come_back),
          TEST_CASE(bad_keys_are_refused), TEST_CASE(noise_is_not_filtered),
          TEST_CASE(all_colour_types_are_read),
          TEST_CASE(sizes_are_checked_before_allocation), TEST_CASE(layers_are_refused),
          TEST_CASE(damaged_files))
