#include "image/image_internal.h"

#include <stdlib.h>
#include <string.h>

static bool byte_buffer_reserve(struct byte_buffer *buffer, size_t size)
{
    if (size <= buffer->capacity)
        return true;
    size_t grown = buffer->capacity < SIZE_MAX / 2 ? buffer->capacity * 2 : SIZE_MAX;
    size_t capacity = size > grown ? size : grown;
    uint8_t *data = realloc(buffer->data, capacity);
    if (!data)
        return false;
    buffer->data = data;
    buffer->capacity = capacity;
    return true;
}

bool byte_buffer_write(struct byte_buffer *buffer, size_t offset, const void *data, size_t size)
{
    size_t end;
    if (__builtin_add_overflow(offset, size, &end) || !byte_buffer_reserve(buffer, end))
        return false;
    if (size == 0)
        return true;
    if (offset > buffer->size)
        memset(buffer->data + buffer->size, 0, offset - buffer->size);
    memcpy(buffer->data + offset, data, size);
    if (end > buffer->size)
        buffer->size = end;
    return true;
}

void byte_buffer_finish(struct byte_buffer *buffer)
{
    if (!buffer)
        return;
    free(buffer->data);
    *buffer = (struct byte_buffer){0};
}
