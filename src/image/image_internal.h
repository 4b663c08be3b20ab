// Declarations that the files of this module share. Each format has one reader and one writer,
// which work in memory: so a decoder never touches a file, and a file is only replaced by an image
// that has been decoded again and compared with the original.
#ifndef LAMPYRIS_IMAGE_IMAGE_INTERNAL_H
#define LAMPYRIS_IMAGE_IMAGE_INTERNAL_H

#include "image/image.h"
#include <stddef.h>

// --- byte_buffer.c ------------------------------------------------------------------------------
// Grows as it is written to. {0} is a valid, empty buffer.
struct byte_buffer {
    uint8_t *data;
    size_t size, capacity;
};

// Writes at `offset`, over what is there; what lies beyond the end grows the buffer, and a gap
// before the offset is filled with zeros (EXR's table of offsets is written last). False when out
// of memory.
bool byte_buffer_write(struct byte_buffer *buffer, size_t offset, const void *data, size_t size);
void byte_buffer_finish(struct byte_buffer *buffer);

// --- pixels.c -----------------------------------------------------------------------------------
// An encoded picture in memory, what is wanted of it and what may be spent on decoding it.
struct image_source {
    const char *path; // for messages
    const uint8_t *data;
    size_t size;
    const char *layer; // EXR; NULL: the plain channels
    uint32_t side_max; // 0: any
    bool is_linear;    // codes of PNG and JPEG are not sRGB
    bool with_alpha;   // RGBA, in halves where they will do; else RGB in floats
    const struct progress *progress;
};

// Pixels as decoded: RGB or RGBA.
struct pixels {
    uint32_t width, height;
    unsigned components;
    bool is_half; // else float
    void *values;
};

struct pixels_size {
    uint64_t width, height;
    unsigned bits;        // a component in the file: up to 8 fit into halves
    uint64_t extra_bytes; // bytes that the decoder needs in addition to the pixels
};

// Checks the sides and, with the decoder's own bytes, the budget, then allocates in the arena.
bool pixels_allocate(const struct image_source *source, const struct pixels_size *size,
                     struct arena *arena, struct pixels *out, struct err *err);

// Called once per row: fails with ERR_STOPPED when the work is to stop. Polls only now and then.
bool pixels_go_on(const struct image_source *source, uint64_t row, uint64_t width, struct err *err);

// The values of 8-bit codes: [0] for colours, [1] for alpha.
struct code_table {
    float values[2][256];
    uint16_t halves[2][256];
};
void code_table_fill(const struct image_source *source, struct code_table *table);
// Stores a row of codes, `components` per pixel; alpha is 1 if it is missing.
void pixels_put_codes(const struct pixels *out, uint64_t row, const uint8_t *codes,
                      unsigned components, const struct code_table *table);

// Returns the components of pixel number `index` of float pixels.
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
// Returns whether decoding the file gives what was to be in it, bit for bit: pixels, layers,
// metadata; ERR_OUTPUT naming the first difference.
bool image_exr_verify(const struct image_write_params *params, const struct byte_buffer *file,
                      struct err *err);

bool image_hdr_read(const struct image_source *source, struct arena *arena, struct pixels *out,
                    struct err *err);

// Computes the RGBE codes of the pixels, row 0 at the top, and warns of pixels that they cannot
// hold. The caller frees them.
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

bool image_png_read(const struct image_source *source, struct arena *arena, struct pixels *out,
                    struct err *err);
bool image_png_read_attributes(const struct image_source *source, struct arena *arena,
                               struct image_attribute **out, uint32_t *count, struct err *err);
// Computes the codes of the pixels, RGB, row 0 at the top, for PNG and JPEG: bytes, or with 16 bits
// two bytes each, the high one first, as PNG has them. The caller frees them.
bool image_display_codes(const struct image_write_params *params, uint8_t **codes, struct err *err);
bool image_png_write(const struct image_write_params *params, const uint8_t *codes,
                     struct byte_buffer *out, struct err *err);
bool image_png_verify(const struct image_write_params *params, const uint8_t *codes,
                      const struct byte_buffer *file, struct err *err);

#endif
