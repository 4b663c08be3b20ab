// Channels of the EXR file for an image with its layers, for writing and verifying.
#ifndef LAMPYRIS_IMAGE_IMAGE_EXR_CHANNEL_H
#define LAMPYRIS_IMAGE_IMAGE_EXR_CHANNEL_H

#include "image/image.h"
#include <openexr.h>
#include <string.h>

// The maximum length of a channel's or attribute's name ("OpenEXR File Layout", long names).
#define EXR_NAME_MAX_BYTES 255

struct exr_channel {
    char name[EXR_NAME_MAX_BYTES + 1]; // truncated if it is longer
    bool is_name_too_long;
    exr_pixel_type_t type;
    const char *values; // value of the first pixel; each value has 32 bits
    size_t stride;      // bytes from pixel to pixel
};

// Gets the channel with this index; those of the image itself come first. Returns false if there
// are fewer channels.
bool exr_channel_at(const struct image_write_params *params, uint32_t index,
                    struct exr_channel *out);
bool exr_channel_find(const struct image_write_params *params, const char *name,
                      struct exr_channel *out);

static inline exr_compression_t exr_compression_of(const struct image_write_params *params)
{
    return params->uncompressed ? EXR_COMPRESSION_NONE : EXR_COMPRESSION_ZIP;
}

// The windows of "OpenEXR Technical Introduction": the image is the data window. Both ends are
// included.
struct exr_windows {
    exr_attr_box2i_t display, data;
};

static inline struct exr_windows exr_windows_of(const struct image_write_params *params)
{
    const struct image_display *display = &params->display;
    const struct image *image = params->image;
    const bool is_window = display->width > 0;
    const int32_t x = (int32_t)display->x, y = (int32_t)display->y;
    struct exr_windows windows = {0};
    windows.display.max.x = (int32_t)(is_window ? display->width : image->width) - 1;
    windows.display.max.y = (int32_t)(is_window ? display->height : image->height) - 1;
    windows.data.min.x = x;
    windows.data.min.y = y;
    windows.data.max.x = x + (int32_t)image->width - 1;
    windows.data.max.y = y + (int32_t)image->height - 1;
    return windows;
}

// Returns a pixel's bits as stored in the file; a half is in the lower 16 bits.
static inline uint32_t exr_channel_bits(const struct exr_channel *channel, size_t pixel)
{
    uint32_t bits;
    memcpy(&bits, channel->values + pixel * channel->stride, sizeof bits);
    if (channel->type != EXR_PIXEL_HALF)
        return bits;
    float value;
    memcpy(&value, &bits, sizeof value);
    return half_from_float(value);
}

#endif
