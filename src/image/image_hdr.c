// Reads Radiance .hdr images (Ward 1991, "Real Pixels", Graphics Gems II; Radiance's file format
// reference): RGBE, flat or run-length encoded in the old or the new format.
#include "image/image_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct hdr_reader {
    const uint8_t *data;
    size_t size, at;
    double exposure; // product of the EXPOSURE lines, by which the pixels are divided
    bool rgbe;
    uint64_t width, height;
    bool flip_x, flip_y;
};

// Copies the next line without its newline. Returns false at the end of the file.
static bool next_line(struct hdr_reader *reader, char *line, size_t size)
{
    const uint8_t *start = reader->data + reader->at;
    const uint8_t *end = memchr(start, '\n', reader->size - reader->at);
    if (!end)
        return false;
    size_t length = (size_t)(end - start);
    reader->at += length + 1;
    size_t kept = length < size - 1 ? length : size - 1;
    memcpy(line, start, kept);
    line[kept] = '\0';
    return true;
}

static bool read_header(struct hdr_reader *reader, struct err *err)
{
    char line[256];
    reader->exposure = 1;
    while (next_line(reader, line, sizeof line) && line[0]) {
        if (strncmp(line, "EXPOSURE=", 9) == 0) // several lines multiply
            reader->exposure *= strtod(line + 9, NULL);
        if (strncmp(line, "FORMAT=", 7) == 0) {
            reader->rgbe = strcmp(line + 7, "32-bit_rle_rgbe") == 0;
            if (!reader->rgbe)
                return err_set(err, ERR_INPUT, "HDR: format is \"%s\"; expected 32-bit_rle_rgbe",
                               line + 7);
        }
    }
    if (!reader->rgbe)
        return err_set(err, ERR_INPUT, "HDR: the header has no FORMAT line");
    if (!(reader->exposure > 0) || isinf(reader->exposure))
        return err_set(err, ERR_INPUT, "HDR: exposure is %g; expected a positive number",
                       reader->exposure);
    return true;
}

// Reads "-Y height +X width" or one of its mirror images. Formats that store columns first are not
// supported.
static bool read_resolution(struct hdr_reader *reader, struct err *err)
{
    char line[64], height[10], width[10]; // up to nine digits each
    char sign_y, sign_x;
    int end = 0;
    bool ok =
        next_line(reader, line, sizeof line) &&
        sscanf(line, "%cY %9[0-9] %cX %9[0-9]%n", &sign_y, height, &sign_x, width, &end) == 4 &&
        line[end] == '\0' && strchr("+-", sign_y) && strchr("+-", sign_x);
    if (!ok)
        return err_set(err, ERR_INPUT, "HDR: expected a line \"-Y height +X width\"");
    reader->height = strtoull(height, NULL, 10);
    reader->width = strtoull(width, NULL, 10);
    reader->flip_y = sign_y == '+';
    reader->flip_x = sign_x == '-';
    return true;
}

static bool truncated(struct err *err)
{
    return err_set(err, ERR_INPUT, "HDR: the pixels end early");
}

// Reads a line in the new encoding: the four components one after the other, each as runs (count >
// 128: one byte, count - 128 times) and literals.
static bool read_components(struct hdr_reader *reader, uint8_t (*row)[4], struct err *err)
{
    for (int component = 0; component < 4; component++)
        for (uint64_t x = 0; x < reader->width;) {
            if (reader->at + 2 > reader->size)
                return truncated(err);
            unsigned count = reader->data[reader->at++];
            bool run = count > 128;
            count -= run ? 128 : 0;
            if (count == 0 || count > reader->width - x)
                return err_set(
                    err, ERR_INPUT,
                    "HDR: a run or literal of %u pixels; expected 1 to %llu, the rest of the line",
                    count, (unsigned long long)(reader->width - x));
            size_t stored = run ? 1 : count;
            if (stored > reader->size - reader->at)
                return truncated(err);
            for (unsigned i = 0; i < count; i++)
                row[x++][component] = reader->data[reader->at + (run ? 0 : i)];
            reader->at += stored;
        }
    return true;
}

