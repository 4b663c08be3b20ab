// Tests image_decode_texels: images with alpha, in codes and in floats, against known texels.
#include "exr_file.h"
#include "picture.h"

#include <jpeglib.h>
#include <png.h>

static bool decode(const void *data, size_t size, bool is_linear, struct arena *arena,
                   struct image_texels *out, struct err *err)
{
    const struct image_read_params params = {.path = "memory", .is_linear = is_linear};
    memory_set_budget(PICTURE_BUDGET);
    bool ok = image_decode_texels(data, size, &params, arena, out, err);
    memory_set_budget(0);
    return ok;
}

static float component(const struct image_texels *texels, uint32_t pixel, uint32_t c)
{
    size_t i = 4 * (size_t)pixel + c;
    return texels->values ? texels->values[((const uint8_t *)texels->texels)[i]][c]
                          : ((const float *)texels->texels)[i];
}

// Values of codes are halves with 11 bits, so rounding changes a value by at most 2^-11, or by
// 2^-25 if that is less.
static float tolerance(const struct image_texels *texels, float value)
{
    return texels->values ? fmaxf(0x1p-11f * value, 0x1p-25f) : 1e-6f * value;
}

// --- PNG -----------------------------------------------------------------------------------------

enum { SIDE = 6, KEY = 3, PALETTE = 16, OPAQUE_FROM = 10 };

struct png_kind {
    int colour_type, depth;
    bool has_key; // the file has a tRNS chunk
};

static void store(png_structp png, png_bytep data, size_t size)
{
    struct byte_buffer *out = png_get_io_ptr(png);
    if (!byte_buffer_write(out, out->size, data, size))
        png_error(png, "out of memory");
}

static unsigned sample_max(const struct png_kind *kind)
{
    return (1u << kind->depth) - 1;
}

// Returns sample number `i` of the image in the file's own units. The first samples are 0, 1, 2 …
static unsigned sample(const struct png_kind *kind, unsigned i)
{
    unsigned value = i < 8 ? i : i * 2654435761u >> 7;
    if (kind->colour_type == PNG_COLOR_TYPE_PALETTE)
        return value % (kind->depth < 4 ? 1u << kind->depth : PALETTE);
    return value & sample_max(kind);
}

static unsigned channels_of(int colour_type)
{
    return colour_type == PNG_COLOR_TYPE_RGB          ? 3
           : colour_type == PNG_COLOR_TYPE_RGB_ALPHA  ? 4
           : colour_type == PNG_COLOR_TYPE_GRAY_ALPHA ? 2
                                                      : 1;
}

static void set_key(const struct png_kind *kind, png_structp png, png_infop info)
{
    png_byte alphas[OPAQUE_FROM];
    unsigned first = kind->colour_type == PNG_COLOR_TYPE_RGB ? 3 : KEY; // pixel 1 is 3, 4, 5
    png_color_16 key = {.gray = (png_uint_16)(KEY & sample_max(kind)),
                        .red = (png_uint_16)first,
                        .green = (png_uint_16)(first + 1),
                        .blue = (png_uint_16)(first + 2)};
    int count = kind->depth < 4 ? 1 << kind->depth : OPAQUE_FROM;
    for (int i = 0; i < OPAQUE_FROM; i++)
        alphas[i] = (png_byte)(20 * i);
    if (kind->colour_type == PNG_COLOR_TYPE_PALETTE)
        png_set_tRNS(png, info, alphas, count, NULL);
    else
        png_set_tRNS(png, info, NULL, 0, &key);
}

