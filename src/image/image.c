#include "image/image.h"

#include "base/file.h"
#include "base/memory.h"
#include "image/image_internal.h"
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#define FILE_BYTES_MAX ((size_t)8 << 30)

enum format {
    FORMAT_UNKNOWN,
    FORMAT_EXR,
    FORMAT_HDR,
    FORMAT_PNG,
    FORMAT_JPEG,
    FORMAT_PFM,
    FORMAT_WEBP, // this and the following formats are only read
    FORMAT_TGA,
    FORMAT_KTX2, // only recognized
};

static enum format format_of_output(const char *path)
{
    static const struct {
        const char *extension;
        enum format format;
    } formats[] = {{"exr", FORMAT_EXR},   {"png", FORMAT_PNG}, {"jpg", FORMAT_JPEG},
                   {"jpeg", FORMAT_JPEG}, {"hdr", FORMAT_HDR}, {"pfm", FORMAT_PFM}};
    for (size_t i = 0; i < sizeof formats / sizeof formats[0]; i++)
        if (path_has_extension(path, formats[i].extension))
            return formats[i].format;
    return FORMAT_UNKNOWN;
}

static bool is_webp(const uint8_t *data, size_t size)
{
    return size >= 12 && memcmp(data, "RIFF", 4) == 0 && memcmp(data + 8, "WEBP", 4) == 0;
}

// Determines the format from a file's first bytes. The name matters only for TGA, which has no
// signature.
static enum format format_of_bytes(const uint8_t *data, size_t size, const char *path)
{
    static const struct {
        const char *bytes;
        size_t size;
        enum format format;
    } signatures[] = {
        {"\x76\x2f\x31\x01", 4, FORMAT_EXR},
        {"#?RADIANCE", 10, FORMAT_HDR},
        {"#?RGBE", 6, FORMAT_HDR},
        {"\x89PNG\r\n\x1a\n", 8, FORMAT_PNG},
        {"\xff\xd8\xff", 3, FORMAT_JPEG},
        {"PF\n", 3, FORMAT_PFM},
        {"Pf\n", 3, FORMAT_PFM},
        {"\xabKTX 20\xbb", 8, FORMAT_KTX2},
    };
    for (size_t i = 0; i < sizeof signatures / sizeof signatures[0]; i++)
        if (size >= signatures[i].size &&
            memcmp(data, signatures[i].bytes, signatures[i].size) == 0)
            return signatures[i].format;
    if (is_webp(data, size))
        return FORMAT_WEBP;
#ifdef HAS_TGA
    if (path_has_extension(path, "tga") && image_is_tga(data, size))
        return FORMAT_TGA;
#else
    (void)path;
#endif
    return FORMAT_UNKNOWN;
}

// Reports a lack of memory that a library concealed: libpng omits texts with a warning, or blames
// the file. `failures` is memory_failures() before the library was called; `ok` is whether the
// library succeeded.
static bool had_memory(uint64_t failures, bool ok, const char *what, struct err *err)
{
    bool is_told = !ok && err && err->code != ERR_INPUT && err->code != ERR_OUTPUT;
    return memory_failures() == failures || is_told ? ok : err_memory(err, what, 0);
}

bool image_check_format(const char *path, struct err *err)
{
    if (format_of_output(path) != FORMAT_UNKNOWN)
        return true;
    return err_set(err, ERR_USAGE,
                   "%s: extension \"%s\" is not known; expected .exr, .png, .jpg, .hdr or .pfm",
                   path, path_extension(path));
}

bool image_is_tone_mapped(const char *path)
{
    enum format format = format_of_output(path);
    return format == FORMAT_PNG || format == FORMAT_JPEG;
}

uint64_t image_pixel_bytes(const struct image_write_params *params)
{
    switch (format_of_output(params->path)) {
    case FORMAT_EXR:
        return params->half_float ? 6 : 12;
    case FORMAT_PNG:
        return params->png_bits == 16 ? 6 : 3;
    case FORMAT_JPEG:
        return 3;
    case FORMAT_HDR:
        return 4;
    default:
        return 12;
    }
}

