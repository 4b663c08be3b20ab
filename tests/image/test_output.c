#define _GNU_SOURCE // nftw
// Tests errors of writing and limits of reading for all formats.
#include "base/temporary_folder.h"
#include "picture.h"

#include <errno.h>
#include <signal.h>
#include <sys/resource.h>

static char folder[512];
static const char *const names[] = {"picture.exr", "picture.png", "picture.jpg", "picture.hdr",
                                    "picture.pfm"};
enum { NAMES = sizeof names / sizeof *names };

static bool write_picture(const char *path, struct err *err)
{
    struct arena arena = {0};
    struct image image = picture_create(&arena, 60, 40);
    bool ok = image_write(&(struct image_write_params){.path = path, .image = &image}, err);
    arena_finish(&arena);
    return ok;
}

TEST(formats_are_told_by_extension)
{
    struct err err;
    CHECK(image_check_format("a/b.exr", &err) && image_check_format("B.PNG", &err));
    CHECK(image_check_format("a.jpg", &err) && image_check_format("a.JPEG", &err));
    CHECK(image_check_format("a.hdr", &err) && image_check_format("a.pfm", &err));
    CHECK(!image_check_format("a.tga", &err) && err.code == ERR_USAGE);
    CHECK(strstr(err.msg, "a.tga") && strstr(err.msg, ".exr, .png, .jpg, .hdr or .pfm"), "%s",
          err.msg);
    CHECK(!image_check_format("exr", &err) && !image_check_format(".exr", &err));
    CHECK(!write_picture("a.tiff", &err) && err.code == ERR_USAGE);
}

TEST(encoded_is_what_is_written)
{
    REQUIRE(temporary_enter(folder, sizeof folder));
    for (int i = 0; i < NAMES; i++) {
        struct arena arena = {0};
        struct image image = picture_create(&arena, 60, 40);
        const struct image_write_params params = {.path = names[i], .image = &image};
        struct err err = {0};
        struct file_bytes file;
        uint8_t *data = NULL;
        size_t size = 0;
        REQUIRE(image_encode(&params, &arena, &data, &size, &err), "%s", err.msg);
        REQUIRE(access(names[i], F_OK) != 0, "nothing is written");
        REQUIRE(image_write(&params, &err) && file_read(&arena, names[i], 0, &file, &err), "%s",
                err.msg);
        CHECK(size == file.size && memcmp(data, file.data, size) == 0, "%s", names[i]);
        CHECK(!image_encode(&(struct image_write_params){.path = "a.tga", .image = &image}, &arena,
                            &data, &size, &err));
        arena_finish(&arena);
    }
    temporary_leave(folder);
}

TEST(full_disk_is_an_error)
{
    REQUIRE(temporary_enter(folder, sizeof folder));
    for (int i = 0; i < NAMES; i++) {
        struct err err = {0};
        if (symlink("/dev/full", names[i]) != 0 || access(names[i], W_OK) != 0)
            SKIP("/dev/full is not there");
        CHECK(!write_picture(names[i], &err) && err.code == ERR_OUTPUT, "%s", err.msg);
        CHECK(strstr(err.msg, names[i]) || strstr(err.msg, "/dev/full"), "%s", err.msg);
        CHECK(strstr(err.msg, strerror(ENOSPC)), "%s", err.msg);
    }
    temporary_leave(folder);
}

TEST(missing_folder_is_an_error)
{
    struct err err = {0};
    CHECK(!write_picture("/nonexistent-folder/picture.exr", &err) && err.code == ERR_OUTPUT);
    CHECK(!write_picture("/nonexistent-folder/picture.png", &err) && err.code == ERR_OUTPUT);
}

// Even root can write to all folders except those of the kernel.
TEST(unwritable_folder_is_an_error)
{
    REQUIRE(temporary_enter(folder, sizeof folder));
    CHECK(chmod(".", 0500) == 0);
    const char *path = geteuid() == 0 ? "/proc/picture.exr" : "picture.exr";
    struct err err = {0};
    CHECK(!write_picture(path, &err) && err.code == ERR_OUTPUT, "%s", err.msg);
    CHECK(chmod(".", 0700) == 0);
    temporary_leave(folder);
}

// A limit of the file size simulates a disk that becomes full.
TEST(failed_write_keeps_the_old_file)
{
    REQUIRE(temporary_enter(folder, sizeof folder));
    signal(SIGXFSZ, SIG_IGN); // the write then fails with EFBIG
    struct rlimit before, limit;
    REQUIRE(getrlimit(RLIMIT_FSIZE, &before) == 0);
    for (int i = 0; i < NAMES; i++) {
        struct err err = {0};
        REQUIRE(temporary_write(names[i], "old"));
        limit = before;
        limit.rlim_cur = 1000;
        setrlimit(RLIMIT_FSIZE, &limit);
        bool ok = write_picture(names[i], &err);
        setrlimit(RLIMIT_FSIZE, &before);
        CHECK(!ok && err.code == ERR_OUTPUT, "%s", err.msg);
        struct arena arena = {0};
        struct file_bytes file;
        CHECK(file_read(&arena, names[i], 0, &file, NULL) && file.size == 3 &&
              memcmp(file.data, "old", 3) == 0);
        arena_finish(&arena);
        CHECK(temporary_entries(".") == i + 1, "temporary files are left behind");
        CHECK(write_picture(names[i], &err), "%s", err.msg);
    }
    temporary_leave(folder);
}

