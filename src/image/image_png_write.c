// Writes RGB PNG of 8 or 16 bits: tone-mapped, sRGB-encoded, with tEXt (ASCII) and iTXt (UTF-8)
// metadata.
#include "image/image_png.h"

#include <stdlib.h>
#include <string.h>

// Everything that must survive a longjmp is in this struct, outside the function that calls setjmp,
// because automatic variables changed after setjmp are indeterminate after longjmp (C17 7.13.2.1).
struct png_writer {
    const struct image_write_params *params;
    struct byte_buffer *out;
    struct png_failure failure;
    png_structp png;
    png_infop info;
    png_textp texts;
    const uint8_t *codes;
};

static void write_bytes(png_structp png, png_bytep data, size_t size)
{
    struct png_writer *writer = png_get_io_ptr(png);
    if (!byte_buffer_write(writer->out, writer->out->size, data, size)) {
        writer->failure.out_of_memory = true;
        png_error(png, "out of memory");
    }
}

static void flush_nothing(png_structp png)
{
    (void)png;
}

static bool is_ascii(const char *text)
{
    for (; *text; text++)
        if ((unsigned char)*text >= 0x80)
            return false;
    return true;
}

// Writes the metadata. tEXt is Latin-1, so text that is not ASCII goes to iTXt, which is UTF-8.
static void set_texts(struct png_writer *writer)
{
    const struct image_write_params *params = writer->params;
    for (uint32_t i = 0; i < params->attribute_count; i++) {
        const struct image_attribute *attribute = &params->attributes[i];
        // libpng copies key and text; its pointers are not const only because readers use them,
        // too.
        writer->texts[i] = (png_text){
            .compression =
                is_ascii(attribute->value) ? PNG_TEXT_COMPRESSION_NONE : PNG_ITXT_COMPRESSION_NONE,
            .key = (char *)(uintptr_t)attribute->key,
            .text = (char *)(uintptr_t)attribute->value,
        };
    }
    png_set_text(writer->png, writer->info, writer->texts, (int)params->attribute_count);
}

// Runs libpng. Returns false after an error that came by longjmp.
static bool run(struct png_writer *writer)
{
    if (setjmp(png_jmpbuf(writer->png)))
        return false;
    const struct image *image = writer->params->image;
    const size_t row_bytes = (size_t)image->width * IMAGE_PNG_PIXEL_BYTES(writer->params);
    png_set_write_fn(writer->png, writer, write_bytes, flush_nothing);
    // libpng's own limit is 10^6 per side; here only memory limits the size.
    png_set_user_limits(writer->png, PNG_UINT_31_MAX, PNG_UINT_31_MAX);
    png_set_IHDR(writer->png, writer->info, image->width, image->height,
                 IMAGE_PNG_BITS(writer->params), PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    if (writer->params->unfiltered)
        png_set_filter(writer->png, PNG_FILTER_TYPE_BASE, PNG_FILTER_NONE);
    png_set_sRGB(writer->png, writer->info, PNG_sRGB_INTENT_RELATIVE);
    set_texts(writer);
    png_write_info(writer->png, writer->info);
    for (uint32_t y = 0; y < image->height; y++)
        png_write_row(writer->png, writer->codes + y * row_bytes);
    png_write_end(writer->png, NULL);
    return true;
}

static bool prepare(struct png_writer *writer, struct err *err)
{
    const struct image_write_params *params = writer->params;
    writer->texts = calloc((size_t)params->attribute_count + 1, sizeof *writer->texts);
    writer->png =
        png_create_write_struct_2(PNG_LIBPNG_VER_STRING, &writer->failure, png_keep_error,
                                  png_drop_warning, NULL, png_take_memory, png_give_memory);
    writer->info = writer->png ? png_create_info_struct(writer->png) : NULL;
    if (writer->texts && writer->info)
        return true;
    return err_memory(err, "the PNG writer", 3ull * params->image->width);
}

// Checks the metadata's keys: 1 to 79 printable Latin-1 characters (PNG specification 11.3.4.2), of
// which only ASCII is permitted here. libpng drops other keys with a warning, and the image could
// then not be reproduced from its metadata.
static bool check_keys(const struct image_write_params *params, struct err *err)
{
    for (uint32_t i = 0; i < params->attribute_count; i++) {
        const char *key = params->attributes[i].key;
        size_t length = strlen(key);
        bool ok = length >= 1 && length <= 79 && key[0] != ' ' && key[length - 1] != ' ' &&
                  !strstr(key, "  ");
        for (const char *c = key; *c; c++)
            ok &= *c >= ' ' && *c <= '~';
        if (!ok)
            return err_set(err, ERR_OUTPUT,
                           "metadata key \"%.79s\" cannot be written to a PNG; expected 1 to 79 "
                           "printable ASCII characters",
                           key);
    }
    return true;
}

static void put_code(uint8_t *pixel, size_t component, unsigned bits, float display)
{
    if (bits == 8) {
        pixel[component] = image_quantize(display);
        return;
    }
    uint16_t code = (uint16_t)(display * 65535.0f + 0.5f);
    pixel[2 * component] = (uint8_t)(code >> 8);
    pixel[2 * component + 1] = (uint8_t)code;
}

bool image_display_codes(const struct image_write_params *params, uint8_t **codes, struct err *err)
{
    const float(*pixels)[3] = (const float(*)[3])params->image->pixels;
    const size_t count = (size_t)params->image->width * params->image->height;
    const size_t pixel_bytes = IMAGE_PNG_PIXEL_BYTES(params);
    *codes = calloc(count, pixel_bytes);
    if (!*codes)
        return err_memory(err, "a picture's codes", (uint64_t)pixel_bytes * count);
    for (size_t i = 0; i < count; i++) {
        float display[3];
        image_tone_map(params->tone, params->exposure_stops, pixels[i], display);
        for (size_t c = 0; c < 3; c++)
            put_code(*codes + i * pixel_bytes, c, IMAGE_PNG_BITS(params), display[c]);
    }
    return true;
}

bool image_png_write(const struct image_write_params *params, const uint8_t *codes,
                     struct byte_buffer *out, struct err *err)
{
    if (!check_keys(params, err))
        return false;
    struct png_writer writer = {.params = params, .codes = codes, .out = out};
    bool ok = prepare(&writer, err);
    if (ok && !run(&writer))
        ok = writer.failure.out_of_memory
                 ? err_memory(err, "the PNG", out->size)
                 : err_set(err, ERR_OUTPUT, "PNG: %s", writer.failure.message);
    png_destroy_write_struct(&writer.png, &writer.info);
    free(writer.texts);
    return ok;
}
