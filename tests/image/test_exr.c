#define _GNU_SOURCE // nftw, memmem
#include "base/log.h"
#include "base/temporary_folder.h"
#include "exr_file.h"
#include "picture.h"

static char folder[512];

// Writes a file, reads its bytes and decodes them.
static bool encode(const struct image_write_params *params, struct byte_buffer *out)
{
    struct err err = {0};
    bool ok = image_exr_write(params, out, &err);
    CHECK(ok, "%s", err.msg);
    return ok;
}

static bool decode_layer(const struct byte_buffer *file, const char *layer, struct arena *arena,
                         struct image *out, struct err *err)
{
    struct image_read_params params = {.path = "memory", .layer = layer};
    memory_set_budget(PICTURE_BUDGET);
    bool ok = image_decode(file->data, file->size, &params, arena, out, err);
    memory_set_budget(0);
    return ok;
}

TEST(floats_come_back_bit_by_bit)
{
    static const uint32_t sizes[][2] = {{1, 1}, {5, 3}, {17, 16}, {16, 17}, {130, 50}};
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        struct arena arena = {0};
        struct byte_buffer file = {0};
        struct image image = picture_create(&arena, sizes[i][0], sizes[i][1]), back = {0};
        struct err err = {0};
        // Bit patterns that arithmetic would not preserve.
        static const uint32_t odd[] = {0x7fc12345, 0x80000000, 1, 0xff800000, 0x7f7fffff};
        if (sizes[i][0] > 1)
            memcpy(image.pixels, odd, sizeof odd);
        encode(&(struct image_write_params){.path = "m", .image = &image}, &file);
        CHECK(decode_layer(&file, NULL, &arena, &back, &err), "%s", err.msg);
        CHECK(back.pixels && picture_same_bits(&image, &back), "%u x %u", sizes[i][0], sizes[i][1]);
        byte_buffer_finish(&file);
        arena_finish(&arena);
    }
}

// Both are read as other readers do, by the size of their blocks.
TEST(uncompressed_files)
{
    struct arena arena = {0};
    struct byte_buffer file = {0};
    struct image image = picture_create(&arena, 17, 35), back;
    struct err err = {0};
    for (int half = 0; half < 2; half++) {
        encode(
            &(struct image_write_params){
                .path = "m", .image = &image, .uncompressed = true, .half_float = half},
            &file);
        size_t bytes = 35 * (8 + 8 + 17 * 3 * (half ? sizeof(uint16_t) : sizeof(float)));
        CHECK(file.size > bytes && file.size < bytes + 500, "%zu", file.size);
        REQUIRE(decode_layer(&file, NULL, &arena, &back, &err), "%s", err.msg);
        for (int i = 0; half && i < 17 * 35 * 3; i++)
            image.pixels[i / 3][i % 3] =
                float_from_half(half_from_float(image.pixels[i / 3][i % 3]));
        CHECK(picture_same_bits(&image, &back), "%d", half);
        byte_buffer_finish(&file);
    }
    arena_finish(&arena);
}

static int warnings;
static char last_warning[256];

static void keep_warning(void *context, enum log_level level, const char *message)
{
    (void)context;
    warnings += level == LOG_WARN;
    snprintf(last_warning, sizeof last_warning, "%s", message);
}

TEST(halves_are_rounded_and_saturate)
{
    struct arena arena = {0};
    struct byte_buffer file = {0};
    float pixels[40][3] = {{1.0f / 3, 1 + 0x1p-11f, 1 + 3 * 0x1p-11f},
                           {65504, 65520, -1e6f},
                           {INFINITY, NAN, 0x1p-24f}};
    struct image image = {2, 20, pixels}, back = {0};
    log_configure(LOG_WARN, keep_warning, NULL);
    warnings = 0;
    encode(&(struct image_write_params){.path = "m.exr", .image = &image, .half_float = true},
           &file);
    log_configure(LOG_WARN, NULL, NULL);
    CHECK(warnings == 1 && strstr(last_warning, "m.exr: 2 values exceed 65504"), "%s",
          last_warning);
    REQUIRE(decode_layer(&file, NULL, &arena, &back, NULL));
    CHECK(back.pixels[0][0] == 0.333251953125f && back.pixels[0][1] == 1 &&
          back.pixels[0][2] == 1 + 0x1p-9f);
    CHECK(back.pixels[1][0] == 65504 && back.pixels[1][1] == 65504 && back.pixels[1][2] == -65504);
    CHECK(isinf(back.pixels[2][0]) && isnan(back.pixels[2][1]) && back.pixels[2][2] == 0x1p-24f);
    byte_buffer_finish(&file);
    arena_finish(&arena);
}

