// Portable float maps, .pfm (Debevec's HDR Shop; Netpbm's "pfm" page): a header of three lines,
// then 32-bit floats in rows from the bottom. The format cannot store metadata.
#include "image/image_internal.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define HEADER_MAX 64 // bytes for the header that is written: "PF", two sizes, "-1.0"

struct pfm_reader {
    const uint8_t *data;
    size_t size, at;
    unsigned components; // 3 for "PF", 1 for "Pf"
    uint64_t width, height;
    double scale; // factor by which all values are multiplied
    bool is_big_endian;
};

// Copies the next word and skips the single white-space character after it. Returns false at the
// end of the file, or if the word does not fit into `size` bytes.
static bool next_word(struct pfm_reader *reader, char *word, size_t size)
{
    size_t length = 0;
    while (reader->at < reader->size && isspace(reader->data[reader->at]))
        reader->at++;
    while (reader->at < reader->size && !isspace(reader->data[reader->at]) && length < size - 1)
        word[length++] = (char)reader->data[reader->at++];
    word[length] = '\0';
    return length > 0 && reader->at < reader->size && isspace(reader->data[reader->at++]);
}

static bool read_side(struct pfm_reader *reader, uint64_t *side)
{
    char word[12]; // at most nine digits, because larger sizes exceed any memory
    char *end;
    if (!next_word(reader, word, sizeof word) || !isdigit((unsigned char)word[0]) ||
        strlen(word) > 9)
        return false;
    *side = strtoull(word, &end, 10);
    return *end == '\0';
}

static bool read_header(struct pfm_reader *reader, struct err *err)
{
    char word[32];
    char *end = word;
    if (!next_word(reader, word, sizeof word))
        return err_set(err, ERR_INPUT, "PFM: the file ends within its header");
    reader->components = word[1] == 'F' ? 3 : 1;
    if (!read_side(reader, &reader->width) || !read_side(reader, &reader->height))
        return err_set(err, ERR_INPUT, "PFM: expected width and height after \"%s\"", word);
    double scale = next_word(reader, word, sizeof word) ? strtod(word, &end) : 0.0;
    if (end == word || *end != '\0' || scale == 0.0 || !isfinite(scale))
        return err_set(err, ERR_INPUT,
                       "PFM: expected a number other than 0 after the size: negative if the "
                       "floats are little-endian, positive if they are big-endian");
    reader->scale = fabs(scale);
    reader->is_big_endian = scale > 0.0;
    return true;
}

static float read_float(const struct pfm_reader *reader, const uint8_t *bytes)
{
    uint32_t bits = 0;
    for (unsigned i = 0; i < 4; i++)
        bits |= (uint32_t)bytes[i] << 8 * (reader->is_big_endian ? 3 - i : i);
    float value;
    memcpy(&value, &bits, sizeof value);
    // With a scale of 1 all bits are kept, including those of NaN.
    return reader->scale == 1.0 ? value : (float)(value * reader->scale);
}

static void decode_row(const struct pfm_reader *reader, uint64_t y, const struct pixels *out)
{
    const unsigned components = reader->components;
    const uint8_t *row = reader->data + reader->at + 4 * components * reader->width * y;
    for (uint64_t x = 0; x < reader->width; x++) {
        float *pixel = pixels_at(out, (reader->height - 1 - y) * reader->width + x);
        for (unsigned c = 0; c < 3; c++)
            pixel[c] = read_float(reader, row + 4 * (components * x + (components == 3 ? c : 0)));
        if (out->components == 4)
            pixel[3] = 1.0f;
    }
}

bool image_pfm_read(const struct image_source *source, struct arena *arena, struct pixels *out,
                    struct err *err)
{
    struct pfm_reader reader = {.data = source->data, .size = source->size};
    if (!read_header(&reader, err))
        return false;
    const struct pixels_size size = {reader.width, reader.height, 32, 0};
    if (!pixels_allocate(source, &size, arena, out, err))
        return false;
    uint64_t expected = 4 * reader.components * reader.width * reader.height;
    if (reader.size - reader.at < expected)
        return err_set(err, ERR_INPUT, "PFM: has %zu bytes of pixels; expected %llu",
                       reader.size - reader.at, (unsigned long long)expected);
    for (uint64_t y = 0; y < reader.height; y++) {
        if (!pixels_go_on(source, y, reader.width, err))
            return false;
        decode_row(&reader, y, out);
    }
    return true;
}

static int print_header(const struct image *image, char header[HEADER_MAX])
{
    return snprintf(header, HEADER_MAX, "PF\n%u %u\n-1.0\n", image->width, image->height);
}

bool image_pfm_write(const struct image_write_params *params, struct byte_buffer *out,
                     struct err *err)
{
    const struct image *image = params->image;
    char header[HEADER_MAX];
    int length = print_header(image, header);
    size_t row_bytes = (size_t)image->width * sizeof *image->pixels;
    uint8_t *row = malloc(row_bytes);
    bool ok = row && byte_buffer_write(out, 0, header, (size_t)length);
    for (uint32_t y = image->height; ok && y-- > 0;) {
        const float *values = image->pixels[(size_t)y * image->width];
        for (size_t i = 0; i < 3 * (size_t)image->width; i++) {
            uint32_t bits;
            memcpy(&bits, &values[i], sizeof bits);
            for (unsigned b = 0; b < 4; b++)
                row[4 * i + b] = (uint8_t)(bits >> 8 * b);
        }
        ok = byte_buffer_write(out, out->size, row, row_bytes);
    }
    free(row);
    return ok || err_memory(err, "the PFM", row_bytes * image->height);
}

bool image_pfm_verify(const struct image_write_params *params, const struct byte_buffer *file,
                      struct err *err)
{
    const struct image *image = params->image;
    const struct image_source source = {
        .path = params->path, .data = file->data, .size = file->size};
    struct arena arena = {0};
    struct pixels read = {0};
    struct err failure = {0};
    char header[HEADER_MAX];
    size_t length = (size_t)print_header(image, header);
    if (file->size < length || memcmp(file->data, header, length) != 0)
        return err_set(err, ERR_OUTPUT, "PFM: the decoded header differs from the one encoded");
    bool ok = image_pfm_read(&source, &arena, &read, &failure);
    if (!ok)
        err_set(err, failure.code == ERR_INPUT ? ERR_OUTPUT : failure.code, "%s", failure.msg);
    else if (read.width != image->width || read.height != image->height ||
             memcmp(read.values, image->pixels,
                    (size_t)image->width * image->height * sizeof *image->pixels) != 0)
        ok = err_set(err, ERR_OUTPUT, "PFM: the decoded pixels differ from those encoded");
    arena_finish(&arena);
    return ok;
}
