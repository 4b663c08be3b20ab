// The channels of an EXR file that a picture with its layers becomes, for those who write and
// verify it.
#ifndef LAMPYRIS_IMAGE_IMAGE_EXR_CHANNEL_H
#define LAMPYRIS_IMAGE_IMAGE_EXR_CHANNEL_H

#include "image/image.h"
#include <openexr.h>
#include <string.h>

#define EXR_NAME_MAX_BYTES 255 // of a channel or attribute ("OpenEXR File Layout", long names)

struct exr_channel {
    char name[EXR_NAME_MAX_BYTES + 1]; // cut off where it would be longer
    bool is_name_too_long;
    exr_pixel_type_t type;
    const char *values; // of the first pixel, 32 bits each
    size_t stride;      // from pixel to pixel, bytes
};

// The channel of that number, those of the plain picture first; false when there are fewer.
bool exr_channel_at(const struct image_write_params *params, uint32_t index,
                    struct exr_channel *out);
bool exr_channel_find(const struct image_write_params *params, const char *name,
                      struct exr_channel *out);

static inline exr_compression_t exr_compression_of(const struct image_write_params *params)
{
    return params->uncompressed ? EXR_COMPRESSION_NONE : EXR_COMPRESSION_ZIP;
}

// A pixel's bits as the file has them: of a half, the lower 16.
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
