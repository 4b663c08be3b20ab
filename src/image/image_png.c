#include "image/image_png.h"

#include "base/memory.h"
#include <stdio.h>

void png_keep_error(png_structp png, png_const_charp message)
{
    struct png_failure *failure = png_get_error_ptr(png);
    snprintf(failure->message, sizeof failure->message, "%s", message);
    png_longjmp(png, 1);
}

void *png_take_memory(png_structp png, png_alloc_size_t bytes)
{
    (void)png;
    return memory_alloc(bytes);
}

void png_give_memory(png_structp png, void *data)
{
    (void)png;
    memory_free(data);
}

void png_drop_warning(png_structp png, png_const_charp message)
{
    (void)png;
    (void)message;
}
