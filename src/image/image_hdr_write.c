// Writes Radiance .hdr images (Ward 1991, "Real Pixels", Graphics Gems II): RGBE, run-length
// encoded by component. image_hdr.c reads this format.
#include "image/image_internal.h"

#include "base/log.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Rows of these widths are encoded as four components, one after another; other rows are flat.
#define ENCODED_WIDTH_MIN 8u
#define ENCODED_WIDTH_MAX 32767u
#define RUN_MIN 4u // shorter runs take no fewer bytes than literals
#define RUN_MAX 127u
#define LITERALS_MAX 128u
#define EXPONENT_BIAS 128

struct hdr_writer {
    struct byte_buffer *out;
    uint64_t changed; // number of pixels that RGBE cannot hold: negative, not finite or too large
    bool is_full;     // memory ran out
};

static void put(struct hdr_writer *writer, const void *data, size_t size)
{
    writer->is_full |= !byte_buffer_write(writer->out, writer->out->size, data, size);
}

// Converts a pixel to RGBE. The three mantissas share the exponent of the largest one: a value is m
// 2^(e - 136). Mantissas are rounded to nearest, as the reader expects. Negative values and NaN
// become 0. Values above `greatest`, the largest that the format holds, become `greatest`.
static void encode_pixel(const float rgb[3], uint8_t rgbe[4], uint64_t *changed)
{
    const float greatest = 255.0f * 0x1p119f; // 255 2^(255 - 136)
    float value[3], most = 0.0f;
    bool is_changed = false;
    for (int c = 0; c < 3; c++) {
        value[c] = rgb[c] > 0.0f ? fminf(rgb[c], greatest) : 0.0f;
        is_changed |= !(rgb[c] >= 0.0f && rgb[c] <= greatest);
        most = fmaxf(most, value[c]);
    }
    *changed += is_changed;
    int exponent = 0; // exponent of `most`, which is in [0.5, 1) 2^exponent
    frexpf(most, &exponent);
    exponent += rintf(ldexpf(most, 8 - exponent)) > 255.0f;
    memset(rgbe, 0, 4);
    if (most == 0.0f || exponent <= -EXPONENT_BIAS) // exponent 0 means black
        return;
    for (int c = 0; c < 3; c++)
        rgbe[c] = (uint8_t)rintf(ldexpf(value[c], 8 - exponent));
    rgbe[3] = (uint8_t)(exponent + EXPONENT_BIAS);
}

static size_t run_length(const uint8_t (*row)[4], size_t from, size_t width, int component)
{
    size_t length = 1;
    while (from + length < width && length < RUN_MAX &&
           row[from + length][component] == row[from][component])
        length++;
    return length;
}

static void put_literals(struct hdr_writer *writer, const uint8_t (*row)[4], size_t from,
                         size_t count, int component)
{
    uint8_t bytes[1 + LITERALS_MAX];
    bytes[0] = (uint8_t)count;
    for (size_t i = 0; i < count; i++)
        bytes[1 + i] = row[from + i][component];
    if (count > 0)
        put(writer, bytes, 1 + count);
}

static void put_component(struct hdr_writer *writer, const uint8_t (*row)[4], size_t width,
                          int component)
{
    size_t begun = 0; // the first pixel of the literals that are not yet written
    for (size_t x = 0; x < width;) {
        size_t run = run_length(row, x, width, component);
        bool is_run = run >= RUN_MIN;
        if (is_run || x - begun == LITERALS_MAX) {
            put_literals(writer, row, begun, x - begun, component);
            begun = x;
        }
        if (!is_run) {
            x++;
            continue;
        }
        const uint8_t bytes[2] = {(uint8_t)(128 + run), row[x][component]};
        put(writer, bytes, 2);
        x += run;
        begun = x;
    }
    put_literals(writer, row, begun, width - begun, component);
}

static void put_row(struct hdr_writer *writer, const uint8_t (*row)[4], size_t width)
{
    if (width < ENCODED_WIDTH_MIN || width > ENCODED_WIDTH_MAX) {
        // Each pixel has a mantissa of at least 128, or all its mantissas are 0. So no pixel can be
        // mistaken for a run or for the marker of an encoded row.
        put(writer, row, width * sizeof *row);
        return;
    }
    const uint8_t marker[4] = {2, 2, (uint8_t)(width >> 8), (uint8_t)width};
    put(writer, marker, sizeof marker);
    for (int component = 0; component < 4; component++)
        put_component(writer, row, width, component);
}

