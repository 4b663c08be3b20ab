// Memory for decoded pixels.
#include "image/image_internal.h"

#include "base/memory.h"
#include <stdio.h>

bool pixels_allocate(const struct image_source *source, const struct pixels_size *size,
                     struct arena *arena, struct pixels *out, struct err *err)
{
    uint64_t width = size->width, height = size->height, bytes;
    bool is_codes = source->with_alpha && size->bits <= 8;
    unsigned components = source->with_alpha ? 4 : 3;
    size_t pixel_bytes = components * (is_codes ? sizeof(uint8_t) : sizeof(float));
    if (width == 0 || height == 0)
        return err_set(err, ERR_INPUT, "the picture is %llu x %llu pixels; expected at least 1 x 1",
                       (unsigned long long)width, (unsigned long long)height);
    if (source->side_max && (width > source->side_max || height > source->side_max))
        return err_set(err, ERR_INPUT,
                       "the picture is %llu x %llu pixels; expected at most %u on a side",
                       (unsigned long long)width, (unsigned long long)height, source->side_max);
    if (width > UINT32_MAX || height > UINT32_MAX ||
        __builtin_mul_overflow(width * height, pixel_bytes, &bytes) ||
        __builtin_add_overflow(bytes, size->extra_bytes, &bytes) || bytes > SIZE_MAX / 2)
        return err_set(err, ERR_INPUT,
                       "the picture is %llu x %llu pixels, which is more than any memory holds",
                       (unsigned long long)width, (unsigned long long)height);
    char what[64];
    snprintf(what, sizeof what, "a picture of %llu x %llu pixels", (unsigned long long)width,
             (unsigned long long)height);
    if (!memory_check(bytes, what, err))
        return false;
    *out = (struct pixels){
        .width = (uint32_t)width,
        .height = (uint32_t)height,
        .components = components,
        .is_codes = is_codes,
        .values = arena_alloc(arena, (size_t)(width * height), pixel_bytes),
    };
    return out->values ? true : err_memory(err, what, bytes);
}

bool pixels_go_on(const struct image_source *source, uint64_t row, uint64_t width, struct err *err)
{
    const uint64_t pixels = 1u << 20; // number between two polls, about 10 ms
    uint64_t rows = width > 0 && width < pixels ? pixels / width : 1;
    return row % rows != 0 || !progress_should_stop(source->progress) ||
           err_set(err, ERR_STOPPED, "stopped while decoding");
}

void code_table_fill(bool is_linear, struct code_table *table)
{
    for (int i = 0; i < 256; i++) {
        float value = (float)i / 255.0f;
        table->values[i] = is_linear ? value : image_srgb_to_linear(value);
    }
}

static float round_to_half(float value)
{
    return float_from_half(half_from_float(value));
}

bool image_code_values(bool is_srgb, struct arena *arena, float (**out)[4], struct err *err)
{
    struct code_table table;
    *out = arena_alloc(arena, 256, sizeof **out);
    if (!*out)
        return err_memory(err, "the values of codes", 256 * sizeof **out);
    code_table_fill(!is_srgb, &table);
    for (int i = 0; i < 256; i++) {
        for (int c = 0; c < 3; c++)
            (*out)[i][c] = round_to_half(table.values[i]);
        (*out)[i][3] = round_to_half((float)i / 255.0f);
    }
    return true;
}

void pixels_put_codes(const struct pixels *out, uint64_t row, const uint8_t *codes,
                      unsigned components, const struct code_table *table)
{
    uint64_t at = row * out->width * out->components;
    for (uint64_t x = 0; x < out->width; x++)
        for (unsigned c = 0; c < out->components; c++, at++) {
            uint8_t code = c < components ? codes[x * components + c] : 255;
            if (out->is_codes)
                ((uint8_t *)out->values)[at] = code;
            else
                ((float *)out->values)[at] = table->values[code];
        }
}
