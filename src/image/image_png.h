// Memory and error handling (by longjmp) for reading and writing PNG with libpng.
#ifndef LAMPYRIS_IMAGE_IMAGE_PNG_H
#define LAMPYRIS_IMAGE_IMAGE_PNG_H

#include "image/image_internal.h"
#include <png.h>

// For the file that is written: the number of bits per value, and of bytes per pixel.
#define IMAGE_PNG_BITS(params) ((params)->png_bits == 16 ? 16 : 8)
#define IMAGE_PNG_PIXEL_BYTES(params) (3u * IMAGE_PNG_BITS(params) / 8u)

// The error pointer of a png_struct.
struct png_failure {
    char message[256];
    bool out_of_memory;
};

// Callbacks for png_create_*_struct. The message of an error is stored before the jump; a warning
// is dropped. (libpng would print both.)
void png_keep_error(png_structp png, png_const_charp message) __attribute__((noreturn));
void png_drop_warning(png_structp png, png_const_charp message);
// Callbacks that take libpng's memory from the budget of the process.
void *png_take_memory(png_structp png, png_alloc_size_t bytes);
void png_give_memory(png_structp png, void *data);

#endif