static void write_png(const struct png_kind *kind, int interlace, struct byte_buffer *out)
{
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
    png_infop info = png_create_info_struct(png);
    png_set_write_fn(png, out, store, NULL);
    png_set_IHDR(png, info, SIDE, SIDE, kind->depth, kind->colour_type, interlace,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_color palette[PALETTE];
    for (int i = 0; i < PALETTE; i++)
        palette[i] = (png_color){(png_byte)(10 * i), (png_byte)(11 * i), (png_byte)(12 * i)};
    int colours = kind->depth < 4 ? 1 << kind->depth : PALETTE;
    if (kind->colour_type == PNG_COLOR_TYPE_PALETTE)
        png_set_PLTE(png, info, palette, colours);
    if (kind->has_key)
        set_key(kind, png, info);
    png_write_info(png, info);
    uint8_t bytes[SIDE][SIDE * 8] = {0};
    png_bytep rows[SIDE];
    unsigned channels = channels_of(kind->colour_type), number = 0, depth = (unsigned)kind->depth;
    for (int y = 0; y < SIDE; y++) {
        rows[y] = bytes[y];
        for (unsigned i = 0; i < SIDE * channels; i++, number++) {
            unsigned value = sample(kind, number);
            if (depth == 16) {
                bytes[y][2 * i] = (uint8_t)(value >> 8);
                bytes[y][2 * i + 1] = (uint8_t)value;
            } else {
                bytes[y][i * depth / 8] |= (uint8_t)(value << (8 - depth - i * depth % 8));
            }
        }
    }
    png_write_image(png, rows);
    png_write_end(png, NULL);
    png_destroy_write_struct(&png, &info);
}

static void expected_png(const struct png_kind *kind, unsigned pixel, bool is_linear, float out[4])
{
    unsigned channels = channels_of(kind->colour_type), first = channels * pixel;
    float max = (float)sample_max(kind);
    bool is_key = kind->has_key;
    out[3] = 1;
    if (kind->colour_type == PNG_COLOR_TYPE_PALETTE) {
        unsigned index = sample(kind, first);
        for (unsigned c = 0; c < 3; c++)
            out[c] = (float)((10 + c) * index) / 255;
        if (kind->has_key && index < OPAQUE_FROM)
            out[3] = (float)(20 * index) / 255;
    } else {
        for (unsigned c = 0; c < 3; c++) {
            unsigned value = sample(kind, first + (channels >= 3 ? c : 0));
            out[c] = (float)value / max;
            is_key = is_key && value == (KEY & sample_max(kind)) + (channels >= 3 ? c : 0);
        }
        if (channels % 2 == 0)
            out[3] = (float)sample(kind, first + channels - 1) / max;
        if (is_key)
            out[3] = 0;
    }
    for (int c = 0; c < 3 && !is_linear; c++)
        out[c] = image_srgb_to_linear(out[c]);
}

static void check_png(const struct png_kind *kind, int interlace, bool is_linear)
{
    struct byte_buffer file = {0};
    struct arena arena = {0};
    struct image_texels texels;
    struct err err = {0};
    bool has_alpha = false;
    write_png(kind, interlace, &file);
    REQUIRE(decode(file.data, file.size, is_linear, &arena, &texels, &err), "%s", err.msg);
    CHECK(texels.width == SIDE && texels.height == SIDE);
    CHECK(!texels.values == (kind->depth == 16), "depth %d", kind->depth);
    CHECK(texels.is_srgb == (texels.values && !is_linear), "depth %d", kind->depth);
    for (unsigned i = 0; i < SIDE * SIDE; i++) {
        float expected[4];
        expected_png(kind, i, is_linear, expected);
        has_alpha |= expected[3] < 1;
        for (unsigned c = 0; c < 4; c++)
            CHECK(fabsf(component(&texels, i, c) - expected[c]) <= tolerance(&texels, expected[c]),
                  "type %d, depth %d, key %d, interlace %d, linear %d, pixel %u, component %u: %g, "
                  "expected %g",
                  kind->colour_type, kind->depth, kind->has_key, interlace, is_linear, i, c,
                  (double)component(&texels, i, c), (double)expected[c]);
    }
    CHECK(has_alpha == (kind->has_key || channels_of(kind->colour_type) % 2 == 0),
          "the test has no transparent pixel, or one too many");
    arena_finish(&arena);
    byte_buffer_finish(&file);
}

TEST(png_of_every_kind)
{
    static const struct png_kind kinds[] = {
        {PNG_COLOR_TYPE_GRAY, 1, false},       {PNG_COLOR_TYPE_GRAY, 1, true},
        {PNG_COLOR_TYPE_GRAY, 2, false},       {PNG_COLOR_TYPE_GRAY, 2, true},
        {PNG_COLOR_TYPE_GRAY, 4, false},       {PNG_COLOR_TYPE_GRAY, 4, true},
        {PNG_COLOR_TYPE_GRAY, 8, false},       {PNG_COLOR_TYPE_GRAY, 8, true},
        {PNG_COLOR_TYPE_GRAY, 16, false},      {PNG_COLOR_TYPE_GRAY, 16, true},
        {PNG_COLOR_TYPE_RGB, 8, false},        {PNG_COLOR_TYPE_RGB, 8, true},
        {PNG_COLOR_TYPE_RGB, 16, false},       {PNG_COLOR_TYPE_RGB, 16, true},
        {PNG_COLOR_TYPE_PALETTE, 1, false},    {PNG_COLOR_TYPE_PALETTE, 1, true},
        {PNG_COLOR_TYPE_PALETTE, 2, false},    {PNG_COLOR_TYPE_PALETTE, 2, true},
        {PNG_COLOR_TYPE_PALETTE, 4, false},    {PNG_COLOR_TYPE_PALETTE, 4, true},
        {PNG_COLOR_TYPE_PALETTE, 8, false},    {PNG_COLOR_TYPE_PALETTE, 8, true},
        {PNG_COLOR_TYPE_GRAY_ALPHA, 8, false}, {PNG_COLOR_TYPE_GRAY_ALPHA, 16, false},
        {PNG_COLOR_TYPE_RGB_ALPHA, 8, false},  {PNG_COLOR_TYPE_RGB_ALPHA, 16, false},
    };
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++)
        for (int interlace = 0; interlace < 2; interlace++)
            for (int is_linear = 0; is_linear < 2; is_linear++)
                check_png(&kinds[i], interlace, is_linear);
}

