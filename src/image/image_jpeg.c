// Reads JPEG with libjpeg-turbo: grey or colour, 8 bits, baseline or progressive.
#include "image/image_internal.h"

#include "base/memory.h"
#include <setjmp.h>
#include <stdio.h> // jpeglib.h needs FILE and size_t
#include <stdlib.h>
#include <string.h>

#include <jerror.h>
#include <jpeglib.h>

// The maximum number of scans. A progressive file may repeat scans over the whole image without
// limit, each a few bytes long. The standard's progression for three components needs ten; ten
// times that is more than real images have.
enum { SCANS_MAX = 100 };

// Everything that must survive a longjmp is in this struct, outside the function that calls setjmp.
struct jpeg_reader {
    struct jpeg_error_mgr error; // first: the library's pointer to it is cast to this struct
    struct jpeg_progress_mgr progress;
    jmp_buf on_error;
    char message[JMSG_LENGTH_MAX];
    enum err_code code;
    struct jpeg_decompress_struct decompress;
    const struct image_source *source;
    struct arena *arena;
    struct pixels *out;
    struct err *err;
    bool reported;          // err has been filled in
    uint64_t library_bytes; // taken from the budget on behalf of the library
    JSAMPROW row;
};

static void leave(j_common_ptr common)
{
    struct jpeg_reader *reader = (struct jpeg_reader *)common->err;
    common->err->format_message(common, reader->message);
    reader->code = common->err->msg_code == JERR_OUT_OF_MEMORY ? ERR_SYSTEM : ERR_INPUT;
    longjmp(reader->on_error, 1);
}

// Decides whether a message of the library is an error. Level -1 is a warning. The library then
// continues with invented pixels, so warnings are errors here, except those about bytes between
// segments and about JFIF, Adobe and ICC markers, which do not affect the image.
static void judge_message(j_common_ptr common, int level)
{
    int code = common->err->msg_code;
    bool harmless = code == JWRN_EXTRANEOUS_DATA || code == JWRN_ADOBE_XFORM ||
                    code == JWRN_JFIF_MAJOR || code == JWRN_BOGUS_ICC;
    if (level < 0 && !harmless)
        leave(common);
}

static void print_nothing(j_common_ptr common)
{
    (void)common;
}

// Limits the number of scans, and polls for a stop. The library calls this for each row of blocks.
static void limit_work(j_common_ptr common)
{
    struct jpeg_reader *reader = (struct jpeg_reader *)common->err;
    if (progress_should_stop(reader->source->progress)) {
        snprintf(reader->message, sizeof reader->message, "stopped while decoding");
        reader->code = ERR_STOPPED;
        longjmp(reader->on_error, 1);
    }
    if (reader->decompress.input_scan_number <= SCANS_MAX)
        return;
    snprintf(reader->message, sizeof reader->message, "more than %d scans", SCANS_MAX);
    reader->code = ERR_INPUT;
    longjmp(reader->on_error, 1);
}

static bool allocate(struct jpeg_reader *reader)
{
    const struct jpeg_decompress_struct *decompress = &reader->decompress;
    uint64_t width = decompress->image_width, height = decompress->image_height;
    // The coefficients of a progressive image are all stored, two bytes each, padded to blocks of
    // 16 pixels; subsampled components take less.
    uint64_t padded = (width + 15) / 16 * 16 * ((height + 15) / 16 * 16);
    uint64_t extra = padded * 2 * (uint64_t)decompress->num_components + width * 3;
    const struct pixels_size size = {width, height, BITS_IN_JSAMPLE, extra};
    if (!pixels_allocate(reader->source, &size, reader->arena, reader->out, reader->err))
        return false;
    if (!memory_take(extra))
        return err_memory(reader->err, "a JPEG file's coefficients", extra);
    reader->library_bytes = extra;
    reader->row = malloc((size_t)width * 3);
    return reader->row ? true : err_memory(reader->err, "a line", width * 3);
}

static void decode_row(struct jpeg_reader *reader, const struct code_table *table)
{
    uint64_t row = reader->decompress.output_scanline;
    jpeg_read_scanlines(&reader->decompress, &reader->row, 1);
    pixels_put_codes(reader->out, row, reader->row, 3, table);
}

// Runs the library. Returns false after an error that came by longjmp or is in reader->err.
static bool run(struct jpeg_reader *reader, const struct code_table *table)
{
    struct jpeg_decompress_struct *decompress = &reader->decompress;
    if (setjmp(reader->on_error))
        return false;
    jpeg_create_decompress(decompress);
    decompress->progress = &reader->progress;
    // If unsigned long is shorter than size_t, a longer file counts as truncated.
    jpeg_mem_src(decompress, reader->source->data, (unsigned long)reader->source->size);
    jpeg_read_header(decompress, TRUE);
    decompress->out_color_space = JCS_RGB; // converts grey, too; CMYK is an error
    if (!allocate(reader)) {
        reader->reported = true;
        return false;
    }
    jpeg_start_decompress(decompress);
    while (decompress->output_scanline < decompress->output_height)
        decode_row(reader, table);
    jpeg_finish_decompress(decompress);
    return true;
}

bool image_jpeg_read(const struct image_source *source, struct arena *arena, struct pixels *out,
                     struct err *err)
{
    struct jpeg_reader reader = {
        .source = source, .arena = arena, .out = out, .err = err, .code = ERR_INPUT};
    reader.decompress.err = jpeg_std_error(&reader.error);
    reader.error.error_exit = leave;
    reader.error.emit_message = judge_message;
    reader.error.output_message = print_nothing;
    reader.progress.progress_monitor = limit_work;
    struct code_table table;
    code_table_fill(source->is_linear, &table);
    bool ok = run(&reader, &table);
    jpeg_destroy_decompress(&reader.decompress);
    memory_give(reader.library_bytes);
    free(reader.row);
    if (!ok && !reader.reported)
        err_set(err, reader.code, "JPEG: %s", reader.message);
    return ok;
}
