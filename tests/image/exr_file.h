// Writes EXR files, with OpenEXRCore, that image_write cannot write: any channels, windows and
// storage.
#ifndef LAMPYRIS_TESTS_EXR_FILE_H
#define LAMPYRIS_TESTS_EXR_FILE_H

#include "image/image_internal.h"
#include "test.h"
#include <openexr.h>

struct exr_file {
    exr_attr_box2i_t window;
    exr_compression_t compression;
    uint32_t tile; // side length of the tiles; 0: scanlines
    bool deep;
    int parts; // 0: 1
    struct {
        const char *name;
        exr_pixel_type_t type;
        int sampling; // 0: 1
    } channels[8];    // sorted by name
};

// Returns the value of a pixel for its place in the data window and the channel's index. The writer
// converts it to the channel's type.
static inline float exr_file_value(int x, int y, int channel)
{
    return (float)(x + 10 * y + 100 * channel);
}

static inline int64_t exr_file_store(exr_const_context_t context, void *user_data, const void *data,
                                     uint64_t size, uint64_t offset,
                                     exr_stream_error_func_ptr_t report)
{
    (void)context, (void)report;
    return byte_buffer_write(user_data, (size_t)offset, data, (size_t)size) ? (int64_t)size : -1;
}

static inline void exr_file_no_message(exr_const_context_t context, exr_result_t code,
                                       const char *message)
{
    (void)context;
    CHECK(false, "EXR error %d: %s", code, message);
}

// Writes one chunk, with all channels as planes of their own types.
static inline bool exr_file_write_chunk(const struct exr_file *file, exr_context_t context,
                                        const exr_chunk_info_t *chunk, int x0, int y0)
{
    exr_encode_pipeline_t encoder = EXR_ENCODE_PIPELINE_INITIALIZER;
    if (exr_encoding_initialize(context, 0, chunk, &encoder) != EXR_ERR_SUCCESS)
        return false;
    uint8_t *planes[8] = {0};
    for (int i = 0; i < encoder.channel_count; i++) {
        exr_coding_channel_info_t *channel = &encoder.channels[i];
        size_t element = (size_t)channel->bytes_per_element;
        planes[i] = calloc((size_t)(chunk->width * chunk->height), element);
        for (int k = 0; k < channel->width * channel->height; k++) {
            float value = exr_file_value(x0 + k % channel->width, y0 + k / channel->width, i);
            uint16_t half = half_from_float(value);
            uint32_t whole = (uint32_t)value;
            const void *from = file->channels[i].type == EXR_PIXEL_HALF    ? (const void *)&half
                               : file->channels[i].type == EXR_PIXEL_FLOAT ? (const void *)&value
                                                                           : (const void *)&whole;
            memcpy(planes[i] + (size_t)k * element, from, element);
        }
        channel->encode_from_ptr = planes[i];
        channel->user_pixel_stride = (int32_t)element;
        channel->user_line_stride = (int32_t)element * channel->width;
        channel->user_data_type = channel->data_type;
        channel->user_bytes_per_element = channel->bytes_per_element;
    }
    bool ok = exr_encoding_choose_default_routines(context, 0, &encoder) == EXR_ERR_SUCCESS &&
              exr_encoding_run(context, 0, &encoder) == EXR_ERR_SUCCESS;
    exr_encoding_destroy(context, &encoder);
    for (int i = 0; i < 8; i++)
        free(planes[i]);
    return ok;
}

static inline bool exr_file_write_chunks(const struct exr_file *file, exr_context_t context)
{
    int width = file->window.max.x - file->window.min.x + 1;
    int height = file->window.max.y - file->window.min.y + 1;
    exr_chunk_info_t chunk;
    int step_x = file->tile ? (int)file->tile : width, step_y = (int)file->tile;
    if (!file->tile && exr_get_scanlines_per_chunk(context, 0, &step_y) != EXR_ERR_SUCCESS)
        return false;
    for (int y = 0; y < height; y += step_y)
        for (int x = 0; x < width; x += step_x) {
            exr_result_t result =
                file->tile
                    ? exr_write_tile_chunk_info(context, 0, x / step_x, y / step_y, 0, 0, &chunk)
                    : exr_write_scanline_chunk_info(context, 0, file->window.min.y + y, &chunk);
            if (result != EXR_ERR_SUCCESS || !exr_file_write_chunk(file, context, &chunk, x, y))
                return false;
        }
    return true;
}

static inline bool exr_file_write_header(const struct exr_file *file, exr_context_t context)
{
    static const char *const names[] = {"first", "second"};
    int parts = file->parts > 0 ? file->parts : 1;
    exr_storage_t storage = file->deep   ? EXR_STORAGE_DEEP_SCANLINE
                            : file->tile ? EXR_STORAGE_TILED
                                         : EXR_STORAGE_SCANLINE;
    const exr_attr_v2f_t centre = {0};
    for (int part = 0; part < parts; part++) {
        int index;
        bool ok =
            exr_add_part(context, parts > 1 ? names[part] : NULL, storage, &index) == 0 &&
            exr_initialize_required_attr(context, index, &file->window, &file->window, 1, &centre,
                                         1, EXR_LINEORDER_INCREASING_Y, file->compression) == 0;
        for (int i = 0; ok && i < 8 && file->channels[i].name; i++) {
            int sampling = file->channels[i].sampling ? file->channels[i].sampling : 1;
            ok = exr_add_channel(context, index, file->channels[i].name, file->channels[i].type,
                                 EXR_PERCEPTUALLY_LOGARITHMIC, sampling, sampling) == 0;
        }
        if (ok && file->tile)
            ok = exr_set_tile_descriptor(context, index, file->tile, file->tile, EXR_TILE_ONE_LEVEL,
                                         EXR_TILE_ROUND_DOWN) == 0;
        if (!ok)
            return false;
    }
    return exr_write_header(context) == 0;
}

// Writes the header and, for an ordinary single-part file, the pixels.
static inline bool exr_file_write(const struct exr_file *file, struct byte_buffer *out)
{
    exr_context_initializer_t initializer = EXR_DEFAULT_CONTEXT_INITIALIZER;
    initializer.user_data = out;
    initializer.write_fn = exr_file_store;
    initializer.error_handler_fn = exr_file_no_message;
    exr_context_t context;
    if (exr_start_write(&context, "memory", EXR_WRITE_FILE_DIRECTLY, &initializer) != 0)
        return false;
    bool ok = exr_file_write_header(file, context);
    if (!file->deep && file->parts <= 1)
        ok = ok && exr_file_write_chunks(file, context);
    return exr_finish(&context) == 0 && ok;
}

#endif
