// Reads single-part EXR, scanlines or tiles, with any compression that OpenEXRCore decodes.
#include "image/image_exr.h"

#include <stdio.h>
#include <string.h>

enum { COLORS = 3, COMPONENTS = 4, NAME_MAX_BYTES = 255 };

struct exr_reader {
    const struct image_source *source;
    struct exr_stream stream;
    exr_context_t context;
    bool tiled;
    exr_attr_box2i_t window;
    uint64_t width, height;
    // Indices, in the file's channel list, of the channels for R, G and B (all the same for
    // luminance) and A (-1 if it does not exist or is not needed).
    int channels[COMPONENTS];
    exr_decode_pipeline_t decoder;
    bool decoder_ready;
    struct pixels *out;
};

static bool check(const struct exr_reader *reader, exr_result_t result, struct err *err)
{
    return result == EXR_ERR_SUCCESS || exr_fail(&reader->stream, result, ERR_INPUT, err);
}

static bool reader_open(struct exr_reader *reader, const struct image_source *source,
                        struct err *err)
{
    *reader = (struct exr_reader){.source = source,
                                  .stream = {.data = source->data, .size = source->size}};
    exr_context_initializer_t initializer = exr_stream_initializer(&reader->stream);
    if (!check(reader, exr_start_read(&reader->context, source->path, &initializer), err))
        return false;
    int parts;
    exr_storage_t storage;
    if (!check(reader, exr_get_count(reader->context, &parts), err))
        return false;
    if (parts != 1)
        return err_set(err, ERR_INPUT, "EXR: has %d parts; expected a single-part file", parts);
    if (!check(reader, exr_get_storage(reader->context, 0, &storage), err))
        return false;
    if (storage != EXR_STORAGE_SCANLINE && storage != EXR_STORAGE_TILED)
        return err_set(err, ERR_INPUT, "EXR: has deep pixels; expected scanlines or tiles");
    reader->tiled = storage == EXR_STORAGE_TILED;
    return true;
}

static void reader_close(struct exr_reader *reader)
{
    if (reader->decoder_ready)
        exr_decoding_destroy(reader->context, &reader->decoder);
    if (reader->context)
        exr_finish(&reader->context);
}

static int find_channel(const exr_attr_chlist_t *list, const char *layer, const char *component)
{
    char name[NAME_MAX_BYTES + 1];
    int length = layer ? snprintf(name, sizeof name, "%s.%s", layer, component)
                       : snprintf(name, sizeof name, "%s", component);
    if (length < 0 || length > NAME_MAX_BYTES)
        return -1;
    for (int i = 0; i < list->num_channels; i++)
        if (strcmp(list->entries[i].name.str, name) == 0)
            return i;
    return -1;
}

// Lists the channels' names as "A, B, C", truncated to `size` bytes.
static void list_channels(const exr_attr_chlist_t *list, char *text, size_t size)
{
    size_t used = 0;
    text[0] = '\0';
    for (int i = 0; i < list->num_channels && used < size; i++) {
        int length =
            snprintf(text + used, size - used, "%s%s", i ? ", " : "", list->entries[i].name.str);
        used += length > 0 ? (size_t)length : size;
    }
}

// Finds the three channels with these names; returns false if one is missing.
static bool find_three(const exr_attr_chlist_t *list, const char *layer,
                       const char *const names[COLORS], int channels[COLORS])
{
    bool found = true;
    for (int c = 0; c < COLORS; c++) {
        channels[c] = find_channel(list, layer, names[c]);
        found &= channels[c] >= 0;
    }
    return found;
}

// Finds the three colour channels: R, G and B; or X, Y and Z; or one channel for all three, Y or
// the one whose full name is `layer`.
static bool find_colors(const exr_attr_chlist_t *list, const char *layer, int channels[COLORS])
{
    static const char *const colors[] = {"R", "G", "B"}, *const axes[] = {"X", "Y", "Z"};
    if (find_three(list, layer, colors, channels) ||
        (layer && find_three(list, layer, axes, channels)))
        return true;
    int single = find_channel(list, layer, "Y");
    if (single < 0 && layer)
        single = find_channel(list, NULL, layer);
    for (int c = 0; c < COLORS; c++)
        channels[c] = single;
    return single >= 0;
}

// Chooses the channels for the colours, and for alpha if it is needed and exists.
static bool choose_channels(struct exr_reader *reader, struct err *err)
{
    const exr_attr_chlist_t *list;
    if (!check(reader, exr_get_channels(reader->context, 0, &list), err))
        return false;
    const char *layer = reader->source->layer;
    reader->channels[COLORS] = reader->source->with_alpha ? find_channel(list, layer, "A") : -1;
    if (!find_colors(list, layer, reader->channels)) {
        char present[200];
        list_channels(list, present, sizeof present);
        return err_set(
            err, ERR_INPUT, "EXR: expected channels %s%s{R, G, B} or %s%sY; present are %s",
            layer ? layer : "", layer ? "." : "", layer ? layer : "", layer ? "." : "", present);
    }
    for (int c = 0; c < COMPONENTS; c++) {
        if (reader->channels[c] < 0)
            continue;
        const exr_attr_chlist_entry_t *entry = &list->entries[reader->channels[c]];
        if (entry->x_sampling != 1 || entry->y_sampling != 1)
            return err_set(err, ERR_INPUT, "EXR: channel %s is subsampled %d x %d; expected 1 x 1",
                           entry->name.str, entry->x_sampling, entry->y_sampling);
    }
    return true;
}