// Reads flat pixels with runs of the old encoding: (1, 1, 1, n) repeats the previous pixel n times;
// in consecutive runs the n are the bytes of a longer count, low byte first.
static bool read_pixels_flat(struct hdr_reader *reader, uint8_t (*row)[4], struct err *err)
{
    unsigned shift = 0;
    for (uint64_t x = 0; x < reader->width;) {
        if (reader->size - reader->at < 4)
            return truncated(err);
        const uint8_t *pixel = reader->data + reader->at;
        reader->at += 4;
        if (pixel[0] != 1 || pixel[1] != 1 || pixel[2] != 1) {
            memcpy(row[x++], pixel, 4);
            shift = 0;
            continue;
        }
        uint64_t count = shift < 32 ? (uint64_t)pixel[3] << shift : UINT64_MAX;
        if (x == 0 || count > reader->width - x)
            return err_set(err, ERR_INPUT,
                           "HDR: a run of %llu pixels at column %llu exceeds the line of %llu",
                           (unsigned long long)count, (unsigned long long)x,
                           (unsigned long long)reader->width);
        for (; count > 0; count--, x++)
            memcpy(row[x], row[x - 1], 4);
        shift += 8;
    }
    return true;
}

static bool read_row(struct hdr_reader *reader, uint8_t (*row)[4], struct err *err)
{
    const uint8_t *start = reader->data + reader->at;
    if (reader->size - reader->at < 4)
        return truncated(err);
    // The marker of the new encoding, (2, 2, width), can only hold these widths.
    bool encoded = reader->width >= 8 && reader->width <= 32767 && start[0] == 2 && start[1] == 2 &&
                   (unsigned)(start[2] << 8 | start[3]) == reader->width;
    if (!encoded)
        return read_pixels_flat(reader, row, err);
    reader->at += 4;
    return read_components(reader, row, err);
}

// Converts a line to floats. A value is m 2^(e - 136), with a mantissa in units of 1/256 and an
// exponent biased by 128. Ward's own reader adds half a step to each mantissa, which makes 0
// positive; like most other readers this one does not.
static void decode_row(const struct hdr_reader *reader, uint8_t (*row)[4], uint64_t y,
                       const struct pixels *out)
{
    for (uint64_t x = 0; x < reader->width; x++) {
        const uint8_t *rgbe = row[x];
        uint64_t column = reader->flip_x ? reader->width - 1 - x : x;
        float *pixel = pixels_at(out, y * reader->width + column);
        double scale = rgbe[3] ? ldexp(1 / reader->exposure, rgbe[3] - 136) : 0;
        for (int c = 0; c < 3; c++)
            pixel[c] = (float)(rgbe[c] * scale);
        if (out->components == 4)
            pixel[3] = 1.0f;
    }
}

bool image_hdr_read(const struct image_source *source, struct arena *arena, struct pixels *out,
                    struct err *err)
{
    struct hdr_reader reader = {.data = source->data, .size = source->size};
    if (!read_header(&reader, err) || !read_resolution(&reader, err))
        return false;
    // Runs of the old encoding can repeat a pixel without limit, those of the new one 127 times per
    // byte. So the file's length gives no lower bound to check, and only the budget limits the
    // size.
    uint64_t row_bytes = reader.width * 4;
    const struct pixels_size size = {reader.width, reader.height, 32, row_bytes};
    if (!pixels_allocate(source, &size, arena, out, err))
        return false;
    uint8_t(*row)[4] = calloc((size_t)reader.width, sizeof *row);
    if (!row)
        return err_memory(err, "a line", row_bytes);
    bool ok = true;
    for (uint64_t y = 0; ok && y < reader.height; y++) {
        ok = pixels_go_on(source, y, reader.width, err) &&
             (read_row(&reader, row, err) || err_prepend(err, "line %llu", (unsigned long long)y));
        uint64_t to = reader.flip_y ? reader.height - 1 - y : y;
        if (ok)
            decode_row(&reader, row, to, out);
    }
    free(row);
    return ok;
}