static _Atomic uint64_t corrupt_place;

void image_corrupt_at(uint64_t n)
{
    atomic_store(&corrupt_place, n);
}

static void corrupt_if_due(struct byte_buffer *file)
{
    uint64_t n = atomic_load(&corrupt_place);
    if (n > 0 && n <= file->size)
        file->data[n - 1] ^= 0x10;
}

// Reports that a file does not decode to the data that were encoded: an error of a library or of
// the hardware's memory.
static bool fail_verification(struct err *err)
{
    return err->code == ERR_OUTPUT
               ? err_prepend(err, "encoding failed: the decoded file differs from the data encoded")
               : err_false();
}

static bool encode_exr(const struct image_write_params *params, struct byte_buffer *out,
                       struct err *err)
{
    if (!image_exr_write(params, out, err))
        return false;
    corrupt_if_due(out);
    return image_exr_verify(params, out, err) || fail_verification(err);
}

static bool encode_codes(const struct image_write_params *params, const uint8_t *codes,
                         struct byte_buffer *out, struct err *err)
{
    if (!image_png_write(params, codes, out, err))
        return false;
    corrupt_if_due(out);
    return image_png_verify(params, codes, out, err) || fail_verification(err);
}

static bool encode_png(const struct image_write_params *params, struct byte_buffer *out,
                       struct err *err)
{
    uint8_t *codes = NULL;
    bool ok = image_display_codes(params, &codes, err) && encode_codes(params, codes, out, err);
    free(codes);
    return ok;
}

static bool encode_jpeg(const struct image_write_params *params, struct byte_buffer *out,
                        struct err *err)
{
    uint8_t *codes = NULL;
    struct image_write_params of_bytes = *params;
    of_bytes.png_bits = 8;
    bool ok =
        image_display_codes(&of_bytes, &codes, err) && image_jpeg_write(params, codes, out, err);
    if (ok)
        corrupt_if_due(out);
    ok = ok && (image_jpeg_verify(params, codes, out, err) || fail_verification(err));
    free(codes);
    return ok;
}

static bool encode_hdr(const struct image_write_params *params, struct byte_buffer *out,
                       struct err *err)
{
    uint8_t(*codes)[4] = NULL;
    bool ok = image_hdr_codes(params, &codes, err) &&
              image_hdr_write(params, (const uint8_t(*)[4])codes, out, err);
    if (ok)
        corrupt_if_due(out);
    ok = ok &&
         (image_hdr_verify(params, (const uint8_t(*)[4])codes, out, err) || fail_verification(err));
    free(codes);
    return ok;
}

static bool encode_pfm(const struct image_write_params *params, struct byte_buffer *out,
                       struct err *err)
{
    if (!image_pfm_write(params, out, err))
        return false;
    corrupt_if_due(out);
    return image_pfm_verify(params, out, err) || fail_verification(err);
}

static bool encode_format(const struct image_write_params *params, struct byte_buffer *out,
                          struct err *err)
{
    switch (format_of_output(params->path)) {
    case FORMAT_EXR:
        return encode_exr(params, out, err);
    case FORMAT_PNG:
        return encode_png(params, out, err);
    case FORMAT_JPEG:
        return encode_jpeg(params, out, err);
    case FORMAT_HDR:
        return encode_hdr(params, out, err);
    case FORMAT_PFM:
        return encode_pfm(params, out, err);
    default:
        break;
    }
    return image_check_format(params->path, err);
}

static bool encode(const struct image_write_params *params, struct byte_buffer *out,
                   struct err *err)
{
    if (params->image->width == 0 || params->image->height == 0)
        return err_set(err, ERR_BUG, "%s: the picture is %u x %u pixels; expected at least 1 x 1",
                       params->path, params->image->width, params->image->height);
    uint64_t failures = memory_failures();
    bool ok = encode_format(params, out, err);
    ok = had_memory(failures, ok, "an encoder", err);
    return ok || err_prepend(err, "%s", params->path);
}