// Reads the size of the image and allocates the pixels. Fails if decoding would exceed the memory
// budget.
static bool allocate(struct exr_reader *reader, struct arena *arena, struct err *err)
{
    exr_const_context_t context = reader->context;
    const exr_attr_box2i_t *window = &reader->window;
    if (!check(reader, exr_get_data_window(context, 0, &reader->window), err))
        return false;
    int64_t width = (int64_t)window->max.x - window->min.x + 1;
    int64_t height = (int64_t)window->max.y - window->min.y + 1;
    if (width <= 0 || height <= 0)
        return err_set(err, ERR_INPUT, "EXR: data window (%d, %d)-(%d, %d) is empty", window->min.x,
                       window->min.y, window->max.x, window->max.y);
    reader->width = (uint64_t)width;
    reader->height = (uint64_t)height;
    int32_t chunks;
    uint64_t chunk_bytes;
    if (!check(reader, exr_get_chunk_count(context, 0, &chunks), err) ||
        !check(reader, exr_get_chunk_unpacked_size(context, 0, &chunk_bytes), err))
        return false;
    // Memory of the library: a table of chunk offsets, a chunk as stored (no longer than the file)
    // and up to three buffers of the unpacked size.
    uint64_t table_bytes = chunks > 0 ? (uint64_t)chunks * sizeof(uint64_t) : 0;
    uint64_t extra;
    if (__builtin_mul_overflow(chunk_bytes, 3u, &extra) ||
        __builtin_add_overflow(extra, table_bytes + reader->source->size, &extra))
        return err_set(err, ERR_INPUT, "EXR: a chunk of %llu bytes is too long",
                       (unsigned long long)chunk_bytes);
    const struct pixels_size size = {reader->width, reader->height, 32, extra};
    return pixels_allocate(reader->source, &size, arena, reader->out, err);
}