// The values must keep all codes distinct, including an alpha of 1 from one of 254 / 255.
TEST(values_keep_all_codes)
{
    for (int is_srgb = 0; is_srgb < 2; is_srgb++) {
        struct arena arena = {0};
        struct err err = {0};
        float(*values)[4];
        REQUIRE(image_code_values(is_srgb, &arena, &values, &err), "%s", err.msg);
        for (int c = 0; c < 4; c++) {
            for (int i = 0; i < 256; i++) {
                float encoded = (float)i / 255;
                float wanted = is_srgb && c < 3 ? image_srgb_to_linear(encoded) : encoded;
                CHECK(values[i][c] == float_from_half(half_from_float(wanted)), "code %d", i);
                CHECK(i == 0 || values[i][c] > values[i - 1][c], "code %d", i);
            }
            CHECK(values[0][c] == 0 && values[255][c] == 1);
        }
        arena_finish(&arena);
    }
}

// --- JPEG ----------------------------------------------------------------------------------------

// Checks an image of one colour, for which quality 100 keeps every code within 1.
static void check_jpeg(J_COLOR_SPACE space, int components, bool is_linear)
{
    static const JSAMPLE codes[3] = {200, 60, 20};
    struct jpeg_compress_struct compress;
    struct jpeg_error_mgr error;
    unsigned char *data = NULL;
    unsigned long size = 0;
    compress.err = jpeg_std_error(&error);
    jpeg_create_compress(&compress);
    jpeg_mem_dest(&compress, &data, &size);
    compress.image_width = compress.image_height = SIDE;
    compress.input_components = components;
    compress.in_color_space = space;
    jpeg_set_defaults(&compress);
    jpeg_set_quality(&compress, 100, TRUE);
    jpeg_start_compress(&compress, TRUE);
    JSAMPLE row[3 * SIDE];
    for (int i = 0; i < SIDE * components; i++)
        row[i] = codes[i % components];
    for (int y = 0; y < SIDE; y++)
        jpeg_write_scanlines(&compress, &(JSAMPROW){row}, 1);
    jpeg_finish_compress(&compress);
    jpeg_destroy_compress(&compress);

    struct arena arena = {0};
    struct image_texels texels;
    struct err err = {0};
    REQUIRE(decode(data, size, is_linear, &arena, &texels, &err), "%s", err.msg);
    CHECK(texels.width == SIDE && texels.height == SIDE && texels.values);
    for (uint32_t i = 0; i < SIDE * SIDE; i++) {
        CHECK(component(&texels, i, 3) == 1.0f);
        for (uint32_t c = 0; c < 3; c++) {
            float value = component(&texels, i, c);
            float code = 255 * (is_linear ? value : image_srgb_from_linear(value));
            float wanted = (float)codes[components == 3 ? c : 0];
            CHECK(fabsf(code - wanted) <= 1.1f, "%g, expected %g", (double)code, (double)wanted);
        }
    }
    arena_finish(&arena);
    free(data);
}

TEST(jpeg_grey_and_colour)
{
    for (int is_linear = 0; is_linear < 2; is_linear++) {
        check_jpeg(JCS_GRAYSCALE, 1, is_linear);
        check_jpeg(JCS_RGB, 3, is_linear);
    }
}

// --- HDR and EXR ---------------------------------------------------------------------------------