TEST(layers_and_attributes_come_back)
{
    REQUIRE(temporary_enter(folder, sizeof folder));
    struct arena arena = {0};
    struct image image = picture_create(&arena, 21, 35), albedo = picture_create(&arena, 21, 35);
    albedo.pixels[7][1] = -3;
    image.pixels[7][1] = 1e30f;
    char long_name[200], long_value[5000];
    memset(long_name, 'n', sizeof long_name - 1);
    memset(long_value, 'v', sizeof long_value - 1);
    long_name[sizeof long_name - 1] = long_value[sizeof long_value - 1] = '\0';
    // In the order of names, "A.R" is before "B", and "albedo.R" after "R".
    const struct image_layer layers[] = {{"albedo", (const float(*)[3])albedo.pixels},
                                         {"A", (const float(*)[3])albedo.pixels},
                                         {long_name, (const float(*)[3])image.pixels}};
    const struct image_attribute attributes[] = {{"lampyris.seed", "17"},
                                                 {"device", "Gerät \"X\"\nline"},
                                                 {"empty", ""},
                                                 {long_name, long_value}};
    struct err err = {0};
    for (int half = 0; half < 2; half++) {
        struct image_write_params params = {.path = "p.EXR",
                                            .image = &image,
                                            .layers = layers,
                                            .layer_count = 3,
                                            .attributes = attributes,
                                            .attribute_count = 4};
        REQUIRE(image_write(&params, &err), "%s", err.msg);
        struct image back;
        for (int i = -1; i < 3; i++) {
            struct image_read_params read = {.path = "p.EXR",
                                             .layer = i < 0 ? NULL : layers[i].name};
            const struct image *expected = i == 0 || i == 1 ? &albedo : &image;
            REQUIRE(image_read(&read, &arena, &back, &err), "%s", err.msg);
            CHECK(picture_same_bits(expected, &back), "layer %d", i);
        }
        struct image_read_params read = {.path = "p.EXR", .layer = "normal"};
        CHECK(!image_read(&read, &arena, &back, &err) && err.code == ERR_INPUT);
        CHECK(strstr(err.msg, "normal.{R, G, B}") &&
                  strstr(err.msg, "present are A.B, A.G, A.R, B,"),
              "%s", err.msg);
        struct image_attribute *got;
        uint32_t count;
        REQUIRE(image_read_attributes("p.EXR", &arena, &got, &count, &err), "%s", err.msg);
        CHECK(count == 4, "%u", count);
        for (uint32_t i = 0; i < count && i < 4; i++)
            CHECK(strcmp(got[i].key, attributes[i].key) == 0 &&
                      strcmp(got[i].value, attributes[i].value) == 0,
                  "%s = %s", got[i].key, got[i].value);
    }
    arena_finish(&arena);
    temporary_leave(folder);
}

// Layers may have other channel names and types. Integers, and layers that request it, keep 32 bits
// beside halves.
TEST(layers_of_other_types)
{
    enum { WIDTH = 19, HEIGHT = 18, PIXELS = WIDTH * HEIGHT };
    static const char *const depth_names[] = {"Z", NULL},
                             *const axis_names[] = {"X", "Y", "Z", NULL},
                             *const id_names[] = {"object", "material", NULL};
    static float depth[PIXELS], normal[PIXELS][3];
    static uint32_t ids[PIXELS][2];
    struct arena arena = {0};
    struct byte_buffer file = {0};
    struct err err = {0};
    struct image image = picture_create(&arena, WIDTH, HEIGHT), back;
    for (uint32_t i = 0; i < PIXELS; i++) {
        depth[i] = i == 7 ? INFINITY : 1e6f + (float)i / 16.0f;
        ids[i][0] = i + 70000;
        ids[i][1] = i % 5;
        for (uint32_t c = 0; c < 3; c++)
            normal[i][c] = (float)(i + c) / 1024.0f; // halves represent these values exactly
    }
    const struct image_layer layers[] = {{"depth", depth, depth_names, IMAGE_LAYER_FULL},
                                         {"normal", normal, axis_names, IMAGE_LAYER_FLOAT},
                                         {"id", ids, id_names, IMAGE_LAYER_UINT}};
    encode(
        &(struct image_write_params){
            .path = "m", .image = &image, .layers = layers, .layer_count = 3, .half_float = true},
        &file);
    static const char *const read[] = {"depth.Z", "normal", "id.object", "id.material"};
    for (int l = 0; l < 4; l++) {
        uint32_t wrong = 0;
        REQUIRE(decode_layer(&file, read[l], &arena, &back, &err), "%s", err.msg);
        for (uint32_t i = 0; i < PIXELS; i++)
            for (uint32_t c = 0; c < 3; c++)
                wrong += back.pixels[i][c] != (l == 0   ? depth[i]
                                               : l == 1 ? normal[i][c]
                                                        : (float)ids[i][l - 2]);
        CHECK(wrong == 0, "%s: %u values", read[l], wrong);
    }
    CHECK(!decode_layer(&file, "depth", &arena, &back, &err) && strstr(err.msg, "depth.Z"), "%s",
          err.msg);
    byte_buffer_finish(&file);
    arena_finish(&arena);
}

