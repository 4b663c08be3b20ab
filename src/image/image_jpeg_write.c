// Writes 8-bit JPEG with libjpeg-turbo: tone-mapped and sRGB-encoded like PNG, with the metadata in
// comments. image_jpeg.c reads this format.
#include "image/image_internal.h"

#include "base/memory.h"
#include <math.h>
#include <setjmp.h>
#include <stdio.h> // jpeglib.h needs FILE and size_t
#include <stdlib.h>
#include <string.h>

#include <jpeglib.h>

// With this quality the quantisation steps are a tenth of those in the standard's tables (ITU-T
// T.81, annex K). Chroma is not subsampled, because renders have sharp edges of colour.
#define QUALITY 95
#define COMMENT_MAX 65533u // greatest number of bytes in a marker's content
#define BLOCK 8u

// Everything that must survive a longjmp is in this struct, outside the function that calls setjmp.
struct jpeg_coder {
    struct jpeg_error_mgr error; // first: the library's pointer to it is cast to this struct
    jmp_buf on_error;
    char message[JMSG_LENGTH_MAX];
    const struct image_write_params *params;
    const uint8_t *codes;
    char *comment; // all metadata, one "key=value" per line
    // The following members are used by the encoder.
    struct jpeg_compress_struct compress;
    unsigned char *data;
    unsigned long size;
    // The following members are used by the verifier.
    const struct byte_buffer *file;
    struct jpeg_decompress_struct decompress;
    uint8_t *rows;    // one row of blocks, decoded to Y, Cb, Cr
    double bounds[3]; // for each component, the greatest permitted sum of squared errors of a block
};

static void leave(j_common_ptr common)
{
    struct jpeg_coder *coder = (struct jpeg_coder *)common->err;
    common->err->format_message(common, coder->message);
    longjmp(coder->on_error, 1);
}

// A warning is an error here, because a file that was just encoded must not cause one.
static void judge_message(j_common_ptr common, int level)
{
    if (level < 0)
        leave(common);
}

static void print_nothing(j_common_ptr common)
{
    (void)common;
}

static void fail(struct jpeg_coder *coder, const char *message)
{
    snprintf(coder->message, sizeof coder->message, "%s", message);
    longjmp(coder->on_error, 1);
}

static bool prepare(struct jpeg_coder *coder, struct err *err)
{
    const struct image_write_params *params = coder->params;
    jpeg_std_error(&coder->error);
    coder->error.error_exit = leave;
    coder->error.emit_message = judge_message;
    coder->error.output_message = print_nothing;
    coder->compress.err = coder->decompress.err = &coder->error;
    size_t length = 1;
    for (uint32_t i = 0; i < params->attribute_count; i++)
        length += strlen(params->attributes[i].key) + strlen(params->attributes[i].value) + 2;
    coder->comment = malloc(length);
    if (!coder->comment)
        return err_memory(err, "a JPEG file's comment", length);
    size_t at = 0;
    coder->comment[0] = '\0';
    for (uint32_t i = 0; i < params->attribute_count; i++)
        at += (size_t)snprintf(coder->comment + at, length - at, "%s=%s\n",
                               params->attributes[i].key, params->attributes[i].value);
    if (params->image->width > JPEG_MAX_DIMENSION || params->image->height > JPEG_MAX_DIMENSION)
        return err_set(err, ERR_OUTPUT,
                       "the picture is %u x %u pixels; JPEG holds at most %ld on a side",
                       params->image->width, params->image->height, (long)JPEG_MAX_DIMENSION);
    return true;
}

// --- encoding ------------------------------------------------------------------------------------

// Runs libjpeg; returns false after an error that came by longjmp.
static bool encode(struct jpeg_coder *coder)
{
    struct jpeg_compress_struct *compress = &coder->compress;
    const struct image *image = coder->params->image;
    if (setjmp(coder->on_error))
        return false;
    jpeg_create_compress(compress);
    jpeg_mem_dest(compress, &coder->data, &coder->size);
    compress->image_width = image->width;
    compress->image_height = image->height;
    compress->input_components = 3;
    compress->in_color_space = JCS_RGB;
    jpeg_set_defaults(compress);
    jpeg_set_quality(compress, QUALITY, TRUE);
    for (int c = 0; c < compress->num_components; c++)
        compress->comp_info[c].h_samp_factor = compress->comp_info[c].v_samp_factor = 1;
    compress->dct_method = JDCT_ISLOW;
    compress->optimize_coding = TRUE;
    jpeg_start_compress(compress, TRUE);
    for (size_t at = 0, length = strlen(coder->comment); at < length; at += COMMENT_MAX) {
        size_t part = length - at < COMMENT_MAX ? length - at : COMMENT_MAX;
        jpeg_write_marker(compress, JPEG_COM, (const JOCTET *)coder->comment + at, (unsigned)part);
    }
    for (uint32_t y = 0; y < image->height; y++) {
        JSAMPROW row = (JSAMPROW)(uintptr_t)(coder->codes + 3 * (size_t)y * image->width);
        jpeg_write_scanlines(compress, &row, 1);
    }
    jpeg_finish_compress(compress);
    return true;
}

bool image_jpeg_write(const struct image_write_params *params, const uint8_t *codes,
                      struct byte_buffer *out, struct err *err)
{
    struct jpeg_coder coder = {.params = params, .codes = codes};
    bool ok = prepare(&coder, err);
    if (ok && !encode(&coder))
        ok = err_set(err, ERR_OUTPUT, "JPEG: %s", coder.message);
    if (ok && !byte_buffer_write(out, 0, coder.data, coder.size))
        ok = err_memory(err, "the JPEG", coder.size);
    jpeg_destroy_compress(&coder.compress);
    free(coder.data);
    free(coder.comment);
    return ok;
}