// Writes the header. Metadata are comments, which begin with #.
static void put_header(struct hdr_writer *writer, const struct image_write_params *params)
{
    static const char begin[] = "#?RADIANCE\n";
    put(writer, begin, sizeof begin - 1);
    for (uint32_t i = 0; i < params->attribute_count; i++) {
        put(writer, "# ", 2);
        put(writer, params->attributes[i].key, strlen(params->attributes[i].key));
        put(writer, "=", 1);
        for (const char *c = params->attributes[i].value; *c; c++)
            put(writer, *c == '\n' ? " " : c, 1);
        put(writer, "\n", 1);
    }
    char end[80];
    int length = snprintf(end, sizeof end, "FORMAT=32-bit_rle_rgbe\n\n-Y %u +X %u\n",
                          params->image->height, params->image->width);
    put(writer, end, (size_t)length);
}

bool image_hdr_codes(const struct image_write_params *params, uint8_t (**codes)[4], struct err *err)
{
    size_t count = (size_t)params->image->width * params->image->height;
    uint64_t changed = 0;
    *codes = calloc(count, sizeof **codes);
    if (!*codes)
        return err_memory(err, "RGBE pixels", count * sizeof **codes);
    for (size_t i = 0; i < count; i++)
        encode_pixel(params->image->pixels[i], (*codes)[i], &changed);
    if (changed > 0)
        log_warn("%s: %llu of %zu pixels have negative values, values above 1.7e38 or values that "
                 "are not finite, which the format cannot store: they become 0 or the largest "
                 "value; .exr and .pfm keep them",
                 params->path, (unsigned long long)changed, count);
    return true;
}

bool image_hdr_write(const struct image_write_params *params, const uint8_t (*codes)[4],
                     struct byte_buffer *out, struct err *err)
{
    struct hdr_writer writer = {.out = out};
    const size_t width = params->image->width;
    put_header(&writer, params);
    for (uint32_t y = 0; y < params->image->height && !writer.is_full; y++)
        put_row(&writer, codes + y * width, width);
    return !writer.is_full || err_memory(err, "the HDR", out->size);
}

// Decoding does not detect errors in comments, or in the mantissas of black pixels, because the
// reader ignores both. A second encoding detects them.
static bool verify_bytes(const struct image_write_params *params, const uint8_t (*codes)[4],
                         const struct byte_buffer *file, struct err *err)
{
    struct byte_buffer again = {0};
    bool ok = image_hdr_write(params, codes, &again, err);
    ok = ok &&
         ((again.size == file->size && memcmp(again.data, file->data, again.size) == 0) ||
          err_set(err, ERR_OUTPUT, "HDR: encoding the picture twice gave two different files"));
    byte_buffer_finish(&again);
    return ok;
}

bool image_hdr_verify(const struct image_write_params *params, const uint8_t (*codes)[4],
                      const struct byte_buffer *file, struct err *err)
{
    const struct image *image = params->image;
    const struct image_source source = {
        .path = params->path, .data = file->data, .size = file->size};
    struct arena arena = {0};
    struct pixels read = {0};
    struct err failure = {0};
    if (!verify_bytes(params, codes, file, err))
        return false;
    bool ok = image_hdr_read(&source, &arena, &read, &failure);
    if (!ok)
        err_set(err, failure.code == ERR_INPUT ? ERR_OUTPUT : failure.code, "%s", failure.msg);
    ok = ok && ((read.width == image->width && read.height == image->height) ||
                err_set(err, ERR_OUTPUT, "HDR: the decoded size differs from the one encoded"));
    for (size_t i = 0; ok && i < (size_t)image->width * image->height; i++)
        for (int c = 0; ok && c < 3; c++) {
            float expected = (float)ldexp(codes[i][c], codes[i][3] - EXPONENT_BIAS - 8);
            float value = pixels_at(&read, i)[c];
            ok = value == (codes[i][3] ? expected : 0.0f) ||
                 err_set(err, ERR_OUTPUT, "HDR: pixel %zu,%zu reads as %g; expected %g",
                         i % image->width, i / image->width, (double)value, (double)expected);
        }
    arena_finish(&arena);
    return ok;
}