bool image_write(const struct image_write_params *params, struct err *err)
{
    struct byte_buffer buffer = {0};
    bool ok = encode(params, &buffer, err) &&
              file_write_atomic(params->path, buffer.data, buffer.size, err);
    byte_buffer_finish(&buffer);
    return ok;
}

// Moves the encoded file into the arena if encoding succeeded, and frees the buffer.
static bool keep_file(struct byte_buffer *buffer, bool ok, struct arena *arena, uint8_t **data,
                      size_t *size, struct err *err)
{
    if (ok) {
        *size = buffer->size;
        *data = arena_alloc(arena, buffer->size, 1);
        ok = *data || err_memory(err, "a picture's file", buffer->size);
    }
    if (ok)
        memcpy(*data, buffer->data, buffer->size);
    byte_buffer_finish(buffer);
    return ok;
}

bool image_encode(const struct image_write_params *params, struct arena *arena, uint8_t **data,
                  size_t *size, struct err *err)
{
    struct byte_buffer buffer = {0};
    bool ok = encode(params, &buffer, err);
    return keep_file(&buffer, ok, arena, data, size, err);
}

bool image_encode_codes(const uint8_t *codes, uint32_t width, uint32_t height, struct arena *arena,
                        uint8_t **data, size_t *size, struct err *err)
{
    struct byte_buffer buffer = {0}, other = {0};
    const struct image shape = {.width = width, .height = height};
    struct image_write_params params = {.path = "codes.png", .image = &shape};
    uint64_t failures = memory_failures();
    bool ok = encode_codes(&params, codes, &buffer, err);
    params.unfiltered = true;
    ok = ok && encode_codes(&params, codes, &other, err);
    ok = had_memory(failures, ok, "an encoder", err);
    if (ok && other.size < buffer.size) {
        struct byte_buffer larger = buffer;
        buffer = other;
        other = larger;
    }
    byte_buffer_finish(&other);
    return keep_file(&buffer, ok, arena, data, size, err);
}

static bool decode(const struct image_source *source, struct arena *arena, struct pixels *out,
                   struct err *err)
{
    enum format format = format_of_bytes(source->data, source->size, source->path);
    if (source->layer && format != FORMAT_EXR && format != FORMAT_UNKNOWN)
        return err_set(err, ERR_INPUT, "has no layer \"%s\"; only EXR files have layers",
                       source->layer);
    switch (format) {
    case FORMAT_EXR:
        return image_exr_read(source, arena, out, err);
    case FORMAT_HDR:
        return image_hdr_read(source, arena, out, err);
    case FORMAT_PNG:
        return image_png_read(source, arena, out, err);
    case FORMAT_JPEG:
        return image_jpeg_read(source, arena, out, err);
    case FORMAT_PFM:
        return image_pfm_read(source, arena, out, err);
    case FORMAT_WEBP:
#ifdef HAS_WEBP
        return image_webp_read(source, arena, out, err);
#else
        return err_set(err, ERR_INPUT,
                       "is a WebP picture, which this build of Lampyris cannot read; expected a "
                       "build with libwebp, or the picture converted to PNG");
#endif
    case FORMAT_TGA:
#ifdef HAS_TGA
        return image_tga_read(source, arena, out, err);
#else
        break;
#endif
    case FORMAT_KTX2:
        return err_set(err, ERR_INPUT,
                       "is a KTX2 texture, which cannot be read; convert it to PNG, for example "
                       "with Khronos' program: ktx extract IN.ktx2 OUT.png");
    case FORMAT_UNKNOWN:
        break;
    }
    return err_set(err, ERR_INPUT,
                   "is not an image that can be read; expected EXR, HDR, PFM, PNG, JPEG, WebP or "
                   "TGA");
}

static bool decode_params(const struct image_read_params *params, struct image_source *source,
                          struct arena *arena, struct pixels *out, struct err *err)
{
    source->path = params->path;
    source->layer = params->layer;
    source->progress = params->progress;
    source->side_max = params->side_max;
    source->is_linear = params->is_linear;
    uint64_t failures = memory_failures();
    bool ok = decode(source, arena, out, err);
    ok = had_memory(failures, ok, "a decoder", err);
    return ok || err_prepend(err, "%s", params->path);
}

