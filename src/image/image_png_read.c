// Reads PNG of any colour type and depth.
#include "image/image_png.h"

#include "base/memory.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

// Everything that must survive a longjmp is in this struct, outside the function that calls setjmp.
struct png_reader {
    const struct image_source *source;
    size_t at;
    struct png_failure failure;
    png_structp png;
    png_infop info;
    struct arena *arena;
    struct pixels *out;
    struct err *err;
    bool reported;             // err has been filled in
    unsigned components, bits; // of the lines: 3 or 4 components of 8 or 16 bits
    size_t row_bytes;
    png_bytep bytes;
    png_bytepp rows;
};

static void read_bytes(png_structp png, png_bytep data, size_t size)
{
    struct png_reader *reader = png_get_io_ptr(png);
    if (size > reader->source->size - reader->at)
        png_error(png, "the file ends early");
    memcpy(data, reader->source->data + reader->at, size);
    reader->at += size;
}

// Checks that every chunk (length, type, data, checksum) lies inside the file, because libpng
// allocates memory for some chunks by their length alone.
static void check_chunks(struct png_reader *reader)
{
    const uint8_t *data = reader->source->data;
    const size_t signature_bytes = 8, frame_bytes = 12;
    for (size_t at = signature_bytes;;) {
        size_t left = reader->source->size > at ? reader->source->size - at : 0;
        if (left < frame_bytes || png_get_uint_32(data + at) > left - frame_bytes)
            png_error(reader->png, "the file ends early");
        if (memcmp(data + at + 4, "IEND", 4) == 0)
            return;
        at += png_get_uint_32(data + at) + frame_bytes;
    }
}

// Limits the memory that libpng allocates itself: for chunks, the decompressor and a line.
static void set_limits(struct png_reader *reader)
{
    // Chunks with text and colour profiles may be compressed; the limit keeps them from growing
    // without end.
    const png_alloc_size_t chunk_bytes_max = 64u << 20;
    png_set_user_limits(reader->png, PNG_UINT_31_MAX, PNG_UINT_31_MAX);
    png_set_chunk_malloc_max(reader->png, chunk_bytes_max);
}

// Checks the size and allocates the pixels. Must be called before the transformations are set up,
// because libpng then allocates lines itself.
static bool allocate(struct png_reader *reader)
{
    uint64_t width = png_get_image_width(reader->png, reader->info);
    uint64_t height = png_get_image_height(reader->png, reader->info);
    reader->components = reader->source->with_alpha ? 4 : 3;
    reader->bits = png_get_bit_depth(reader->png, reader->info) == 16 ? 16 : 8;
    uint64_t row_bytes = reader->components * width * (reader->bits / 8);
    // Interlaced images come in seven passes over all lines, so all lines are stored. libpng stores
    // two lines, with at most four components of 16 bits.
    const uint64_t library_bytes = 2 * 4 * 2 * width;
    uint64_t extra;
    if (__builtin_mul_overflow(row_bytes + sizeof *reader->rows, height, &extra) ||
        __builtin_add_overflow(extra, library_bytes, &extra))
        extra = UINT64_MAX;
    const struct pixels_size size = {width, height, reader->bits, extra};
    if (!pixels_allocate(reader->source, &size, reader->arena, reader->out, reader->err))
        return false;
    reader->bytes = memory_alloc((size_t)(row_bytes * height));
    reader->rows = memory_alloc((size_t)height * sizeof *reader->rows);
    if (!reader->bytes || !reader->rows)
        return err_memory(reader->err, "lines", extra);
    reader->row_bytes = (size_t)row_bytes;
    for (uint64_t y = 0; y < height; y++)
        reader->rows[y] = reader->bytes + y * row_bytes;
    return true;
}

// Makes libpng convert any input to three or four components of 8 or 16 bits.
static void set_transformations(struct png_reader *reader)
{
    bool has_alpha = (png_get_color_type(reader->png, reader->info) & PNG_COLOR_MASK_ALPHA) ||
                     png_get_valid(reader->png, reader->info, PNG_INFO_tRNS);
    png_set_expand(reader->png); // expands palettes, depths below 8 bits, transparent colours
    png_set_gray_to_rgb(reader->png);
    if (!reader->source->with_alpha)
        png_set_strip_alpha(reader->png);
    else if (!has_alpha)
        png_set_add_alpha(reader->png, 0xffff, PNG_FILLER_AFTER);
    png_set_interlace_handling(reader->png);
    png_read_update_info(reader->png, reader->info);
}