// The bytes of the header are read without the library (OpenEXR file layout): a list of name, type,
// linear flag and three reserved bytes, x and y sampling, sorted by name.
TEST(channels_are_sorted_in_the_file)
{
    struct arena arena = {0};
    struct byte_buffer file = {0};
    struct image image = picture_create(&arena, 2, 2);
    const struct image_layer layers[] = {{"z", (const float(*)[3])image.pixels},
                                         {"N", (const float(*)[3])image.pixels}};
    encode(
        &(struct image_write_params){
            .path = "m", .image = &image, .layers = layers, .layer_count = 2},
        &file);
    static const char start[] = "channels\0chlist";
    const uint8_t *list = memmem(file.data, file.size, start, sizeof start);
    REQUIRE(list);
    const char *entry = (const char *)list + sizeof start + 4;
    static const char *const sorted[] = {"B", "G", "N.B", "N.G", "N.R", "R", "z.B", "z.G", "z.R"};
    for (int i = 0; i < 9; i++) {
        CHECK(strcmp(entry, sorted[i]) == 0, "%s, expected %s", entry, sorted[i]);
        entry += strlen(entry) + 1;
        CHECK(entry[0] == EXR_PIXEL_FLOAT);
        entry += 16;
    }
    CHECK(*entry == '\0');
    byte_buffer_finish(&file);
    arena_finish(&arena);
}

// Checks files from another writer: each value shows from which channel it came.
static void check_file(const struct exr_file *file, const int channels[3], const char *what)
{
    struct byte_buffer buffer = {0};
    struct arena arena = {0};
    struct image image;
    struct err err = {0};
    CHECK(exr_file_write(file, &buffer), "%s", what);
    if (decode_layer(&buffer, NULL, &arena, &image, &err)) {
        int width = file->window.max.x - file->window.min.x + 1;
        CHECK((int)image.width == width &&
                  (int)image.height == file->window.max.y - file->window.min.y + 1,
              "%s", what);
        int wrong = 0;
        for (int i = 0; i < (int)(image.width * image.height); i++)
            for (int c = 0; c < 3; c++)
                wrong += image.pixels[i][c] != exr_file_value(i % width, i / width, channels[c]);
        CHECK(wrong == 0, "%s: %d values", what, wrong);
    } else {
        CHECK(false, "%s: %s", what, err.msg);
    }
    arena_finish(&arena);
    byte_buffer_finish(&buffer);
}

static const int bgr[3] = {2, 1, 0};

TEST(channel_types_are_converted)
{
    struct exr_file file = {.window = {.max = {{{6, 4}}}}, .compression = EXR_COMPRESSION_ZIPS};
    for (int type = EXR_PIXEL_UINT; type <= EXR_PIXEL_FLOAT; type++) {
        for (int c = 0; c < 3; c++) {
            file.channels[c].name = (const char *[]){"B", "G", "R"}[c];
            file.channels[c].type = (exr_pixel_type_t)type;
        }
        check_file(&file, bgr, "one type");
    }
    file.channels[0].type = EXR_PIXEL_HALF;
    file.channels[1].type = EXR_PIXEL_UINT;
    check_file(&file, bgr, "mixed types");
}

