// What the files of this module share. One reader and one writer a format, all of them from and to
// memory: so a decoder never touches a file, and a file is only replaced by a finished picture.
#ifndef LAMPYRIS_IMAGE_IMAGE_INTERNAL_H
#define LAMPYRIS_IMAGE_IMAGE_INTERNAL_H

#include "image.h"
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

// --- image.c ------------------------------------------------------------------------------------
// An encoded picture in memory, and what may be spent on decoding it.
struct image_source {
    const char *path; // for messages
    const uint8_t *data;
    size_t size;
    const char *layer; // EXR; NULL: the plain channels
    size_t max_bytes;  // for pixels and whatever the decoder holds beside them
};

// Checks width * height pixels and `extra_bytes` of the decoder's own against the budget, then
// allocates the pixels in the arena.
bool image_allocate(const struct image_source *source, uint64_t width, uint64_t height,
                    uint64_t extra_bytes, struct arena *arena, struct image *out, struct err *err);

// --- one file a format --------------------------------------------------------------------------
bool image_exr_read(const struct image_source *source, struct arena *arena, struct image *out,
                    struct err *err);
bool image_exr_read_attributes(const struct image_source *source, struct arena *arena,
                               struct image_attribute **out, uint32_t *count, struct err *err);
bool image_exr_write(const struct image_write_params *params, struct byte_buffer *out,
                     struct err *err);

bool image_hdr_read(const struct image_source *source, struct arena *arena, struct image *out,
                    struct err *err);

bool image_jpeg_read(const struct image_source *source, struct arena *arena, struct image *out,
                     struct err *err);

bool image_png_read(const struct image_source *source, struct arena *arena, struct image *out,
                    struct err *err);
bool image_png_read_attributes(const struct image_source *source, struct arena *arena,
                               struct image_attribute **out, uint32_t *count, struct err *err);
bool image_png_write(const struct image_write_params *params, struct byte_buffer *out,
                     struct err *err);

// --- half.c -------------------------------------------------------------------------------------
#define HALF_MAX 65504.0f // (2 - 2^-10) 2^15, the greatest finite half

// IEEE 754 binary16, rounded to nearest, ties to even. Finite values past HALF_MAX saturate;
// infinities and NaN stay what they are.
uint16_t half_from_float(float value);
float float_from_half(uint16_t half); // exact

#endif