TEST(hdr_is_opaque)
{
    // 2 x 1 pixels: (128, 64, 32) 2^(138 - 136), and 2^17, which exceeds halves.
    static const char file[] =
        "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n\x80\x40\x20\x8a\x80\x80\x80\x92";
    static const float expected[8] = {512, 256, 128, 1, 131072, 131072, 131072, 1};
    struct arena arena = {0};
    struct image_texels texels;
    struct err err = {0};
    REQUIRE(decode(file, sizeof file - 1, false, &arena, &texels, &err), "%s", err.msg);
    CHECK(!texels.values && texels.width == 2 && texels.height == 1);
    CHECK(memcmp(texels.texels, expected, sizeof expected) == 0, "%g",
          (double)component(&texels, 1, 0));
    arena_finish(&arena);
}

// Checks the values of exr_file_value(); colours are divided by the alpha that they contain.
static void check_exr(const struct exr_file *file, const int channel[4])
{
    struct byte_buffer bytes = {0};
    struct arena arena = {0};
    struct image_texels texels;
    struct err err = {0};
    REQUIRE(exr_file_write(file, &bytes));
    REQUIRE(decode(bytes.data, bytes.size, false, &arena, &texels, &err), "%s", err.msg);
    CHECK(!texels.values && texels.width == 5 && texels.height == 4);
    for (uint32_t i = 0; i < 20; i++) {
        int x = (int)i % 5, y = (int)i / 5;
        float alpha = channel[3] < 0 ? 1 : exr_file_value(x, y, channel[3]);
        CHECK(component(&texels, i, 3) == alpha, "%g", (double)component(&texels, i, 3));
        for (uint32_t c = 0; c < 3; c++) {
            float stored = exr_file_value(x, y, channel[c]);
            float wanted = alpha == 0 ? stored : stored / alpha;
            CHECK(component(&texels, i, c) == wanted, "pixel %u, component %u: %g, expected %g", i,
                  c, (double)component(&texels, i, c), (double)wanted);
        }
    }
    arena_finish(&arena);
    byte_buffer_finish(&bytes);
}

TEST(exr_with_and_without_alpha)
{
    struct exr_file file = {
        .window = {.min = {.x = -3, .y = 2}, .max = {.x = 1, .y = 5}},
        .compression = EXR_COMPRESSION_ZIP,
        .channels = {{"A", EXR_PIXEL_HALF, 0},
                     {"B", EXR_PIXEL_FLOAT, 0},
                     {"G", EXR_PIXEL_FLOAT, 0},
                     {"R", EXR_PIXEL_HALF, 0}},
    };
    check_exr(&file, (const int[]){3, 2, 1, 0});
    file.tile = 2;
    check_exr(&file, (const int[]){3, 2, 1, 0});
    file.tile = 0;
    memmove(&file.channels[0], &file.channels[1], 3 * sizeof file.channels[0]);
    file.channels[3].name = NULL;
    check_exr(&file, (const int[]){2, 1, 0, -1});
    file.channels[0].name = "A";
    file.channels[1].name = "Y";
    file.channels[2].name = NULL;
    check_exr(&file, (const int[]){1, 1, 1, 0});
}

// --- limits --------------------------------------------------------------------------------------

TEST(sides_and_memory_are_limited)
{
    const struct png_kind kind = {PNG_COLOR_TYPE_RGB, 8, false};
    struct byte_buffer file = {0};
    struct arena arena = {0};
    struct image_texels texels;
    struct image_read_params params = {.path = "memory", .side_max = SIDE};
    struct err err = {0};
    write_png(&kind, 0, &file);
    CHECK(image_decode_texels(file.data, file.size, &params, &arena, &texels, &err), "%s", err.msg);
    params.side_max = SIDE - 1;
    CHECK(!image_decode_texels(file.data, file.size, &params, &arena, &texels, &err) &&
              err.code == ERR_INPUT &&
              strstr(err.msg, "6 x 6 pixels; expected at most 5 on a side"),
          "%s", err.msg);
    CHECK(!texels.texels);
    params = (struct image_read_params){.path = "memory"};
    memory_set_budget(memory_used() + SIDE * SIDE * 4);
    CHECK(!image_decode_texels(file.data, file.size, &params, &arena, &texels, &err) &&
              err.code == ERR_BUDGET && strstr(err.msg, "--memory"),
          "%s", err.msg);
    memory_set_budget(0);
    arena_finish(&arena);
    byte_buffer_finish(&file);
}

TEST_MAIN(TEST_CASE(png_of_every_kind), TEST_CASE(values_keep_all_codes),
          TEST_CASE(jpeg_grey_and_colour), TEST_CASE(hdr_is_opaque),
          TEST_CASE(exr_with_and_without_alpha), TEST_CASE(sides_and_memory_are_limited))