TEST(luminance_becomes_grey)
{
    struct exr_file file = {.window = {.max = {{{6, 4}}}},
                            .channels = {{"Y", EXR_PIXEL_HALF}, {"Z", EXR_PIXEL_FLOAT}}};
    check_file(&file, (const int[]){0, 0, 0}, "Y");
    // Reads one of three channels, for which the library's own unpacking writes through a null
    // pointer.
    struct exr_file third = {
        .window = {.max = {{{6, 4}}}},
        .channels = {{"A", EXR_PIXEL_HALF}, {"B", EXR_PIXEL_HALF}, {"Y", EXR_PIXEL_HALF}}};
    check_file(&third, (const int[]){2, 2, 2}, "Y of three");
    // Luminance and subsampled chroma, as in OpenEXR's luminance/chroma images.
    struct exr_file chroma = {
        .window = {{{{0, -4}}}, {{{7, 3}}}},
        .channels = {{"BY", EXR_PIXEL_HALF, 2}, {"RY", EXR_PIXEL_HALF, 2}, {"Y", EXR_PIXEL_HALF}}};
    check_file(&chroma, (const int[]){2, 2, 2}, "Y with chroma");
    struct exr_file both = {.window = {.max = {{{6, 4}}}},
                            .channels = {{"A", EXR_PIXEL_HALF},
                                         {"B", EXR_PIXEL_HALF},
                                         {"G", EXR_PIXEL_HALF},
                                         {"R", EXR_PIXEL_HALF},
                                         {"Y", EXR_PIXEL_HALF}}};
    check_file(&both, (const int[]){3, 2, 1}, "RGB before Y");
}

TEST(data_windows_and_tiles)
{
    struct exr_file file = {
        .window = {{{{-3, -20}}}, {{{30, 21}}}},
        .channels = {{"B", EXR_PIXEL_HALF}, {"G", EXR_PIXEL_FLOAT}, {"R", EXR_PIXEL_HALF}}};
    static const exr_compression_t compressions[] = {EXR_COMPRESSION_NONE, EXR_COMPRESSION_RLE,
                                                     EXR_COMPRESSION_ZIPS, EXR_COMPRESSION_ZIP,
                                                     EXR_COMPRESSION_PIZ,  EXR_COMPRESSION_PXR24};
    for (size_t i = 0; i < sizeof compressions / sizeof compressions[0]; i++)
        for (uint32_t tile = 0; tile <= 64; tile = tile ? tile * 4 : 4) {
            file.compression = compressions[i];
            file.tile = tile;
            char what[64];
            snprintf(what, sizeof what, "compression %d, tile %u", compressions[i], tile);
            check_file(&file, bgr, what);
        }
}

static void check_refused(const struct exr_file *file, const char *reason)
{
    struct byte_buffer buffer = {0};
    struct arena arena = {0};
    struct image image;
    struct err err = {0};
    exr_file_write(file, &buffer);
    CHECK(!decode_layer(&buffer, NULL, &arena, &image, &err) && err.code == ERR_INPUT, "%s",
          reason);
    CHECK(strstr(err.msg, reason), "\"%s\" should contain \"%s\"", err.msg, reason);
    arena_finish(&arena);
    byte_buffer_finish(&buffer);
}

TEST(what_is_not_read_is_refused)
{
    struct exr_file rgb = {
        .window = {.max = {{{6, 4}}}},
        .channels = {{"B", EXR_PIXEL_HALF}, {"G", EXR_PIXEL_HALF}, {"R", EXR_PIXEL_HALF}}};
    struct exr_file file = rgb;
    file.deep = true;
    check_refused(&file, "deep");
    file = rgb;
    file.parts = 2;
    check_refused(&file, "2 parts");
    file = rgb;
    file.channels[2].name = "S";
    check_refused(&file, "expected channels {R, G, B} or Y; present are B, G, S");
    file = rgb;
    file.channels[1].sampling = 2;
    file.window.max.x = file.window.max.y = 7;
    check_refused(&file, "channel G is subsampled 2 x 2");
}

