// Tests EXR blocks at the limit between compressed and uncompressed: every reader takes a block
// with the size of its pixels for uncompressed ("OpenEXR File Layout").
#include "image/image_internal.h"
#include "picture.h"
#include <openexr.h>
#include <zlib.h>

enum {
    LINES = 16, // lines per block
    MOST_BYTES = 4096,
    MOST_CHANNELS = 9,
    MOST_PIXELS = 64,
    TRIES = 20000,
};

// An image of one block: as passed to the writer, and as in the file.
struct block {
    uint32_t width;
    float color[MOST_PIXELS][3], full[MOST_PIXELS][3];
    uint32_t ids[MOST_PIXELS][3];
    uint8_t raw[MOST_BYTES];
    size_t raw_bytes;
};

// The channels of a kind of image, sorted by name.
struct kind {
    const char *name;
    uint32_t width;
    bool half, has_color, has_full, has_ids;
};

static const struct kind kinds[] = {
    {"half", 1, .half = true, .has_color = true},
    {"float", 1, .has_color = true},
    {"float, wide", 4, .has_color = true},
    {"uint", 1, .has_ids = true},
    {"float, float layer, uint layer", 1, .has_color = true, .has_full = true, .has_ids = true},
    {"half, float layer, uint layer", 1, true, .has_color = true, .has_full = true,
     .has_ids = true},
};

static const char *const id_names[] = {"a", "b", "c", NULL};

static uint32_t random_word(uint32_t seed, uint32_t i)
{
    uint32_t h = (seed * 0x9e3779b1u) ^ (i * 0x85ebca77u);
    h = (h ^ h >> 15) * 0xc2b2ae3du;
    h = (h ^ h >> 13) * 0x27d4eb2fu;
    return h ^ h >> 16;
}

static void put(struct block *block, const void *value, size_t bytes)
{
    memcpy(block->raw + block->raw_bytes, value, bytes);
    block->raw_bytes += bytes;
}

// Lays out the block line by line, and each line channel by channel: "B", "G", "R", "full.B" …,
// "ids.a" …
static void lay_out(struct block *block, const struct kind *kind)
{
    block->raw_bytes = 0;
    for (uint32_t line = 0; line < LINES; line++) {
        uint32_t first = line * kind->width, end = first + kind->width;
        for (int c = 2; kind->has_color && c >= 0; c--)
            for (uint32_t i = first; i < end; i++) {
                uint16_t half = half_from_float(block->color[i][c]);
                put(block, kind->half ? (const void *)&half : (const void *)&block->color[i][c],
                    kind->half ? sizeof half : sizeof(float));
            }
        for (int c = 2; kind->has_full && c >= 0; c--)
            for (uint32_t i = first; i < end; i++)
                put(block, &block->full[i][c], sizeof(float));
        for (int c = 0; kind->has_ids && c < 3; c++)
            for (uint32_t i = first; i < end; i++)
                put(block, &block->ids[i][c], sizeof(uint32_t));
    }
}

// Fills the arrays with random bits, which cannot be compressed, except for the first `zeros` bytes
// of each, which can. So their number brings the block near its own size. Halves are finite, so
// that they are converted from floats without change.
static void fill(struct block *block, const struct kind *kind, uint32_t seed, size_t zeros)
{
    for (uint32_t i = 0; i < LINES * kind->width; i++)
        for (uint32_t c = 0; c < 3; c++) {
            uint32_t bits = random_word(seed, 9 * i + c);
            block->color[i][c] = float_from_half((uint16_t)(bits & 0xbbff));
            if (!kind->half)
                memcpy(&block->color[i][c], &bits, sizeof bits);
            bits = random_word(seed, 9 * i + 3 + c);
            memcpy(&block->full[i][c], &bits, sizeof bits);
            block->ids[i][c] = random_word(seed, 9 * i + 6 + c);
        }
    memset(block->color, 0, zeros);
    memset(block->full, 0, zeros);
    memset(block->ids, 0, zeros);
    lay_out(block, kind);
}

