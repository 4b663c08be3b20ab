// Decodes an EXR file that was just encoded and compares all of its bits with the original.
#include "image/image_exr.h"

#include "image/image_exr_channel.h"
#include <stdlib.h>
#include <string.h>

struct exr_verifier {
    const struct image_write_params *params;
    struct exr_stream stream;
    exr_context_t context;
    exr_decode_pipeline_t decoder;
    bool decoder_ready;
};

static bool check(const struct exr_verifier *verifier, exr_result_t result, struct err *err)
{
    return result == EXR_ERR_SUCCESS || exr_fail(&verifier->stream, result, ERR_OUTPUT, err);
}

static bool same_window(const exr_attr_box2i_t *a, const exr_attr_box2i_t *b)
{
    return a->min.x == b->min.x && a->min.y == b->min.y && a->max.x == b->max.x &&
           a->max.y == b->max.y;
}

static bool check_header(const struct exr_verifier *verifier, struct err *err)
{
    exr_const_context_t context = verifier->context;
    int parts;
    exr_storage_t storage;
    exr_compression_t compression;
    exr_lineorder_t order;
    exr_attr_box2i_t data, display;
    const struct exr_windows windows = exr_windows_of(verifier->params);
    exr_attr_v2f_t center;
    float aspect, width;
    if (!check(verifier, exr_get_count(context, &parts), err) ||
        !check(verifier, exr_get_storage(context, 0, &storage), err) ||
        !check(verifier, exr_get_compression(context, 0, &compression), err) ||
        !check(verifier, exr_get_lineorder(context, 0, &order), err) ||
        !check(verifier, exr_get_data_window(context, 0, &data), err) ||
        !check(verifier, exr_get_display_window(context, 0, &display), err) ||
        !check(verifier, exr_get_pixel_aspect_ratio(context, 0, &aspect), err) ||
        !check(verifier, exr_get_screen_window_center(context, 0, &center), err) ||
        !check(verifier, exr_get_screen_window_width(context, 0, &width), err))
        return false;
    bool ok = parts == 1 && storage == EXR_STORAGE_SCANLINE &&
              compression == exr_compression_of(verifier->params) &&
              order == EXR_LINEORDER_INCREASING_Y && same_window(&data, &windows.data) &&
              same_window(&display, &windows.display) && aspect == 1 && center.x == 0 &&
              center.y == 0 && width == 1;
    return ok || err_set(err, ERR_OUTPUT, "EXR: the decoded header differs from the one encoded");
}

static bool check_channels(const struct exr_verifier *verifier, struct err *err)
{
    const exr_attr_chlist_t *list;
    if (!check(verifier, exr_get_channels(verifier->context, 0, &list), err))
        return false;
    struct exr_channel channel;
    int count = 0;
    while (exr_channel_at(verifier->params, (uint32_t)count, &channel))
        count++;
    bool ok = list->num_channels == count;
    for (int i = 0; ok && i < count; i++)
        ok = exr_channel_find(verifier->params, list->entries[i].name.str, &channel) &&
             list->entries[i].pixel_type == channel.type && list->entries[i].x_sampling == 1 &&
             list->entries[i].y_sampling == 1;
    return ok || err_set(err, ERR_OUTPUT, "EXR: the decoded channels differ from those encoded");
}

static bool check_attributes(const struct exr_verifier *verifier, struct err *err)
{
    const struct image_write_params *params = verifier->params;
    for (uint32_t i = 0; i < params->attribute_count; i++) {
        const struct image_attribute *wanted = &params->attributes[i];
        const exr_attribute_t *found = NULL;
        size_t length = strlen(wanted->value);
        bool ok = exr_get_attribute_by_name(verifier->context, 0, wanted->key, &found) ==
                      EXR_ERR_SUCCESS &&
                  found->type == EXR_ATTR_STRING && found->string->length >= 0 &&
                  (size_t)found->string->length == length &&
                  memcmp(found->string->str, wanted->value, length) == 0;
        if (!ok)
            return err_set(err, ERR_OUTPUT,
                           "EXR: the decoded attribute \"%s\" differs from the one encoded",
                           wanted->key);
    }
    return true;
}