static bool content_is(const char *path, const void *data, size_t size)
{
    struct arena arena = {0};
    struct file_bytes file;
    bool ok = file_read(&arena, path, 0, &file, NULL) && file.size == size &&
              memcmp(file.data, data, size) == 0;
    arena_finish(&arena);
    return ok;
}

// Encodes noise, with NaN and metadata, so that compression cannot hide a change.
static void encode_noise(const char *path, struct arena *arena, struct image *image,
                         struct image_write_params *params)
{
    static const struct image_attribute attributes[] = {{"lampyris:seed", "17"},
                                                        {"lampyris:device", "Ger\u00e4t"}};
    *image = picture_create(arena, 14, 20);
    for (uint32_t i = 0; i < 14 * 20; i += 5)
        memcpy(image->pixels[i], (const uint32_t[]){0x7fc12345 + i, 0xff812345, 0x80000001}, 12);
    *params = (struct image_write_params){
        .path = path, .image = image, .attributes = attributes, .attribute_count = 2};
}

// Whatever bit of an encoded image is wrong, either nothing is written and the old file remains, or
// the bit has no effect on the image, such as some bits of headers and compressed streams.
TEST(wrong_encodings_are_found_out)
{
    REQUIRE(temporary_enter(folder, sizeof folder));
    for (int i = 0; i < NAMES; i++) {
        struct arena arena = {0};
        struct image image, back;
        struct image_write_params params;
        struct err err = {0};
        uint8_t *good, *bad;
        size_t size, bad_size, harmless = 0;
        encode_noise(names[i], &arena, &image, &params);
        REQUIRE(image_encode(&params, &arena, &good, &size, &err), "%s", err.msg);
        REQUIRE(temporary_write(names[i], "old"));
        for (size_t n = 1; n <= size; n++) {
            struct arena scratch = {0};
            image_corrupt_at(n);
            bool ok = image_encode(&params, &scratch, &bad, &bad_size, &err);
            CHECK(ok || (err.code == ERR_OUTPUT && strstr(err.msg, names[i]) &&
                         strstr(err.msg, "the decoded file differs from the data encoded")),
                  "byte %zu: %s", n, err.msg);
            harmless += ok;
            if (ok && i == 0)
                CHECK(bad_size == size && picture_decode(bad, size, &scratch, &back, &err) &&
                          picture_same_bits(&image, &back),
                      "byte %zu", n);
            arena_finish(&scratch);
        }
        image_corrupt_at(size - 20); // a byte of the pixels: in an EXR of the last block, otherwise
                                     // of the last line
        CHECK(!image_write(&params, &err) && err.code == ERR_OUTPUT, "%s", names[i]);
        image_corrupt_at(0);
        CHECK(content_is(names[i], "old", 3) && temporary_entries(".") == i + 1);
        CHECK(harmless <= (i == 0 ? size / 100 : 0), "%zu of %zu bytes", harmless, size);
        CHECK(image_write(&params, &err) && content_is(names[i], good, size), "%s", err.msg);
        arena_finish(&arena);
    }
    temporary_leave(folder);
}

// Values that must be written exactly although arithmetic would change their bits: signalling NaNs,
// integers above 2^24, and values that halves round or cannot represent.
TEST(right_encodings_pass)
{
    static const uint32_t odd[] = {0x7f800001, 0xffc00000, 0x80000000, 1,          0x7f800000,
                                   0x7f7fffff, 0xffffffff, 0x01000001, 0x47800000, 0x33800001};
    struct arena arena = {0};
    float pixels[10][3];
    for (int i = 0; i < 10; i++)
        for (int c = 0; c < 3; c++)
            memcpy(&pixels[i][c], &odd[(i + c) % 10], sizeof odd[0]);
    const struct image image = {2, 5, pixels};
    const struct image_layer layers[] = {
        {.name = "ids", .values = pixels, .type = IMAGE_LAYER_UINT},
        {.name = "full", .values = pixels, .type = IMAGE_LAYER_FULL},
        {.name = "as", .values = pixels, .type = IMAGE_LAYER_FLOAT},
    };
    for (int half = 0; half < 2; half++) {
        struct image_write_params params = {.path = "a.exr",
                                            .image = &image,
                                            .layers = layers,
                                            .layer_count = 3,
                                            .half_float = half};
        struct err err = {0};
        uint8_t *data;
        size_t size;
        CHECK(image_encode(&params, &arena, &data, &size, &err), "%s", err.msg);
        params.uncompressed = true;
        CHECK(image_encode(&params, &arena, &data, &size, &err), "%s", err.msg);
        params.path = "a.png";
        CHECK(image_encode(&params, &arena, &data, &size, &err), "%s", err.msg);
    }
    arena_finish(&arena);
}