// Returns the size of a block after ZIP compression: the bytes at even places come first, then
// those at odd ones; then their differences in zlib's format ("Technical Introduction to OpenEXR",
// data compression).
static size_t compressed_bytes(const struct block *block)
{
    uint8_t bytes[MOST_BYTES], out[2 * MOST_BYTES];
    size_t count = block->raw_bytes, half = (count + 1) / 2;
    for (size_t i = 0; i < count; i++)
        bytes[i % 2 * half + i / 2] = block->raw[i];
    for (size_t i = count - 1; i > 0; i--)
        bytes[i] = (uint8_t)(bytes[i] - bytes[i - 1] + 128);
    int level;
    exr_get_default_zip_compression_level(&level);
    uLongf size = sizeof out;
    return compress2(out, &size, bytes, count, level) == Z_OK ? size : 0;
}

// Finds a block that ZIP compression makes `difference` bytes longer.
static bool find_block(const struct kind *kind, int difference, struct block *out)
{
    *out = (struct block){.width = kind->width};
    for (uint32_t seed = 1; seed <= TRIES; seed++) {
        size_t zeros = random_word(seed, 0) % (kind->width * LINES * 12 + 1);
        fill(out, kind, seed, zeros);
        if ((int)compressed_bytes(out) - (int)out->raw_bytes == difference)
            return true;
    }
    return false;
}

static bool same_layer(const struct byte_buffer *file, const char *layer, const void *expected,
                       const struct kind *kind)
{
    struct arena arena = {0};
    struct image back;
    struct err err = {0};
    struct image_read_params params = {.path = "m", .layer = layer};
    bool ok = image_decode(file->data, file->size, &params, &arena, &back, &err);
    CHECK(ok, "%s", err.msg);
    ok = ok && memcmp(back.pixels, expected, LINES * kind->width * sizeof *back.pixels) == 0;
    arena_finish(&arena);
    return ok;
}

static void check_block(const struct kind *kind, int difference, struct block *block)
{
    const struct image image = {kind->width, LINES, kind->has_color ? block->color : NULL};
    struct image_layer layers[2];
    uint32_t count = 0;
    if (kind->has_full)
        layers[count++] =
            (struct image_layer){.name = "full", .values = block->full, .type = IMAGE_LAYER_FULL};
    if (kind->has_ids)
        layers[count++] = (struct image_layer){
            .name = "ids", .values = block->ids, .channels = id_names, .type = IMAGE_LAYER_UINT};
    const struct image_write_params params = {.path = "m.exr",
                                              .image = &image,
                                              .layers = layers,
                                              .layer_count = count,
                                              .half_float = kind->half};
    struct byte_buffer file = {0};
    struct err err = {0};
    REQUIRE(image_exr_write(&params, &file, &err), "%s, %+d: %s", kind->name, difference, err.msg);
    size_t stored = block->raw_bytes - (difference < 0);
    uint32_t in_file;
    REQUIRE(file.size > stored + sizeof in_file);
    memcpy(&in_file, file.data + file.size - stored - sizeof in_file, sizeof in_file);
    CHECK(in_file == stored, "%s, %+d: %u bytes; expected %zu", kind->name, difference, in_file,
          stored);
    if (difference >= 0)
        CHECK(memcmp(file.data + file.size - stored, block->raw, stored) == 0,
              "%s, %+d: the block is not stored as it is", kind->name, difference);
    if (kind->has_color)
        CHECK(same_layer(&file, NULL, block->color, kind), "%s, %+d", kind->name, difference);
    if (kind->has_full)
        CHECK(same_layer(&file, "full", block->full, kind), "%s, %+d", kind->name, difference);
    byte_buffer_finish(&file);
}

TEST(blocks_of_their_own_size)
{
    static struct block block;
    for (size_t k = 0; k < sizeof kinds / sizeof kinds[0]; k++)
        for (int difference = -1; difference <= 1; difference++) {
            bool found = find_block(&kinds[k], difference, &block);
            CHECK(found, "%s: no block of %+d bytes", kinds[k].name, difference);
            if (found)
                check_block(&kinds[k], difference, &block);
        }
}

TEST_MAIN(TEST_CASE(blocks_of_their_own_size))
