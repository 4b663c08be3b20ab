// Images for tests, and checks that every decoder must pass.
#ifndef LAMPYRIS_TESTS_PICTURE_H
#define LAMPYRIS_TESTS_PICTURE_H

#include "base/file.h"
#include "base/memory.h"
#include "image/image.h"
#include "test.h"

#define PICTURE_BUDGET ((size_t)64 << 20)

// Returns values in [0, 1) that look random and are the same on all machines.
static inline float picture_value(uint32_t i)
{
    uint32_t h = i * 0x9e3779b1u;
    h = (h ^ h >> 15) * 0x85ebca77u;
    return (float)(h >> 8) * 0x1p-24f;
}

static inline struct image picture_create(struct arena *arena, uint32_t width, uint32_t height)
{
    struct image image = {width, height, arena_alloc(arena, (size_t)width * height, 12)};
    for (uint32_t i = 0; image.pixels && i < width * height * 3; i++)
        image.pixels[i / 3][i % 3] = picture_value(i);
    return image;
}

static inline bool picture_same_bits(const struct image *a, const struct image *b)
{
    return a->width == b->width && a->height == b->height &&
           memcmp(a->pixels, b->pixels, (size_t)a->width * a->height * 12) == 0;
}

static inline bool picture_decode(const void *data, size_t size, struct arena *arena,
                                  struct image *out, struct err *err)
{
    struct image_read_params params = {.path = "memory"};
    memory_set_budget(PICTURE_BUDGET);
    bool ok = image_decode(data, size, &params, arena, out, err);
    memory_set_budget(0);
    return ok;
}

// Copies the data to a block of exactly this length, so that the address sanitizer detects reads
// past the end.
static inline enum err_code picture_try(const uint8_t *data, size_t size, size_t changed,
                                        uint8_t mask)
{
    uint8_t *copy = malloc(size > 0 ? size : 1);
    struct arena arena = {0};
    struct image image;
    struct err err = {0};
    if (size > 0)
        memcpy(copy, data, size);
    if (mask)
        copy[changed] ^= mask;
    bool ok = picture_decode(copy, size, &arena, &image, &err);
    CHECK(ok == (err.code == ERR_NONE) && ok == (image.pixels != NULL), "%s", err.msg);
    arena_finish(&arena);
    free(copy);
    return err.code;
}

// Checks that the whole file can be read, and that every truncation of it is refused.
static inline void picture_check_cuts(const uint8_t *data, size_t size)
{
    CHECK(picture_try(data, size, 0, 0) == ERR_NONE);
    for (size_t cut = 0; cut < size; cut++)
        CHECK(picture_try(data, cut, 0, 0) == ERR_INPUT, "cut to %zu of %zu bytes", cut, size);
}

// Changes bytes: the file must be read or refused.
static inline void picture_check_flips(const uint8_t *data, size_t size)
{
    static const uint8_t masks[] = {0x01, 0x10, 0x80, 0xff};
    for (size_t i = 0; i < size; i++)
        for (size_t k = 0; k < sizeof masks; k++) {
            enum err_code code = picture_try(data, size, i, masks[k]);
            CHECK(code == ERR_NONE || code == ERR_INPUT || code == ERR_BUDGET,
                  "byte %zu ^ %02x: code %d", i, masks[k], code);
        }
}

#endif