// The file is small, but its header declares more than the budget.
TEST(sizes_are_checked_before_allocation)
{
    struct arena arena = {0};
    struct byte_buffer file = {0};
    struct image image = picture_create(&arena, 4, 4), back;
    encode(&(struct image_write_params){.path = "m", .image = &image}, &file);
    static const char start[] = "dataWindow\0box2i";
    uint8_t *window = memmem(file.data, file.size, start, sizeof start);
    REQUIRE(window);
    static const int32_t maxima[][2] = {{0x7fffffff, 3},  {3, 0x7fffffff}, {0x7fffffff, 0x7fffffff},
                                        {100000, 100000}, {0x3fffffff, 0}, {3, 10000000},
                                        {-1, 3},          {3, -2}};
    for (size_t i = 0; i < sizeof maxima / sizeof maxima[0]; i++) {
        struct err err = {0};
        memcpy(window + sizeof start + 4 + 8, maxima[i], 8);
        size_t before = arena.used_bytes;
        CHECK(!decode_layer(&file, NULL, &arena, &back, &err) &&
                  (err.code == ERR_INPUT || err.code == ERR_BUDGET) && arena.used_bytes == before,
              "%d %d: code %d, %s", maxima[i][0], maxima[i][1], err.code, err.msg);
    }
    byte_buffer_finish(&file);
    arena_finish(&arena);
}

TEST(damaged_files)
{
    struct arena arena = {0};
    struct byte_buffer file = {0};
    struct image image = picture_create(&arena, 5, 19);
    const struct image_attribute attribute = {"key", "value"};
    for (int half = 0; half < 2; half++) {
        file.size = 0;
        encode(&(struct image_write_params){.path = "m",
                                            .image = &image,
                                            .half_float = half,
                                            .attributes = &attribute,
                                            .attribute_count = 1},
               &file);
        picture_check_cuts(file.data, file.size);
        picture_check_flips(file.data, file.size);
    }
    static const exr_compression_t compressions[] = {EXR_COMPRESSION_NONE, EXR_COMPRESSION_RLE,
                                                     EXR_COMPRESSION_PIZ, EXR_COMPRESSION_PXR24};
    for (size_t i = 0; i < sizeof compressions / sizeof compressions[0]; i++) {
        struct exr_file other = {
            .window = {.max = {{{8, 6}}}},
            .compression = compressions[i],
            .tile = i % 2 ? 4 : 0,
            .channels = {{"B", EXR_PIXEL_HALF}, {"G", EXR_PIXEL_HALF}, {"R", EXR_PIXEL_HALF}}};
        file.size = 0;
        CHECK(exr_file_write(&other, &file));
        picture_check_cuts(file.data, file.size);
        picture_check_flips(file.data, file.size);
    }
    byte_buffer_finish(&file);
    arena_finish(&arena);
}

// An image that cannot be written is refused with a message that names the error.
TEST(bad_names_are_refused)
{
    struct arena arena = {0};
    struct byte_buffer file = {0};
    struct image image = picture_create(&arena, 2, 2);
    char name[300];
    memset(name, 'n', sizeof name - 1);
    name[sizeof name - 1] = '\0';
    const struct image_layer layers[] = {{"a", (const float(*)[3])image.pixels},
                                         {"a", (const float(*)[3])image.pixels},
                                         {name, (const float(*)[3])image.pixels}};
    const struct image_attribute attributes[] = {{"compression", "text"}, {name, "text"}};
    struct image_write_params params = {.path = "m", .image = &image};
    struct err err = {0};
    params.layers = layers;
    params.layer_count = 2;
    CHECK(!image_exr_write(&params, &file, &err) && strstr(err.msg, "a.R"), "%s", err.msg);
    params.layers = layers + 2;
    params.layer_count = 1;
    CHECK(!image_exr_write(&params, &file, &err) && strstr(err.msg, "nnn"), "%s", err.msg);
    params.layer_count = 0;
    params.attribute_count = 1;
    for (int i = 0; i < 2; i++) {
        params.attributes = attributes + i;
        CHECK(!image_exr_write(&params, &file, &err) && strstr(err.msg, attributes[i].key), "%s",
              err.msg);
        CHECK(err.code == ERR_OUTPUT);
    }
    byte_buffer_finish(&file);
    arena_finish(&arena);
}

TEST_MAIN(TEST_CASE(floats_come_back_bit_by_bit), TEST_CASE(uncompressed_files),
          TEST_CASE(halves_are_rounded_and_saturate), TEST_CASE(layers_and_attributes_come_back),
          TEST_CASE(layers_of_other_types), TEST_CASE(channels_are_sorted_in_the_file),
          TEST_CASE(channel_types_are_converted), TEST_CASE(luminance_becomes_grey),
          TEST_CASE(data_windows_and_tiles), TEST_CASE(what_is_not_read_is_refused),
          TEST_CASE(sizes_are_checked_before_allocation), TEST_CASE(damaged_files),
          TEST_CASE(bad_names_are_refused))
