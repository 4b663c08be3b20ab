#include "picture.h"

#include <jpeglib.h>

struct jpeg_file {
    unsigned char *data;
    unsigned long size;
};

// A ramp in quality 100, whose samples are 4 x + 8 y + 20 channel.
enum scans { SCANS_ONE, SCANS_PROGRESSIVE, SCANS_OF_COMPONENTS };

static struct jpeg_file jpeg_write(J_COLOR_SPACE space, int components, int side, enum scans scans)
{
    struct jpeg_compress_struct compress;
    struct jpeg_error_mgr error;
    struct jpeg_file file = {0};
    compress.err = jpeg_std_error(&error);
    jpeg_create_compress(&compress);
    jpeg_mem_dest(&compress, &file.data, &file.size);
    compress.image_width = compress.image_height = (JDIMENSION)side;
    compress.input_components = components;
    compress.in_color_space = space;
    jpeg_set_defaults(&compress);
    jpeg_set_quality(&compress, 100, TRUE);
    for (int i = 0; i < components; i++)
        compress.comp_info[i].h_samp_factor = compress.comp_info[i].v_samp_factor = 1;
    static const jpeg_scan_info separate[] = {
        {1, {0}, 0, 63, 0, 0}, {1, {1}, 0, 63, 0, 0}, {1, {2}, 0, 63, 0, 0}};
    if (scans == SCANS_PROGRESSIVE)
        jpeg_simple_progression(&compress);
    if (scans == SCANS_OF_COMPONENTS) {
        compress.scan_info = separate;
        compress.num_scans = 3;
    }
    jpeg_start_compress(&compress, TRUE);
    for (int y = 0; y < side; y++) {
        JSAMPLE row[64 * 4];
        for (int i = 0; i < side * components; i++)
            row[i] = (JSAMPLE)(4 * (i / components) + 8 * y + 20 * (i % components));
        JSAMPROW rows = row;
        jpeg_write_scanlines(&compress, &rows, 1);
    }
    jpeg_finish_compress(&compress);
    jpeg_destroy_compress(&compress);
    return file;
}

static void check_file(J_COLOR_SPACE space, int components, enum scans scans)
{
    enum { SIDE = 13 };
    struct jpeg_file file = jpeg_write(space, components, SIDE, scans);
    struct arena arena = {0};
    struct image image;
    struct err err = {0};
    REQUIRE(picture_decode(file.data, file.size, &arena, &image, &err), "%s", err.msg);
    CHECK(image.width == SIDE && image.height == SIDE);
    for (int i = 0; i < SIDE * SIDE * 3; i++) {
        int x = i / 3 % SIDE, y = i / 3 / SIDE, channel = components == 3 ? i % 3 : 0;
        float code = 255 * image_srgb_from_linear(image.pixels[i / 3][i % 3]);
        int expected = 4 * x + 8 * y + 20 * channel;
        CHECK(fabsf(code - (float)expected) <= 3, "(%d, %d): %g, expected %d", x, y, (double)code,
              expected);
    }
    picture_check_cuts(file.data, file.size);
    picture_check_flips(file.data, file.size);
    arena_finish(&arena);
    free(file.data);
}

TEST(colour)
{
    check_file(JCS_RGB, 3, SCANS_ONE);
    check_file(JCS_RGB, 3, SCANS_OF_COMPONENTS);
}

TEST(colour_progressive)
{
    check_file(JCS_RGB, 3, SCANS_PROGRESSIVE);
}

TEST(grey)
{
    check_file(JCS_GRAYSCALE, 1, SCANS_ONE);
    check_file(JCS_GRAYSCALE, 1, SCANS_PROGRESSIVE);
}

static void check_refused(const struct jpeg_file *file, const char *reason)
{
    struct arena arena = {0};
    struct image image;
    struct err err = {0};
    CHECK(!picture_decode(file->data, file->size, &arena, &image, &err) &&
              (err.code == ERR_INPUT || err.code == ERR_BUDGET),
          "%d %s", err.code, err.msg);
    CHECK(strstr(err.msg, reason), "\"%s\" should contain \"%s\"", err.msg, reason);
    arena_finish(&arena);
}

TEST(cmyk_is_refused)
{
    struct jpeg_file file = jpeg_write(JCS_CMYK, 4, 13, SCANS_ONE);
    check_refused(&file, "JPEG: ");
    free(file.data);
}

// Finds the frame header (marker FFC0 or FFC2), which has height and width after length and
// precision.
static unsigned char *frame_header(const struct jpeg_file *file, unsigned char marker)
{
    for (unsigned long i = 2; i + 9 < file->size; i++)
        if (file->data[i] == 0xff && file->data[i + 1] == marker)
            return file->data + i;
    return NULL;
}

TEST(sizes_are_checked_before_allocation)
{
    struct jpeg_file file = jpeg_write(JCS_RGB, 3, 13, SCANS_ONE);
    unsigned char *frame = frame_header(&file, 0xc0);
    REQUIRE(frame);
    memset(frame + 5, 0xf0, 4); // 61,680 pixels per side
    check_refused(&file, "61680 x 61680 pixels: 63.8 GiB are needed");
    memset(frame + 5, 0xff, 4); // more than libjpeg accepts
    check_refused(&file, "JPEG: ");
    free(file.data);
}

// The last scan is repeated; each repetition costs a pass over the whole image.
TEST(endless_scans_are_refused)
{
    struct jpeg_file file = jpeg_write(JCS_RGB, 3, 13, SCANS_OF_COMPONENTS);
    unsigned long last = 0;
    for (unsigned long i = 2; i + 1 < file.size; i++)
        if (file.data[i] == 0xff && file.data[i + 1] == 0xda)
            last = i;
    REQUIRE(last > 0);
    unsigned long scan = file.size - 2 - last;
    struct jpeg_file many = {malloc(file.size + 2000 * scan), last};
    memcpy(many.data, file.data, last);
    for (int i = 0; i < 2000; i++, many.size += scan)
        memcpy(many.data + many.size, file.data + last, scan);
    memcpy(many.data + many.size, "\xff\xd9", 2);
    many.size += 2;
    check_refused(&many, "more than 100 scans");
    free(many.data);
    free(file.data);
}

TEST_MAIN(TEST_CASE(colour), TEST_CASE(colour_progressive), TEST_CASE(grey),
          TEST_CASE(cmyk_is_refused), TEST_CASE(sizes_are_checked_before_allocation),
          TEST_CASE(endless_scans_are_refused))
