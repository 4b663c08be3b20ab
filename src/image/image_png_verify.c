// Decodes a PNG that was just encoded and compares it with the original.
#include "image/image_png.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Everything that must survive a longjmp is in this struct, outside the function that calls setjmp.
struct png_verifier {
    const struct image_write_params *params;
    const uint8_t *codes;
    const struct byte_buffer *file;
    size_t at;
    struct png_failure failure;
    png_structp png;
    png_infop info;
    png_bytep row;
};

static void read_bytes(png_structp png, png_bytep data, size_t size)
{
    struct png_verifier *verifier = png_get_io_ptr(png);
    if (size > verifier->file->size - verifier->at)
        png_error(png, "the file ends early");
    memcpy(data, verifier->file->data + verifier->at, size);
    verifier->at += size;
}

static void check_header(struct png_verifier *verifier)
{
    const struct image *image = verifier->params->image;
    if (png_get_image_width(verifier->png, verifier->info) != image->width ||
        png_get_image_height(verifier->png, verifier->info) != image->height ||
        png_get_bit_depth(verifier->png, verifier->info) != IMAGE_PNG_BITS(verifier->params) ||
        png_get_color_type(verifier->png, verifier->info) != PNG_COLOR_TYPE_RGB ||
        !png_get_valid(verifier->png, verifier->info, PNG_INFO_sRGB))
        png_error(verifier->png, "the header is not what was written");
}

static void check_texts(struct png_verifier *verifier)
{
    const struct image_write_params *params = verifier->params;
    png_textp texts = NULL;
    int count = 0;
    png_get_text(verifier->png, verifier->info, &texts, &count);
    bool ok = (uint32_t)count == params->attribute_count;
    for (uint32_t i = 0; ok && i < params->attribute_count; i++)
        ok = strcmp(texts[i].key, params->attributes[i].key) == 0 &&
             strcmp(texts[i].text, params->attributes[i].value) == 0;
    if (!ok)
        png_error(verifier->png, "the metadata is not what was written");
}

static void check_row(struct png_verifier *verifier, uint32_t y)
{
    const size_t value_bytes = IMAGE_PNG_BITS(verifier->params) / 8;
    const size_t bytes =
        (size_t)verifier->params->image->width * IMAGE_PNG_PIXEL_BYTES(verifier->params);
    const uint8_t *expected = verifier->codes + y * bytes;
    char message[100];
    for (size_t i = 0; i < bytes; i++) {
        if (verifier->row[i] == expected[i])
            continue;
        snprintf(message, sizeof message, "%s of pixel %zu,%u reads as %u; expected %u",
                 i / value_bytes % 3 == 0   ? "red"
                 : i / value_bytes % 3 == 1 ? "green"
                                            : "blue",
                 i / value_bytes / 3, y, verifier->row[i], expected[i]);
        png_error(verifier->png, message);
    }
}

// Runs libpng. Returns false after an error that came by longjmp.
static bool run(struct png_verifier *verifier)
{
    if (setjmp(png_jmpbuf(verifier->png)))
        return false;
    png_set_user_limits(verifier->png, PNG_UINT_31_MAX, PNG_UINT_31_MAX);
    png_set_chunk_malloc_max(verifier->png, 0); // no limit: the file was just written
    png_set_read_fn(verifier->png, verifier, read_bytes);
    png_read_info(verifier->png, verifier->info);
    check_header(verifier);
    check_texts(verifier);
    for (uint32_t y = 0; y < verifier->params->image->height; y++) {
        png_read_row(verifier->png, verifier->row, NULL);
        check_row(verifier, y);
    }
    png_read_end(verifier->png, NULL);
    if (verifier->at != verifier->file->size)
        png_error(verifier->png, "the file is longer than the picture");
    return true;
}

bool image_png_verify(const struct image_write_params *params, const uint8_t *codes,
                      const struct byte_buffer *file, struct err *err)
{
    struct png_verifier verifier = {.params = params, .codes = codes, .file = file};
    verifier.row = malloc((size_t)params->image->width * IMAGE_PNG_PIXEL_BYTES(params));
    verifier.png =
        png_create_read_struct_2(PNG_LIBPNG_VER_STRING, &verifier.failure, png_keep_error,
                                 png_drop_warning, NULL, png_take_memory, png_give_memory);
    verifier.info = verifier.png ? png_create_info_struct(verifier.png) : NULL;
    bool ok = verifier.row && verifier.info;
    if (!ok)
        err_memory(err, "the PNG reader", 3ull * params->image->width);
    else if (!run(&verifier))
        ok = err_set(err, ERR_OUTPUT, "PNG: %s", verifier.failure.message);
    png_destroy_read_struct(&verifier.png, &verifier.info, NULL);
    free(verifier.row);
    return ok;
}
