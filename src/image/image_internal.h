// Declarations that the files of this module share. Each format has a reader, a writer, and a
// function that verifies written files. They work in memory, so that decoders never access files,
// and a file is only replaced by an image that has been decoded again and compared with the
// original.
#ifndef LAMPYRIS_IMAGE_IMAGE_INTERNAL_H
#define LAMPYRIS_IMAGE_IMAGE_INTERNAL_H

#include "image/image.h"
#include <stddef.h>

// --- byte_buffer.c ------------------------------------------------------------------------------
// A buffer that grows as it is written to. {0} is a valid, empty buffer.
struct byte_buffer {
    uint8_t *data;
    size_t size, capacity;
};

// Writes at `offset`, overwriting existing bytes. Writing beyond the end makes the buffer grow, and
// a gap before the offset is filled with zeros (EXR's table of offsets is written last). Returns
// false when out of memory.
bool byte_buffer_write(struct byte_buffer *buffer, size_t offset, const void *data, size_t size);
void byte_buffer_finish(struct byte_buffer *buffer);

// --- pixels.c -----------------------------------------------------------------------------------
// An encoded image in memory, and the parameters for decoding it.
struct image_source {
    const char *path; // names the image in messages
    const uint8_t *data;
    size_t size;
    const char *layer; // EXR: layer to read; NULL: the channels without a layer
    uint32_t side_max; // maximum side; 0: no limit
    bool is_linear;    // codes are linear, not sRGB-encoded
    bool with_alpha;   // RGBA, in 8-bit codes if the file has no more; else RGB in floats
    const struct progress *progress;
};

// Decoded pixels: RGB or RGBA.
struct pixels {
    uint32_t width, height;
    unsigned components;
    bool is_codes; // 8-bit codes, else floats
    void *values;
};

struct pixels_size {
    uint64_t width, height;
    unsigned bits;        // bits per component in the file; up to 8 fit into codes
    uint64_t extra_bytes; // bytes that the decoder needs in addition to the pixels
};

// Checks the sides, and the budget for the pixels and the decoder's bytes; then allocates the
// pixels in the arena.
bool pixels_allocate(const struct image_source *source, const struct pixels_size *size,
                     struct arena *arena, struct pixels *out, struct err *err);

// Must be called once per row. Polls for a stop from time to time. Fails with ERR_STOPPED if
// progress requests a stop.
bool pixels_go_on(const struct image_source *source, uint64_t row, uint64_t width, struct err *err);

// The linear value of each 8-bit code of a colour.
struct code_table {
    float values[256];
};
void code_table_fill(bool is_linear, struct code_table *table);
// Stores a row of codes with `components` per pixel: as codes, with an alpha of 255 if it is
// missing, or as floats without alpha.
void pixels_put_codes(const struct pixels *out, uint64_t row, const uint8_t *codes,
                      unsigned components, const struct code_table *table);

// Returns the components of the pixel with this index. The pixels must be floats.
static inline float *pixels_at(const struct pixels *pixels, uint64_t index)
{
    return (float *)pixels->values + index * pixels->components;
}

// --- one file a format --------------------------------------------------------------------------
bool image_exr_read(const struct image_source *source, struct arena *arena, struct pixels *out,
                    struct err *err);
bool image_exr_read_attributes(const struct image_source *source, struct arena *arena,
                               struct image_attribute **out, uint32_t *count, struct err *err);
bool image_exr_write(const struct image_write_params *params, struct byte_buffer *out,
                     struct err *err);
// Decodes an encoded file and compares it, bit for bit, with the input: pixels, layers and
// metadata. Fails with ERR_OUTPUT, naming the first difference.
bool image_exr_verify(const struct image_write_params *params, const struct byte_buffer *file,
                      struct err *err);

bool image_hdr_read(const struct image_source *source, struct arena *arena, struct pixels *out,
                    struct err *err);

// Computes the RGBE codes of the pixels, row 0 at the top. Logs a warning if RGBE cannot hold some
// of the values. The caller frees the codes.
bool image_hdr_codes(const struct image_write_params *params, uint8_t (**codes)[4],
                     struct err *err);
bool image_hdr_write(const struct image_write_params *params, const uint8_t (*codes)[4],
                     struct byte_buffer *out, struct err *err);
bool image_hdr_verify(const struct image_write_params *params, const uint8_t (*codes)[4],
                      const struct byte_buffer *file, struct err *err);

bool image_pfm_read(const struct image_source *source, struct arena *arena, struct pixels *out,
                    struct err *err);
bool image_pfm_write(const struct image_write_params *params, struct byte_buffer *out,
                     struct err *err);
bool image_pfm_verify(const struct image_write_params *params, const struct byte_buffer *file,
                      struct err *err);

bool image_jpeg_read(const struct image_source *source, struct arena *arena, struct pixels *out,
                     struct err *err);
bool image_jpeg_write(const struct image_write_params *params, const uint8_t *codes,
                      struct byte_buffer *out, struct err *err);
// Returns whether the file decodes to the codes as closely as its quantisation allows, block by
// block, and to the metadata.
bool image_jpeg_verify(const struct image_write_params *params, const uint8_t *codes,
                       const struct byte_buffer *file, struct err *err);

bool image_webp_read(const struct image_source *source, struct arena *arena, struct pixels *out,
                     struct err *err);

// Returns whether the bytes can be a TGA file. The format has no signature.
bool image_is_tga(const uint8_t *data, size_t size);
bool image_tga_read(const struct image_source *source, struct arena *arena, struct pixels *out,
                    struct err *err);

bool image_png_read(const struct image_source *source, struct arena *arena, struct pixels *out,
                    struct err *err);
bool image_png_read_attributes(const struct image_source *source, struct arena *arena,
                               struct image_attribute **out, uint32_t *count, struct err *err);
// Computes the RGB codes of the pixels for PNG and JPEG, row 0 at the top: one byte per value, or
// with 16 bits two bytes, the high byte first, as PNG requires. The caller frees the codes.
bool image_display_codes(const struct image_write_params *params, uint8_t **codes, struct err *err);
bool image_png_write(const struct image_write_params *params, const uint8_t *codes,
                     struct byte_buffer *out, struct err *err);
bool image_png_verify(const struct image_write_params *params, const uint8_t *codes,
                      const struct byte_buffer *file, struct err *err);

#endif
