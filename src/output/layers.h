// Lists the layers of an EXR file that contain AOVs, which are images other than radiance.
#ifndef LAMPYRIS_OUTPUT_LAYERS_H
#define LAMPYRIS_OUTPUT_LAYERS_H

#include "image/image.h"

#define LAYERS_MAX 15

struct layers {
    struct image_layer list[LAYERS_MAX];
    uint32_t count;
};

struct film_image;

// Lists those layers of the film that are requested (AOV_*). The film owns their values.
void layers_list(const struct film_image *film, uint32_t wanted, struct layers *out);
// Estimates the number of bytes per pixel that these layers take in a file without compression.
uint64_t layers_bytes(uint32_t wanted, bool half_float);

#endif