static bool open_source(struct png_reader *reader)
{
    if (setjmp(png_jmpbuf(reader->png)))
        return false;
    check_chunks(reader);
    set_limits(reader);
    png_set_read_fn(reader->png, reader, read_bytes);
    png_read_info(reader->png, reader->info);
    return true;
}

static void row_is_read(png_structp png, png_uint_32 row, int pass)
{
    struct png_reader *reader = png_get_io_ptr(png);
    (void)pass;
    reader->reported = !pixels_go_on(reader->source, row, reader->out->width, reader->err);
    if (reader->reported)
        png_error(png, "stopped");
}

static bool read_image(struct png_reader *reader)
{
    if (setjmp(png_jmpbuf(reader->png)))
        return false;
    if (!allocate(reader)) {
        reader->reported = true;
        return false;
    }
    png_set_read_status_fn(reader->png, row_is_read);
    set_transformations(reader);
    if (png_get_rowbytes(reader->png, reader->info) != reader->row_bytes)
        png_error(reader->png, "lines of unexpected length");
    png_read_image(reader->png, reader->rows);
    png_read_end(reader->png, NULL);
    return true;
}

static void convert_wide_row(const struct png_reader *reader, uint32_t y)
{
    const struct pixels *out = reader->out;
    const uint8_t *from = reader->rows[y];
    float *to = pixels_at(out, (uint64_t)y * out->width);
    for (size_t i = 0; i < (size_t)out->width * reader->components; i++) {
        float value = (float)(from[2 * i] << 8 | from[2 * i + 1]) / 65535.0f;
        bool is_encoded = i % reader->components < 3 && !reader->source->is_linear;
        to[i] = is_encoded ? image_srgb_to_linear(value) : value;
    }
}

static bool convert(struct png_reader *reader)
{
    struct code_table table;
    code_table_fill(reader->source->is_linear, &table);
    for (uint32_t y = 0; y < reader->out->height; y++) {
        if (!pixels_go_on(reader->source, y, reader->out->width, reader->err)) {
            reader->reported = true;
            return false;
        }
        if (reader->bits == 16)
            convert_wide_row(reader, y);
        else
            pixels_put_codes(reader->out, y, reader->rows[y], reader->components, &table);
    }
    return true;
}

static bool reader_open(struct png_reader *reader, struct err *err)
{
    reader->png =
        png_create_read_struct_2(PNG_LIBPNG_VER_STRING, &reader->failure, png_keep_error,
                                 png_drop_warning, NULL, png_take_memory, png_give_memory);
    reader->info = reader->png ? png_create_info_struct(reader->png) : NULL;
    return reader->info ? true : err_memory(err, "the PNG reader", 0);
}

static bool reader_close(struct png_reader *reader, bool ok, bool ran, struct err *err)
{
    if (!ok && ran && !reader->reported)
        err_set(err, ERR_INPUT, "PNG: %s", reader->failure.message);
    png_destroy_read_struct(&reader->png, &reader->info, NULL);
    memory_free(reader->bytes);
    memory_free(reader->rows);
    return ok;
}

bool image_png_read(const struct image_source *source, struct arena *arena, struct pixels *out,
                    struct err *err)
{
    struct png_reader reader = {.source = source, .arena = arena, .out = out, .err = err};
    bool ran = reader_open(&reader, err);
    bool ok = ran && open_source(&reader) && read_image(&reader) && convert(&reader);
    return reader_close(&reader, ok, ran, err);
}

static bool copy_texts(struct png_reader *reader, struct image_attribute **out, uint32_t *count)
{
    png_textp texts;
    int total = 0;
    png_get_text(reader->png, reader->info, &texts, &total);
    *out = ARENA_NEW(reader->arena, struct image_attribute, (size_t)total);
    if (!*out)
        return err_memory(reader->err, "attributes", (size_t)total * sizeof **out);
    for (int i = 0; i < total; i++) {
        char *key = arena_strdup(reader->arena, texts[i].key);
        char *value = arena_strdup(reader->arena, texts[i].text ? texts[i].text : "");
        if (!key || !value)
            return err_memory(reader->err, "an attribute", texts[i].text_length);
        (*out)[(*count)++] = (struct image_attribute){key, value};
    }
    return true;
}

bool image_png_read_attributes(const struct image_source *source, struct arena *arena,
                               struct image_attribute **out, uint32_t *count, struct err *err)
{
    struct png_reader reader = {.source = source, .arena = arena, .err = err};
    bool ran = reader_open(&reader, err);
    bool ok = ran && open_source(&reader);
    if (ok) {
        ok = copy_texts(&reader, out, count);
        reader.reported = !ok;
    }
    return reader_close(&reader, ok, ran, err);
}
