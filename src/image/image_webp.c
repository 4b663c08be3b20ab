// Reads still WebP pictures with libwebp: lossy or lossless, with or without alpha.
#include "image/image_internal.h"

#include "base/memory.h"
#include <stdlib.h>
#include <webp/decode.h>

struct webp_reader {
    const struct image_source *source;
    unsigned components; // 3 or 4, each a byte
    WebPDecoderConfig config;
    WebPIDecoder *decoder;
    uint8_t *codes; // row 0 at the top
};

static bool fail(VP8StatusCode status, struct err *err)
{
    if (status == VP8_STATUS_OUT_OF_MEMORY)
        return err_memory(err, "the WebP decoder", 0);
    return err_set(err, ERR_INPUT, "WebP: %s",
                   status == VP8_STATUS_SUSPENDED || status == VP8_STATUS_NOT_ENOUGH_DATA
                       ? "the file ends early"
                       : "the data are damaged");
}

static bool read_header(struct webp_reader *reader, struct err *err)
{
    const struct image_source *source = reader->source;
    WebPBitstreamFeatures *features = &reader->config.input;
    if (!WebPInitDecoderConfig(&reader->config))
        return err_set(err, ERR_SYSTEM, "the installed libwebp is another version than expected");
    VP8StatusCode status = WebPGetFeatures(source->data, source->size, features);
    if (status != VP8_STATUS_OK)
        return fail(status, err);
    return !features->has_animation ||
           err_set(err, ERR_INPUT, "WebP: the file is an animation; expected a still picture");
}

static bool allocate(struct webp_reader *reader, struct arena *arena, struct pixels *out,
                     struct err *err)
{
    const uint64_t width = (uint64_t)reader->config.input.width;
    const uint64_t height = (uint64_t)reader->config.input.height;
    reader->components = reader->source->with_alpha ? 4 : 3;
    // Beside the codes, the library stores a lossless picture in four bytes per pixel.
    const uint64_t row_bytes = width * reader->components;
    const struct pixels_size size = {width, height, 8, height * (row_bytes + 4 * width)};
    if (!pixels_allocate(reader->source, &size, arena, out, err))
        return false;
    reader->codes = memory_alloc((size_t)(row_bytes * height));
    reader->config.output.colorspace = reader->source->with_alpha ? MODE_RGBA : MODE_RGB;
    reader->config.output.is_external_memory = 1;
    reader->config.output.u.RGBA = (WebPRGBABuffer){
        .rgba = reader->codes,
        .stride = (int)row_bytes,
        .size = (size_t)(row_bytes * height),
    };
    reader->decoder = reader->codes ? WebPIDecode(NULL, 0, &reader->config) : NULL;
    return reader->decoder ? true : err_memory(err, "the codes of a picture", row_bytes * height);
}

// Gives the decoder more and more of the file, and polls for a stop in between.
static bool decode(struct webp_reader *reader, struct err *err)
{
    const struct image_source *source = reader->source;
    const size_t step = 1u << 18; // bytes between two polls
    VP8StatusCode status = VP8_STATUS_SUSPENDED;
    for (size_t size = 0; status == VP8_STATUS_SUSPENDED && size < source->size;) {
        if (progress_should_stop(source->progress))
            return err_set(err, ERR_STOPPED, "stopped while decoding");
        size = source->size - size > step ? size + step : source->size;
        status = WebPIUpdate(reader->decoder, source->data, size);
    }
    return status == VP8_STATUS_OK || fail(status, err);
}

static bool convert(const struct webp_reader *reader, const struct pixels *out, struct err *err)
{
    struct code_table table;
    code_table_fill(reader->source->is_linear, &table);
    for (uint32_t y = 0; y < out->height; y++) {
        if (!pixels_go_on(reader->source, y, out->width, err))
            return false;
        const size_t row_bytes = (size_t)out->width * reader->components;
        pixels_put_codes(out, y, reader->codes + y * row_bytes, reader->components, &table);
    }
    return true;
}

bool image_webp_read(const struct image_source *source, struct arena *arena, struct pixels *out,
                     struct err *err)
{
    struct webp_reader reader = {.source = source};
    bool ok = read_header(&reader, err) && allocate(&reader, arena, out, err) &&
              decode(&reader, err) && convert(&reader, out, err);
    WebPIDelete(reader.decoder);
    memory_free(reader.codes);
    return ok;
}
