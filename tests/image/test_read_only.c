// Tests the formats that are only read: WebP and TGA, against texels that are known.
#include "picture.h"

#ifdef HAS_WEBP
#include <webp/encode.h>
#endif

enum { WIDTH = 6, HEIGHT = 4 };

static uint8_t code(int x, int y, int channel)
{
    const int codes[4] = {40 * x, 60 * y, 255 - 30 * x, 255 - 20 * y - 10 * x};
    return (uint8_t)codes[channel];
}

static bool decode(const char *path, const void *data, size_t size, struct arena *arena,
                   struct image_texels *out, struct err *err)
{
    const struct image_read_params params = {.path = path, .is_linear = true};
    memory_set_budget(PICTURE_BUDGET);
    bool ok = image_decode_texels(data, size, &params, arena, out, err);
    memory_set_budget(0);
    return ok;
}

static void check_codes(const struct image_texels *texels, uint8_t (*expected)(int, int, int))
{
    REQUIRE(texels->width == WIDTH && texels->height == HEIGHT && texels->values);
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++)
            for (int c = 0; c < 4; c++) {
                uint8_t found = ((const uint8_t *)texels->texels)[(y * WIDTH + x) * 4 + c];
                CHECK(found == expected(x, y, c), "pixel %d, %d, component %d: %u, expected %u", x,
                      y, c, found, expected(x, y, c));
            }
}

// Every file that lacks bytes is refused with a message that names the path.
static void check_cuts(const char *path, const uint8_t *data, size_t size)
{
    for (size_t cut = 0; cut < size; cut++) {
        struct arena arena = {0};
        struct image_texels texels;
        struct err err = {0};
        uint8_t *copy = malloc(cut > 0 ? cut : 1);
        REQUIRE(copy);
        memcpy(copy, data, cut);
        CHECK(!decode(path, copy, cut, &arena, &texels, &err), "%zu of %zu bytes", cut, size);
        CHECK(err.code == ERR_INPUT && strncmp(err.msg, path, strlen(path)) == 0, "%zu bytes: %s",
              cut, err.msg);
        free(copy);
        arena_finish(&arena);
    }
}

#ifdef HAS_WEBP
static uint8_t opaque_code(int x, int y, int channel)
{
    return channel == 3 ? 255 : code(x, y, channel);
}

static size_t write_webp(bool has_alpha, uint8_t **out)
{
    uint8_t pixels[WIDTH * HEIGHT * 4];
    const int channels = has_alpha ? 4 : 3;
    for (int i = 0; i < WIDTH * HEIGHT * channels; i++)
        pixels[i] = code(i / channels % WIDTH, i / channels / WIDTH, i % channels);
    return has_alpha ? WebPEncodeLosslessRGBA(pixels, WIDTH, HEIGHT, WIDTH * 4, out)
                     : WebPEncodeLosslessRGB(pixels, WIDTH, HEIGHT, WIDTH * 3, out);
}

TEST(webp)
{
    for (int has_alpha = 0; has_alpha < 2; has_alpha++) {
        struct arena arena = {0};
        struct image_texels texels;
        struct image image;
        struct err err = {0};
        uint8_t *data;
        const size_t size = write_webp(has_alpha, &data);
        REQUIRE(size > 0);
        REQUIRE(decode("a.webp", data, size, &arena, &texels, &err), "%s", err.msg);
        check_codes(&texels, has_alpha ? code : opaque_code);
        REQUIRE(picture_decode(data, size, &arena, &image, &err), "%s", err.msg);
        CHECK(image.pixels[7][2] == image_srgb_to_linear((float)code(1, 1, 2) / 255.0f));
        CHECK(image_has_encoding(data, size, "any"));
        // The last byte pads the data to an even length.
        check_cuts("a.webp", data, size - 1);
        WebPFree(data);
        arena_finish(&arena);
    }
}

TEST(webp_keeps_to_its_budget)
{
    struct arena arena = {0};
    struct image_texels texels;
    struct err err = {0};
    uint8_t *data;
    const size_t size = write_webp(true, &data);
    const struct image_read_params params = {.path = "a.webp"};
    memory_set_budget(memory_used() + WIDTH * HEIGHT * 8);
    CHECK(!image_decode_texels(data, size, &params, &arena, &texels, &err) &&
              err.code == ERR_BUDGET,
          "%s", err.msg);
    memory_set_budget(0);
    WebPFree(data);
    arena_finish(&arena);
}

#define WEBP_CASES , TEST_CASE(webp), TEST_CASE(webp_keeps_to_its_budget)
#else
#define WEBP_CASES
#endif

#ifdef HAS_TGA
// The header's fields by byte: 1 has a palette, 2 type (8: run lengths), 5 entries of the palette,
// 7 bits of an entry, 12 width, 14 height, 16 bits of a pixel, 17 descriptor (32: from the top).
struct tga {
    uint8_t bytes[18 + 8 * 3 + WIDTH * HEIGHT * 5];
    size_t size;
};

static void tga_begin(struct tga *file, uint8_t type, uint8_t depth, uint8_t descriptor)
{
    *file = (struct tga){.size = 18};
    file->bytes[1] = type == 1;
    file->bytes[2] = type;
    file->bytes[12] = WIDTH;
    file->bytes[14] = HEIGHT;
    file->bytes[16] = depth;
    file->bytes[17] = descriptor;
}