bool image_decode(const void *data, size_t size, const struct image_read_params *params,
                  struct arena *arena, struct image *out, struct err *err)
{
    struct image_source source = {.data = data, .size = size};
    struct pixels pixels = {0};
    *out = (struct image){0};
    if (!decode_params(params, &source, arena, &pixels, err))
        return false;
    *out = (struct image){pixels.width, pixels.height, pixels.values};
    return true;
}

bool image_decode_texels(const void *data, size_t size, const struct image_read_params *params,
                         struct arena *arena, struct image_texels *out, struct err *err)
{
    struct image_source source = {.data = data, .size = size, .with_alpha = true};
    struct pixels pixels = {0};
    *out = (struct image_texels){0};
    if (!decode_params(params, &source, arena, &pixels, err))
        return false;
    *out = (struct image_texels){
        .width = pixels.width,
        .height = pixels.height,
        .texels = pixels.values,
        .is_srgb = pixels.is_codes && !params->is_linear,
    };
    return !pixels.is_codes || image_code_values(out->is_srgb, arena, &out->values, err) ||
           err_prepend(err, "%s", params->path);
}

bool image_has_encoding(const void *data, size_t size, const char *path)
{
    switch (format_of_bytes(data, size, path)) {
    case FORMAT_PNG:
    case FORMAT_JPEG:
    case FORMAT_WEBP:
    case FORMAT_TGA:
        return true;
    default:
        return false;
    }
}

bool image_has_known_name(const char *path)
{
    static const char *const read_only[] = {"webp", "tga"};
    bool is_known = format_of_output(path) != FORMAT_UNKNOWN;
    for (size_t i = 0; i < sizeof read_only / sizeof *read_only; i++)
        is_known = is_known || path_has_extension(path, read_only[i]);
    return is_known;
}

bool image_reads_webp(void)
{
#ifdef HAS_WEBP
    return true;
#else
    return false;
#endif
}

bool image_read(const struct image_read_params *params, struct arena *arena, struct image *out,
                struct err *err)
{
    struct arena scratch = {0};
    struct file_bytes file;
    *out = (struct image){0};
    bool ok = file_read(&scratch, params->path, FILE_BYTES_MAX, &file, err) &&
              image_decode(file.data, file.size, params, arena, out, err);
    arena_finish(&scratch);
    return ok;
}

static bool decode_attributes_of(const struct image_source *source, struct arena *arena,
                                 struct image_attribute **out, uint32_t *count, struct err *err)
{
    switch (format_of_bytes(source->data, source->size, source->path)) {
    case FORMAT_EXR:
        return image_exr_read_attributes(source, arena, out, count, err);
    case FORMAT_PNG:
        return image_png_read_attributes(source, arena, out, count, err);
    default:
        return err_set(err, ERR_INPUT, "has no metadata that can be read; expected EXR or PNG");
    }
}

bool image_decode_attributes(const void *data, size_t size, const char *path, struct arena *arena,
                             struct image_attribute **out, uint32_t *count, struct err *err)
{
    struct image_source source = {.path = path, .data = data, .size = size};
    uint64_t failures = memory_failures();
    *out = NULL;
    *count = 0;
    bool ok = decode_attributes_of(&source, arena, out, count, err);
    ok = had_memory(failures, ok, "a decoder", err);
    return ok || err_prepend(err, "%s", path);
}

bool image_read_attributes(const char *path, struct arena *arena, struct image_attribute **out,
                           uint32_t *count, struct err *err)
{
    struct arena scratch = {0};
    struct file_bytes file;
    *out = NULL;
    *count = 0;
    bool ok = file_read(&scratch, path, FILE_BYTES_MAX, &file, err) &&
              image_decode_attributes(file.data, file.size, path, arena, out, count, err);
    arena_finish(&scratch);
    return ok;
}