static float sample_value(const uint8_t *bytes, exr_pixel_type_t type)
{
    uint32_t bits = bytes[0] | (uint32_t)bytes[1] << 8; // little-endian in the file
    if (type == EXR_PIXEL_HALF)
        return float_from_half((uint16_t)bits);
    bits |= (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
    if (type == EXR_PIXEL_UINT)
        return (float)bits;
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

// Unpacks one line of one channel into a component of the pixels from `first` on.
static void unpack_line(const struct exr_reader *reader, int index, const uint8_t *bytes,
                        const exr_coding_channel_info_t *channel, uint64_t first)
{
    for (int c = 0; c < COMPONENTS; c++)
        for (int32_t x = 0; reader->channels[c] == index && x < channel->width; x++)
            pixels_at(reader->out, first + (uint64_t)x)[c] =
                sample_value(bytes + (size_t)x * (size_t)channel->bytes_per_element,
                             (exr_pixel_type_t)channel->data_type);
}

// Unpacks a decompressed chunk, whose first pixel is pixel (x, y) of the image. It is stored line
// by line, and each line channel by channel (OpenEXR file layout, "scan line blocks").
static bool unpack_chunk(struct exr_reader *reader, uint64_t x, uint64_t y, struct err *err)
{
    const exr_decode_pipeline_t *decoder = &reader->decoder;
    const uint8_t *bytes = decoder->unpacked_buffer;
    uint64_t left = bytes ? decoder->chunk.unpacked_size : 0;
    for (int32_t line = 0; line < decoder->chunk.height; line++) {
        uint64_t first = (y + (uint64_t)line) * reader->width + x;
        int64_t row = reader->window.min.y + (int64_t)y + line;
        for (int i = 0; i < decoder->channel_count; i++) {
            const exr_coding_channel_info_t *channel = &decoder->channels[i];
            if (row % channel->y_samples != 0)
                continue; // a subsampled channel that is not needed has no samples on this line
            uint64_t size = (uint64_t)channel->width * (uint64_t)channel->bytes_per_element;
            if (size > left)
                return err_set(err, ERR_INPUT, "EXR: a chunk ends early");
            unpack_line(reader, i, bytes, channel, first);
            bytes += size;
            left -= size;
        }
    }
    return true;
}

static bool decode_chunk(struct exr_reader *reader, const exr_chunk_info_t *chunk, uint64_t x,
                         uint64_t y, struct err *err)
{
    if (chunk->width <= 0 || chunk->height <= 0 || x + (uint64_t)chunk->width > reader->width ||
        y + (uint64_t)chunk->height > reader->height)
        return err_set(err, ERR_INPUT, "EXR: a chunk of %d x %d pixels lies outside the picture",
                       chunk->width, chunk->height);
    return check(reader,
                 exr_decode_bytes(reader->context, chunk, &reader->decoder, &reader->decoder_ready),
                 err) &&
           unpack_chunk(reader, x, y, err);
}

static bool read_scanlines(struct exr_reader *reader, struct err *err)
{
    exr_chunk_info_t chunk;
    for (uint64_t y = 0; y < reader->height; y += (uint64_t)chunk.height) {
        int64_t row = reader->window.min.y + (int64_t)y;
        if (!pixels_go_on(reader->source, 0, reader->width, err))
            return false;
        if (!check(reader, exr_read_scanline_chunk_info(reader->context, 0, (int)row, &chunk),
                   err) ||
            !decode_chunk(reader, &chunk, 0, y, err))
            return err_prepend(err, "line %lld", (long long)row);
    }
    return true;
}

static bool read_tiles(struct exr_reader *reader, struct err *err)
{
    int32_t tile_width, tile_height;
    if (!check(reader, exr_get_tile_sizes(reader->context, 0, 0, 0, &tile_width, &tile_height),
               err))
        return false;
    if (tile_width <= 0 || tile_height <= 0)
        return err_set(err, ERR_INPUT, "EXR: tiles of %d x %d pixels; expected at least 1 x 1",
                       tile_width, tile_height);
    for (uint64_t y = 0; y < reader->height; y += (uint64_t)tile_height)
        for (uint64_t x = 0; x < reader->width; x += (uint64_t)tile_width) {
            exr_chunk_info_t chunk;
            if (!pixels_go_on(reader->source, 0, reader->width, err))
                return false;
            int column = (int)(x / (uint64_t)tile_width), row = (int)(y / (uint64_t)tile_height);
            if (!check(reader,
                       exr_read_tile_chunk_info(reader->context, 0, column, row, 0, 0, &chunk),
                       err) ||
                !decode_chunk(reader, &chunk, x, y, err))
                return err_prepend(err, "tile (%d, %d)", column, row);
        }
    return true;
}

// Sets alpha to 1 if the file has none; otherwise divides the colours by alpha.
static void finish_alpha(const struct exr_reader *reader)
{
    bool has_alpha = reader->channels[COLORS] >= 0;
    uint64_t count = reader->width * reader->height;
    for (uint64_t i = 0; i < count && reader->out->components == COMPONENTS; i++) {
        float *pixel = pixels_at(reader->out, i);
        float alpha = has_alpha ? pixel[COLORS] : 1.0f;
        pixel[COLORS] = alpha;
        for (int c = 0; c < COLORS && alpha != 0.0f && alpha != 1.0f; c++)
            pixel[c] /= alpha;
    }
}

bool image_exr_read(const struct image_source *source, struct arena *arena, struct pixels *out,
                    struct err *err)
{
    struct exr_reader reader;
    bool ok = reader_open(&reader, source, err);
    reader.out = out;
    ok = ok && choose_channels(&reader, err) && allocate(&reader, arena, err) &&
         (reader.tiled ? read_tiles(&reader, err) : read_scanlines(&reader, err));
    if (ok)
        finish_alpha(&reader);
    reader_close(&reader);
    return ok;
}

static bool copy_attributes(struct exr_reader *reader, struct arena *arena,
                            struct image_attribute **out, uint32_t *count, struct err *err)
{
    int32_t total;
    if (!check(reader, exr_get_attribute_count(reader->context, 0, &total), err))
        return false;
    *out = ARENA_NEW(arena, struct image_attribute, (size_t)total);
    if (!*out)
        return err_memory(err, "attributes", (size_t)total * sizeof **out);
    for (int32_t i = 0; i < total; i++) {
        const exr_attribute_t *attribute;
        if (!check(reader,
                   exr_get_attribute_by_index(reader->context, 0, EXR_ATTR_LIST_FILE_ORDER, i,
                                              &attribute),
                   err))
            return false;
        // "type" belongs to the format, not to the metadata, because it distinguishes scanlines and
        // tiles.
        if (attribute->type != EXR_ATTR_STRING || strcmp(attribute->name, "type") == 0)
            continue;
        char *key = arena_strdup(arena, attribute->name);
        char *value =
            arena_printf(arena, "%.*s", attribute->string->length, attribute->string->str);
        if (!key || !value)
            return err_memory(err, "an attribute", (size_t)attribute->string->length);
        (*out)[(*count)++] = (struct image_attribute){key, value};
    }
    return true;
}

bool image_exr_read_attributes(const struct image_source *source, struct arena *arena,
                               struct image_attribute **out, uint32_t *count, struct err *err)
{
    struct exr_reader reader;
    bool ok = reader_open(&reader, source, err) && copy_attributes(&reader, arena, out, count, err);
    reader_close(&reader);
    return ok;
}