// Appends a pixel, blue first.
static void tga_add(struct tga *file, int x, int y, int channels)
{
    static const int order[4] = {2, 1, 0, 3};
    for (int c = 0; c < channels; c++)
        file->bytes[file->size++] = channels == 1 ? code(x, y, 0) : code(x, y, order[c]);
}

static void check_tga(const struct tga *file, uint8_t (*expected)(int, int, int))
{
    struct arena arena = {0};
    struct image_texels texels;
    struct err err = {0};
    REQUIRE(decode("a.TGA", file->bytes, file->size, &arena, &texels, &err), "%s", err.msg);
    check_codes(&texels, expected);
    CHECK(image_has_encoding(file->bytes, file->size, "a.tga"));
    arena_finish(&arena);
    check_cuts("a.tga", file->bytes, file->size);
}

static uint8_t grey_code(int x, int y, int channel)
{
    return channel == 3 ? 255 : code(x, y, 0);
}

static uint8_t rgb_code(int x, int y, int channel)
{
    return channel == 3 ? 255 : code(x, y, channel);
}

TEST(tga_of_every_kind)
{
    static const uint8_t depths[] = {8, 24, 32};
    for (int i = 0; i < 3; i++)
        for (int from_top = 0; from_top < 2; from_top++) {
            struct tga file;
            const int channels = depths[i] / 8;
            tga_begin(&file, channels == 1 ? 3 : 2, depths[i], from_top ? 0x20 : 0);
            for (int y = 0; y < HEIGHT; y++)
                for (int x = 0; x < WIDTH; x++)
                    tga_add(&file, x, from_top ? y : HEIGHT - 1 - y, channels);
            check_tga(&file, channels == 1 ? grey_code : channels == 3 ? rgb_code : code);
        }
}

static uint8_t run_code(int x, int y, int channel)
{
    return code(x < 3 ? 0 : x, y, channel);
}

TEST(tga_with_run_lengths)
{
    struct tga file;
    tga_begin(&file, 10, 32, 0x20);
    for (int y = 0; y < HEIGHT; y++) {
        file.bytes[file.size++] = 0x80 | 2; // three times the next pixel
        tga_add(&file, 0, y, 4);
        file.bytes[file.size++] = 2; // three pixels
        for (int x = 3; x < WIDTH; x++)
            tga_add(&file, x, y, 4);
    }
    check_tga(&file, run_code);
}

static uint8_t palette_code(int x, int y, int channel)
{
    return channel == 3 ? 255 : code((x + y) % 4, (x + y) % 4, channel);
}

TEST(tga_with_a_palette)
{
    struct tga file;
    tga_begin(&file, 1, 8, 0x20);
    file.bytes[5] = 4;
    file.bytes[7] = 24;
    for (int i = 0; i < 4; i++)
        tga_add(&file, i, i, 3);
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++)
            file.bytes[file.size++] = (uint8_t)((x + y) % 4);
    check_tga(&file, palette_code);
}

static void check_refused(const struct tga *file, const char *path, const char *message)
{
    struct arena arena = {0};
    struct image_texels texels;
    struct err err = {0};
    CHECK(!decode(path, file->bytes, file->size, &arena, &texels, &err));
    CHECK(err.code == ERR_INPUT && strstr(err.msg, message), "%s", err.msg);
    arena_finish(&arena);
}

TEST(tga_that_is_refused)
{
    struct tga file;
    tga_begin(&file, 2, 24, 0x30);
    file.size = 18 + WIDTH * HEIGHT * 3;
    check_refused(&file, "a.tga", "from right to left; expected left to right");
    file.bytes[17] = 0x20;
    check_refused(&file, "a.bin", "is not an image that can be read");
    file.bytes[12] = 0;
    check_refused(&file, "a.tga", "0 x 4 pixels; expected at least 1 x 1");
    tga_begin(&file, 1, 8, 0x20);
    file.size = 18 + WIDTH * HEIGHT * 3;
    file.bytes[3] = 7;
    check_refused(&file, "a.tga", "the palette begins with index 7; expected 0");
    file.bytes[3] = 0;
    check_refused(&file, "a.tga", "TGA: the data are damaged"); // an empty palette
}

#define TGA_CASES                                                                                  \
    , TEST_CASE(tga_of_every_kind), TEST_CASE(tga_with_run_lengths),                               \
        TEST_CASE(tga_with_a_palette), TEST_CASE(tga_that_is_refused)
#else
#define TGA_CASES
#endif

TEST(ktx2_is_recognized)
{
    static const uint8_t data[16] = "\xabKTX 20\xbb\r\n\x1a\n";
    struct arena arena = {0};
    struct image_texels texels;
    struct err err = {0};
    CHECK(!decode("a.png", data, sizeof data, &arena, &texels, &err) && err.code == ERR_INPUT &&
              strstr(err.msg, "convert it to PNG"),
          "%s", err.msg);
}

TEST_MAIN(TEST_CASE(ktx2_is_recognized) WEBP_CASES TGA_CASES)