TEST(empty_pictures_are_refused)
{
    struct image image = {0};
    struct err err = {0};
    CHECK(!image_write(&(struct image_write_params){.path = "x.exr", .image = &image}, &err));
    CHECK(err.code == ERR_BUG);
}

TEST(reading_what_is_no_picture)
{
    REQUIRE(temporary_enter(folder, sizeof folder));
    struct arena arena = {0};
    struct image image;
    struct image_attribute *attributes;
    uint32_t count;
    struct err err = {0};
    CHECK(!image_read(&(struct image_read_params){.path = "none.exr"}, &arena, &image, &err));
    CHECK(err.code == ERR_INPUT && strstr(err.msg, "none.exr"), "%s", err.msg);
    REQUIRE(temporary_write("text.exr", "just text") && temporary_write("empty.png", ""));
    CHECK(!image_read(&(struct image_read_params){.path = "text.exr"}, &arena, &image, &err));
    CHECK(err.code == ERR_INPUT && strstr(err.msg, "expected EXR, HDR, PFM, PNG, JPEG"), "%s",
          err.msg);
    CHECK(!image_read(&(struct image_read_params){.path = "empty.png"}, &arena, &image, &err));
    CHECK(!image_read(&(struct image_read_params){.path = "."}, &arena, &image, &err));
    CHECK(err.code == ERR_INPUT && !image.pixels);
    CHECK(!image_read_attributes("text.exr", &arena, &attributes, &count, &err) && count == 0);
    CHECK(err.code == ERR_INPUT && strncmp(err.msg, "text.exr: ", 10) == 0, "%s", err.msg);
    arena_finish(&arena);
    temporary_leave(folder);
}

TEST(reading_keeps_to_its_budget)
{
    REQUIRE(temporary_enter(folder, sizeof folder));
    for (int i = 0; i < NAMES; i++) {
        struct arena arena = {0};
        struct image image;
        struct err err = {0};
        REQUIRE(write_picture(names[i], &err), "%s", err.msg);
        struct image_read_params params = {.path = names[i]};
        memory_set_budget(60 * 40 * 12);
        CHECK(!image_read(&params, &arena, &image, &err) && err.code == ERR_BUDGET, "%s", err.msg);
        CHECK(strstr(err.msg, "--memory"), "%s", err.msg);
        CHECK(arena.used_bytes == 0, "%zu", arena.used_bytes);
        memory_set_budget(2 << 20);
        CHECK(image_read(&params, &arena, &image, &err), "%s", err.msg);
        arena_finish(&arena);
        CHECK(memory_used() == 0, "%llu bytes are left", (unsigned long long)memory_used());
        memory_set_budget(0);
    }
    temporary_leave(folder);
}

// Allocation number n fails, for all n until reading succeeds.
TEST(reading_survives_exhausted_memory)
{
    REQUIRE(temporary_enter(folder, sizeof folder));
    for (int i = 0; i < NAMES; i++) {
        struct err err = {0};
        REQUIRE(write_picture(names[i], &err), "%s", err.msg);
        bool ok = false;
        int failures = 0;
        for (uint64_t n = 1; !ok && n < 100; n++) {
            struct arena arena = {0};
            struct image image;
            arena_fail_at(n);
            ok = image_read(&(struct image_read_params){.path = names[i]}, &arena, &image, &err);
            CHECK(ok || err.code == ERR_SYSTEM, "%s", err.msg);
            failures += !ok;
            arena_finish(&arena);
        }
        arena_fail_at(0);
        CHECK(ok && failures >= 2, "%d failures", failures);
    }
    temporary_leave(folder);
}

TEST_MAIN(TEST_CASE(formats_are_told_by_extension), TEST_CASE(encoded_is_what_is_written),
          TEST_CASE(full_disk_is_an_error), TEST_CASE(missing_folder_is_an_error),
          TEST_CASE(unwritable_folder_is_an_error), TEST_CASE(failed_write_keeps_the_old_file),
          TEST_CASE(wrong_encodings_are_found_out), TEST_CASE(right_encodings_pass),
          TEST_CASE(empty_pictures_are_refused), TEST_CASE(reading_what_is_no_picture),
          TEST_CASE(reading_keeps_to_its_budget), TEST_CASE(reading_survives_exhausted_memory))
