// The images besides the radiance as layers of an EXR file.
#ifndef LAMPYRIS_OUTPUT_LAYERS_H
#define LAMPYRIS_OUTPUT_LAYERS_H

#include "image/image.h"

#define LAYERS_MAX 15

struct layers {
    struct image_layer list[LAYERS_MAX];
    uint32_t count;
};

struct film_image;

// Those of the film that are wanted (AOV_*); their values are the film's.
void layers_list(const struct film_image *film, uint32_t wanted, struct layers *out);
// The most bytes that the layers take in a file for a pixel, uncompressed.
uint64_t layers_bytes(uint32_t wanted, bool half_float);

#endif