// Returns the first pixel of a line of one channel whose bits differ from the original; `width` if
// none does.
static uint32_t first_difference(const struct exr_channel *channel, const uint8_t *bytes,
                                 size_t first, uint32_t width, uint32_t *found)
{
    bool is_half = channel->type == EXR_PIXEL_HALF;
    for (uint32_t x = 0; x < width; x++, bytes += is_half ? 2 : 4) {
        *found = bytes[0] | (uint32_t)bytes[1] << 8; // little-endian in the file
        if (!is_half)
            *found |= (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
        if (*found != exr_channel_bits(channel, first + x))
            return x;
    }
    return width;
}

// Compares all lines of one channel of the block. `offset` is the channel's position in each line,
// in bytes.
static bool compare_channel(const struct exr_verifier *verifier, const struct exr_channel *channel,
                            size_t offset, size_t line_bytes, struct err *err)
{
    const exr_decode_pipeline_t *decoder = &verifier->decoder;
    const uint32_t width = verifier->params->image->width;
    const uint8_t *bytes = decoder->unpacked_buffer;
    for (int32_t line = 0; line < decoder->chunk.height; line++) {
        uint32_t y = (uint32_t)(decoder->chunk.start_y + line) - verifier->params->display.y, found;
        size_t first = (size_t)y * width;
        uint32_t x = first_difference(channel, bytes + (size_t)line * line_bytes + offset, first,
                                      width, &found);
        if (x < width)
            return err_set(err, ERR_OUTPUT,
                           "EXR: channel %s of pixel %u,%u reads as bits %08x; expected %08x",
                           channel->name, x, y, found, exr_channel_bits(channel, first + x));
    }
    return true;
}

// Compares a decompressed block, which is stored line by line, and each line channel by channel.
static bool compare_block(const struct exr_verifier *verifier, struct err *err)
{
    const exr_decode_pipeline_t *decoder = &verifier->decoder;
    const uint32_t width = verifier->params->image->width;
    size_t line_bytes = 0, offset = 0;
    for (int i = 0; i < decoder->channel_count; i++)
        line_bytes += (size_t)decoder->channels[i].bytes_per_element * width;
    uint64_t found = decoder->unpacked_buffer ? decoder->chunk.unpacked_size : 0;
    if (found != line_bytes * (uint64_t)decoder->chunk.height)
        return err_set(err, ERR_OUTPUT, "EXR: a block has %llu bytes; expected %llu",
                       (unsigned long long)found,
                       (unsigned long long)line_bytes * (unsigned)decoder->chunk.height);
    for (int i = 0; i < decoder->channel_count; i++) {
        struct exr_channel channel;
        if (!exr_channel_find(verifier->params, decoder->channels[i].channel_name, &channel))
            return err_set(err, ERR_BUG, "EXR: channel %s of the file was not among those written",
                           decoder->channels[i].channel_name);
        if (!compare_channel(verifier, &channel, offset, line_bytes, err))
            return false;
        offset += (size_t)decoder->channels[i].bytes_per_element * width;
    }
    return true;
}

static bool compare_pixels(struct exr_verifier *verifier, struct err *err)
{
    exr_chunk_info_t chunk;
    for (uint32_t y = 0; y < verifier->params->image->height; y += (uint32_t)chunk.height) {
        if (!check(verifier,
                   exr_read_scanline_chunk_info(verifier->context, 0,
                                                (int)(y + verifier->params->display.y), &chunk),
                   err) ||
            !check(verifier,
                   exr_decode_bytes(verifier->context, &chunk, &verifier->decoder,
                                    &verifier->decoder_ready),
                   err))
            return false;
        if (chunk.height <= 0)
            return err_set(err, ERR_OUTPUT, "EXR: the block of line %u has no lines", y);
        if (!compare_block(verifier, err))
            return false;
    }
    return true;
}

bool image_exr_verify(const struct image_write_params *params, const struct byte_buffer *file,
                      struct err *err)
{
    struct exr_verifier verifier = {.params = params,
                                    .stream = {.data = file->data, .size = file->size}};
    exr_context_initializer_t initializer = exr_stream_initializer(&verifier.stream);
    initializer.flags |= EXR_CONTEXT_FLAG_STRICT_HEADER; // missing attributes are errors
    bool ok =
        check(&verifier, exr_start_read(&verifier.context, params->path, &initializer), err) &&
        check_header(&verifier, err) && check_channels(&verifier, err) &&
        check_attributes(&verifier, err) && compare_pixels(&verifier, err);
    if (verifier.decoder_ready)
        exr_decoding_destroy(verifier.context, &verifier.decoder);
    if (verifier.context)
        exr_finish(&verifier.context);
    return ok;
}
