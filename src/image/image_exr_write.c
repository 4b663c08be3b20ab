// Writes single-part scanline EXR files with channels of halves, floats or integers, uncompressed
// or ZIP-compressed in blocks of 16 lines.
#include "image/image_exr.h"

#include "base/log.h"
#include "image/image_exr_channel.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    SHORT_NAME_MAX_BYTES = 31, // longer names need a flag in the file's version field
    BLOCK_LINES = 16,          // lines per block with ZIP compression
    COMPONENTS = 3,
};

struct exr_writer {
    const struct image_write_params *params;
    struct exr_stream stream;
    exr_context_t context;
    exr_encode_pipeline_t encoder;
    bool encoder_ready;
    exr_result_t (*compress)(exr_encode_pipeline_t *); // the library's compressor
    uint16_t *halves; // one block, channel by channel; NULL when writing floats
    uint64_t saturated;
};

static bool check(const struct exr_writer *writer, exr_result_t result, struct err *err)
{
    return result == EXR_ERR_SUCCESS || exr_fail(&writer->stream, result, ERR_OUTPUT, err);
}

static bool add_channels(struct exr_writer *writer, struct err *err)
{
    struct exr_channel channel;
    for (uint32_t i = 0; exr_channel_at(writer->params, i, &channel); i++) {
        if (channel.is_name_too_long)
            return err_set(err, ERR_OUTPUT, "channel name \"%.40s…\" is longer than %d bytes",
                           channel.name, EXR_NAME_MAX_BYTES);
        // The library keeps its list sorted by name, as the format requires.
        if (!check(writer,
                   exr_add_channel(writer->context, 0, channel.name, channel.type,
                                   EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1),
                   err))
            return err_prepend(err, "channel %s", channel.name);
    }
    return true;
}

static bool add_attributes(struct exr_writer *writer, struct err *err)
{
    const struct image_write_params *params = writer->params;
    for (uint32_t i = 0; i < params->attribute_count; i++) {
        const struct image_attribute *attribute = &params->attributes[i];
        if (!check(writer,
                   exr_attr_set_string(writer->context, 0, attribute->key, attribute->value), err))
            return err_prepend(err, "attribute \"%s\"", attribute->key);
    }
    return true;
}

static bool needs_long_names(const struct image_write_params *params)
{
    struct exr_channel channel;
    for (uint32_t i = 0; exr_channel_at(params, i, &channel); i++)
        if (strlen(channel.name) > SHORT_NAME_MAX_BYTES)
            return true;
    for (uint32_t i = 0; i < params->attribute_count; i++)
        if (strlen(params->attributes[i].key) > SHORT_NAME_MAX_BYTES)
            return true;
    return false;
}

static bool write_header(struct exr_writer *writer, struct err *err)
{
    const struct exr_windows windows = exr_windows_of(writer->params);
    const exr_attr_v2f_t center = {{{0, 0}}};
    exr_context_initializer_t initializer = exr_stream_initializer(&writer->stream);
    int part;
    return check(writer,
                 exr_start_write(&writer->context, writer->params->path, EXR_WRITE_FILE_DIRECTLY,
                                 &initializer),
                 err) &&
           check(writer,
                 exr_set_longname_support(writer->context, needs_long_names(writer->params)),
                 err) &&
           check(writer, exr_add_part(writer->context, NULL, EXR_STORAGE_SCANLINE, &part), err) &&
           check(writer,
                 exr_initialize_required_attr(
                     writer->context, part, &windows.display, &windows.data, 1.0f, &center, 1.0f,
                     EXR_LINEORDER_INCREASING_Y, exr_compression_of(writer->params)),
                 err) &&
           add_channels(writer, err) && add_attributes(writer, err) &&
           check(writer, exr_write_header(writer->context), err);
}

static void convert_to_half(struct exr_writer *writer, const struct exr_channel *channel,
                            size_t first, size_t count, uint16_t *to)
{
    for (size_t i = 0; i < count; i++) {
        float value;
        memcpy(&value, channel->values + (first + i) * channel->stride, sizeof value);
        writer->saturated += isfinite(value) && fabsf(value) > HALF_MAX;
        to[i] = (uint16_t)exr_channel_bits(channel, first + i);
    }
}

// Points the encoder's channels at `lines` lines from line y on.
static bool feed_encoder(struct exr_writer *writer, uint32_t y, uint32_t lines, struct err *err)
{
    const uint32_t width = writer->params->image->width;
    for (int i = 0; i < writer->encoder.channel_count; i++) {
        exr_coding_channel_info_t *coding = &writer->encoder.channels[i];
        struct exr_channel channel;
        if (!exr_channel_find(writer->params, coding->channel_name, &channel))
            return err_set(err, ERR_BUG, "EXR: channel %s has no source", coding->channel_name);
        size_t value_bytes = sizeof(float), stride = channel.stride;
        const char *data = channel.values + (size_t)y * width * stride;
        if (channel.type == EXR_PIXEL_HALF) {
            uint16_t *block = writer->halves + (size_t)i * BLOCK_LINES * width;
            convert_to_half(writer, &channel, (size_t)y * width, (size_t)lines * width, block);
            value_bytes = stride = sizeof *block;
            data = (const char *)block;
        }
        coding->encode_from_ptr = (const uint8_t *)data;
        coding->user_pixel_stride = (int32_t)stride;
        coding->user_line_stride = (int32_t)(stride * width);
        coding->user_data_type = coding->data_type;
        coding->user_bytes_per_element = (int16_t)value_bytes;
    }
    return true;
}

