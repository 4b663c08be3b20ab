// Reads files made by other programs. The expected values are from other readers: OpenEXR's C++
// library for museum.exr, and a few lines of Python for std_env.hdr.
#include "picture.h"

#include <unistd.h>

static const char *data_file(const char *name)
{
    static char path[4096];
    const char *data = getenv("LAMPYRIS_DATA"), *root = getenv("LAMPYRIS_SOURCE_ROOT");
    if (data)
        snprintf(path, sizeof path, "%s/%s", data, name);
    else
        snprintf(path, sizeof path, "%s/../shared/data/%s", root ? root : ".", name);
    return access(path, R_OK) == 0 ? path : NULL;
}

struct sample {
    uint32_t x, y;
    float rgb[3];
};

static void check_file(const char *path, uint32_t width, uint32_t height, const double mean[3],
                       const struct sample *samples, int count)
{
    struct arena arena = {0};
    struct image image;
    struct err err = {0};
    REQUIRE(image_read(&(struct image_read_params){.path = path}, &arena, &image, &err), "%s",
            err.msg);
    CHECK(image.width == width && image.height == height, "%u x %u", image.width, image.height);
    double sum[3] = {0};
    for (size_t i = 0; i < (size_t)image.width * image.height; i++)
        for (int c = 0; c < 3; c++)
            sum[c] += image.pixels[i][c];
    for (int c = 0; c < 3; c++) {
        double got = sum[c] / ((double)width * height);
        CHECK(fabs(got / mean[c] - 1) < 1e-12, "channel %d: mean %.17g", c, got);
    }
    for (int i = 0; i < count; i++) {
        const float *pixel = image.pixels[(size_t)samples[i].y * width + samples[i].x];
        for (int c = 0; c < 3; c++)
            CHECK(pixel[c] == samples[i].rgb[c], "(%u, %u): %.9g", samples[i].x, samples[i].y,
                  (double)pixel[c]);
    }
    arena_finish(&arena);
}

// The file has half floats with PIZ compression.
TEST(museum_exr)
{
    static const struct sample samples[] = {
        {0, 0, {0.266601562f, 0.153808594f, 0.0751953125f}},
        {17, 0, {0.271728516f, 0.154663086f, 0.0756225586f}},
        {256, 128, {0.302734375f, 0.11932373f, 0.0555114746f}},
        {511, 255, {0.000315904617f, 0.000203132629f, 0.000136613846f}},
        {300, 200, {0.0767822266f, 0.0206451416f, 0.00797271729f}},
    };
    const char *path = data_file("env/museum.exr");
    if (!path)
        SKIP("env/museum.exr is not there (LAMPYRIS_DATA)");
    check_file(path, 512, 256,
               (const double[]){0.3969617462748829, 0.31621130907751649, 0.27836033881521871},
               samples, sizeof samples / sizeof samples[0]);
    struct arena arena = {0};
    struct image_attribute *attributes;
    uint32_t count;
    CHECK(image_read_attributes(path, &arena, &attributes, &count, NULL) && count == 2 &&
          strcmp(attributes[1].key, "LUMINANCE") == 0 &&
          strcmp(attributes[1].value, "RELATIVE") == 0);
    arena_finish(&arena);
}

TEST(std_env_hdr)
{
    static const struct sample samples[] = {
        {0, 0, {0, 0, 0}},
        {750, 375, {0.2490234375f, 0.2490234375f, 0.2490234375f}},
        {1499, 749, {0.498046875f, 0.498046875f, 0.498046875f}},
        {300, 200, {4.3125f, 4.3125f, 4.3125f}},
    };
    const char *path = data_file("env/std_env.hdr");
    if (!path)
        SKIP("env/std_env.hdr is not there (LAMPYRIS_DATA)");
    check_file(path, 1500, 750,
               (const double[]){0.6443805535549894, 0.6443804285549894, 0.6443805535549894},
               samples, sizeof samples / sizeof samples[0]);
}

// Truncated and changed files must be read or refused.
TEST(data_files_damaged)
{
    static const char *const names[] = {"env/museum.exr", "env/std_env.hdr",
                                        "gltf/balloon/textures/material_7_baseColor.jpeg"};
    for (int i = 0; i < 3; i++) {
        const char *path = data_file(names[i]);
        if (!path)
            SKIP("%s is not there (LAMPYRIS_DATA)", names[i]);
        struct arena arena = {0};
        struct file_bytes file;
        REQUIRE(file_read(&arena, path, 0, &file, NULL));
        for (size_t k = 1; k < 20; k++) {
            size_t at = file.size * k / 20;
            CHECK(picture_try(file.data, at, 0, 0) == ERR_INPUT, "%s, %zu bytes", path, at);
            enum err_code code = picture_try(file.data, file.size, at, 0x55);
            CHECK(code == ERR_NONE || code == ERR_INPUT, "%s, byte %zu", path, at);
        }
        arena_finish(&arena);
    }
}

TEST_MAIN(TEST_CASE(museum_exr), TEST_CASE(std_env_hdr), TEST_CASE(data_files_damaged))
