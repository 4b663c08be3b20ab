// Reads Truevision TGA with stb_image: grey, colour or palette, with or without run lengths.
#include "image/image_internal.h"

#include <stb_image.h>
#include <string.h>

// The fields of the header that this file reads (Truevision TGA File Format Specification 2.0,
// "TGA File Header").
enum {
    PALETTE_TYPE = 1,
    IMAGE_TYPE = 2,
    PALETTE_START = 3,
    WIDTH = 12,
    HEIGHT = 14,
    DEPTH = 16,
    DESCRIPTOR = 17,
    HEADER_BYTES = 18,
};
#define RIGHT_TO_LEFT 0x10 // a bit of the descriptor

// The file, as the library reads it.
struct tga_file {
    const uint8_t *data;
    size_t size, at;
    char *buffer;    // the library's buffer for small reads, which its first request fills
    bool ends_early; // the library wanted more bytes than the file has
};

// Copies the next bytes. The library takes missing bytes for zeros, so this function notices them.
// Only requests for the library's buffer may ask for more bytes than are needed.
static int read_bytes(void *context, char *out, int size)
{
    struct tga_file *file = context;
    if (!file->buffer)
        file->buffer = out;
    const size_t left = file->size - file->at;
    const size_t count = (size_t)size < left ? (size_t)size : left;
    if (count == 0 || (count < (size_t)size && out != file->buffer))
        file->ends_early = true;
    memcpy(out, file->data + file->at, count);
    file->at += count;
    return (int)count;
}

static void skip_bytes(void *context, int count)
{
    struct tga_file *file = context;
    if (count < 0)
        file->at -= (size_t)-count < file->at ? (size_t)-count : file->at;
    else if ((size_t)count <= file->size - file->at)
        file->at += (size_t)count;
    else {
        file->at = file->size;
        file->ends_early = true;
    }
}

static int is_at_end(void *context)
{
    const struct tga_file *file = context;
    return file->at == file->size;
}

static uint64_t read_u16(const uint8_t *data)
{
    return (uint64_t)data[0] | (uint64_t)data[1] << 8;
}

bool image_is_tga(const uint8_t *data, size_t size)
{
    if (size < HEADER_BYTES || data[PALETTE_TYPE] > 1)
        return false;
    const unsigned type = data[IMAGE_TYPE], coding = type & ~8u, depth = data[DEPTH];
    const bool has_palette = coding == 1;
    return (type & ~11u) == 0 && coding >= 1 && coding <= 3 && data[PALETTE_TYPE] == has_palette &&
           (depth == 8 || depth == 15 || depth == 16 || depth == 24 || depth == 32);
}

static bool convert(const struct image_source *source, const uint8_t *codes,
                    const struct pixels *out, struct err *err)
{
    struct code_table table;
    code_table_fill(source->is_linear, &table);
    for (uint32_t y = 0; y < out->height; y++) {
        if (!pixels_go_on(source, y, out->width, err))
            return false;
        pixels_put_codes(out, y, codes + (size_t)y * out->width * out->components, out->components,
                         &table);
    }
    return true;
}

static bool decode(const struct image_source *source, const struct pixels *out, struct err *err)
{
    static const stbi_io_callbacks callbacks = {read_bytes, skip_bytes, is_at_end};
    struct tga_file file = {.data = source->data, .size = source->size};
    int width, height, components;
    uint8_t *codes = stbi_load_from_callbacks(&callbacks, &file, &width, &height, &components,
                                              (int)out->components);
    bool ok = true;
    if (!codes && strcmp(stbi_failure_reason(), "outofmem") == 0)
        ok = err_memory(err, "the TGA decoder", 0);
    else if (file.ends_early)
        ok = err_set(err, ERR_INPUT, "TGA: the file ends early");
    else if (!codes)
        ok = err_set(err, ERR_INPUT, "TGA: the data are damaged (%s)", stbi_failure_reason());
    ok = ok && convert(source, codes, out, err);
    stbi_image_free(codes);
    return ok;
}

bool image_tga_read(const struct image_source *source, struct arena *arena, struct pixels *out,
                    struct err *err)
{
    if (!image_is_tga(source->data, source->size))
        return err_set(err, ERR_INPUT, "TGA: the header is damaged");
    // The library ignores the order of pixels and the first index of the palette.
    if (source->data[DESCRIPTOR] & RIGHT_TO_LEFT)
        return err_set(err, ERR_INPUT,
                       "TGA: rows are stored from right to left; expected left to right");
    if (source->data[PALETTE_TYPE] && read_u16(source->data + PALETTE_START) > 0)
        return err_set(err, ERR_INPUT, "TGA: the palette begins with index %u; expected 0",
                       (unsigned)read_u16(source->data + PALETTE_START));
    const uint64_t width = read_u16(source->data + WIDTH);
    const uint64_t height = read_u16(source->data + HEIGHT);
    // The library decodes all pixels, and then converts them into a second picture.
    const struct pixels_size size = {width, height, 8, width * height * 8};
    return pixels_allocate(source, &size, arena, out, err) && decode(source, out, err);
}