// Compresses a block, and stores the pixels instead if the compressed block is not shorter. Readers
// take a block of the full length for uncompressed, but OpenEXRCore 3.1.5 stores the pixels only if
// compression made them longer (OpenEXR issue 2306).
static exr_result_t compress_or_copy(exr_encode_pipeline_t *encoder)
{
    const struct exr_writer *writer = encoder->encoding_user_data;
    exr_result_t result = writer->compress(encoder);
    if (result == EXR_ERR_SUCCESS && encoder->compressed_bytes >= encoder->packed_bytes) {
        memcpy(encoder->compressed_buffer, encoder->packed_buffer, encoder->packed_bytes);
        encoder->compressed_bytes = encoder->packed_bytes;
    }
    return result;
}

static exr_result_t choose_routines(struct exr_writer *writer)
{
    exr_encode_pipeline_t *encoder = &writer->encoder;
    exr_result_t result = exr_encoding_choose_default_routines(writer->context, 0, encoder);
    writer->compress = encoder->compress_fn;
    if (writer->compress) // NULL without compression
        encoder->compress_fn = compress_or_copy;
    encoder->encoding_user_data = writer;
    return result;
}

static bool write_block(struct exr_writer *writer, uint32_t y, struct err *err)
{
    exr_chunk_info_t chunk;
    const int line = (int)(y + writer->params->display.y);
    if (!check(writer, exr_write_scanline_chunk_info(writer->context, 0, line, &chunk), err))
        return false;
    exr_encode_pipeline_t *encoder = &writer->encoder;
    bool first = !writer->encoder_ready;
    exr_result_t result = first ? exr_encoding_initialize(writer->context, 0, &chunk, encoder)
                                : exr_encoding_update(writer->context, 0, &chunk, encoder);
    writer->encoder_ready |= result == EXR_ERR_SUCCESS;
    if (!check(writer, result, err) || !feed_encoder(writer, y, (uint32_t)chunk.height, err))
        return false;
    if (first)
        result = choose_routines(writer);
    return check(writer, result, err) &&
           check(writer, exr_encoding_run(writer->context, 0, encoder), err);
}

static bool write_pixels(struct exr_writer *writer, struct err *err)
{
    const struct image *image = writer->params->image;
    if (writer->params->half_float) {
        size_t channels = (size_t)COMPONENTS * (writer->params->layer_count + 1);
        size_t count;
        if (__builtin_mul_overflow(channels * BLOCK_LINES, image->width, &count))
            return err_set(err, ERR_OUTPUT, "EXR: too many channels");
        writer->halves = calloc(count, sizeof *writer->halves);
        if (!writer->halves)
            return err_memory(err, "half-precision lines", count * sizeof *writer->halves);
    }
    int32_t lines_per_block;
    if (!check(writer, exr_get_scanlines_per_chunk(writer->context, 0, &lines_per_block), err))
        return false;
    if (lines_per_block < 1 || lines_per_block > BLOCK_LINES)
        return err_set(err, ERR_BUG, "EXR: blocks of %d lines; expected up to %d", lines_per_block,
                       BLOCK_LINES);
    for (uint32_t y = 0; y < image->height; y += (uint32_t)lines_per_block)
        if (!write_block(writer, y, err))
            return false;
    return true;
}

// Checks that strides and coordinates fit into the library's 32-bit numbers.
static bool check_size(const struct image *image, struct err *err)
{
    const uint32_t width_max = INT32_MAX / (COMPONENTS * sizeof(float));
    if (image->width <= width_max && image->height < INT32_MAX - BLOCK_LINES)
        return true;
    return err_set(err, ERR_OUTPUT,
                   "%u x %u pixels are too many for EXR; expected a width up to %u", image->width,
                   image->height, width_max);
}

bool image_exr_write(const struct image_write_params *params, struct byte_buffer *out,
                     struct err *err)
{
    struct exr_writer writer = {.params = params, .stream = {.out = out}};
    bool ok =
        check_size(params->image, err) && write_header(&writer, err) && write_pixels(&writer, err);
    if (writer.encoder_ready)
        exr_encoding_destroy(writer.context, &writer.encoder);
    // Finishing writes the table of block offsets.
    exr_result_t result = writer.context ? exr_finish(&writer.context) : EXR_ERR_SUCCESS;
    ok = ok && check(&writer, result, err);
    free(writer.halves);
    if (ok && writer.saturated > 0)
        log_warn("%s: %llu values exceed %g, the half-precision maximum, and were clamped",
                 params->path, (unsigned long long)writer.saturated, (double)HALF_MAX);
    return ok;
}