// --- verifying -----------------------------------------------------------------------------------

// The transform of a block is orthonormal, so the sum of squared errors of its 64 values equals
// that of its coefficients. Each coefficient is off by at most half a quantisation step. Clamping
// to 0..255 can only reduce the error. The integer transforms and colour conversions, in both
// directions, round each value by at most 2 in total (Loeffler, Ligtenberg and Moschytz 1989;
// libjpeg's jdct.h).
static void bound_errors(struct jpeg_coder *coder)
{
    const double rounding = 2.0 * BLOCK; // the norm of 64 values, each of which is 2
    for (int c = 0; c < 3; c++) {
        const JQUANT_TBL *table = coder->decompress.comp_info[c].quant_table;
        double sum = 0.0;
        for (int i = 0; table && i < DCTSIZE2; i++)
            sum += 0.25 * table->quantval[i] * table->quantval[i];
        coder->bounds[c] = pow(sqrt(sum) + rounding, 2.0);
    }
}

// Returns Y, Cb or Cr of a pixel (ITU-T T.871, section 7).
static double component_of(const uint8_t *rgb, int component)
{
    switch (component) {
    case 0:
        return 0.299 * rgb[0] + 0.587 * rgb[1] + 0.114 * rgb[2];
    case 1:
        return -0.168735892 * rgb[0] - 0.331264108 * rgb[1] + 0.5 * rgb[2] + 128.0;
    default:
        return 0.5 * rgb[0] - 0.418687589 * rgb[1] - 0.081312411 * rgb[2] + 128.0;
    }
}

static void check_block(struct jpeg_coder *coder, uint32_t x, uint32_t y, uint32_t height)
{
    const uint32_t width = coder->params->image->width;
    const uint32_t columns = width - x < BLOCK ? width - x : BLOCK;
    for (int c = 0; c < 3; c++) {
        double sum = 0.0;
        for (uint32_t j = 0; j < height; j++)
            for (uint32_t i = x; i < x + columns; i++) {
                const uint8_t *rgb = coder->codes + 3 * ((size_t)(y + j) * width + i);
                double read = coder->rows[3 * ((size_t)j * width + i) + (size_t)c];
                sum += pow(read - component_of(rgb, c), 2.0);
            }
        if (!(sum <= coder->bounds[c]))
            fail(coder, "the pixels are not what was written");
    }
}

static void check_comments(struct jpeg_coder *coder)
{
    const char *expected = coder->comment;
    for (jpeg_saved_marker_ptr marker = coder->decompress.marker_list; marker;
         marker = marker->next) {
        if (strlen(expected) < marker->data_length ||
            memcmp(expected, marker->data, marker->data_length) != 0)
            break;
        expected += marker->data_length;
    }
    if (*expected)
        fail(coder, "the metadata is not what was written");
}

// Runs libjpeg; returns false after an error that came by longjmp.
static bool verify(struct jpeg_coder *coder)
{
    struct jpeg_decompress_struct *decompress = &coder->decompress;
    const struct image *image = coder->params->image;
    if (setjmp(coder->on_error))
        return false;
    jpeg_create_decompress(decompress);
    jpeg_mem_src(decompress, coder->file->data, (unsigned long)coder->file->size);
    jpeg_save_markers(decompress, JPEG_COM, 0xffff);
    jpeg_read_header(decompress, TRUE);
    decompress->out_color_space = JCS_YCbCr;
    decompress->dct_method = JDCT_ISLOW;
    if (decompress->image_width != image->width || decompress->image_height != image->height ||
        decompress->num_components != 3)
        fail(coder, "the header is not what was written");
    check_comments(coder);
    jpeg_start_decompress(decompress);
    bound_errors(coder);
    for (uint32_t y = 0; y < image->height; y += BLOCK) {
        uint32_t height = image->height - y < BLOCK ? image->height - y : BLOCK;
        for (uint32_t j = 0; j < height; j++) {
            JSAMPROW row = coder->rows + 3 * (size_t)j * image->width;
            jpeg_read_scanlines(decompress, &row, 1);
        }
        for (uint32_t x = 0; x < image->width; x += BLOCK)
            check_block(coder, x, y, height);
    }
    jpeg_finish_decompress(decompress);
    return true;
}

// Decoding cannot distinguish a small change of a coefficient from the quantisation error. Encoding
// a second time detects it.
static bool verify_bytes(const struct image_write_params *params, const uint8_t *codes,
                         const struct byte_buffer *file, struct err *err)
{
    struct byte_buffer again = {0};
    bool ok = image_jpeg_write(params, codes, &again, err);
    ok = ok &&
         ((again.size == file->size && memcmp(again.data, file->data, again.size) == 0) ||
          err_set(err, ERR_OUTPUT, "JPEG: encoding the picture twice gave two different files"));
    byte_buffer_finish(&again);
    return ok;
}

bool image_jpeg_verify(const struct image_write_params *params, const uint8_t *codes,
                       const struct byte_buffer *file, struct err *err)
{
    if (!verify_bytes(params, codes, file, err))
        return false;
    struct jpeg_coder coder = {.params = params, .codes = codes, .file = file};
    const size_t bytes = 3 * (size_t)BLOCK * params->image->width;
    bool ok = prepare(&coder, err);
    coder.rows = ok ? malloc(bytes) : NULL;
    if (ok && !coder.rows)
        ok = err_memory(err, "the JPEG reader", bytes);
    else if (ok && !verify(&coder))
        ok = err_set(err, ERR_OUTPUT, "JPEG: %s", coder.message);
    jpeg_destroy_decompress(&coder.decompress);
    free(coder.rows);
    free(coder.comment);
    return ok;
}
