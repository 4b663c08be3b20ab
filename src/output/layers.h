// Makes the layers of an EXR file that hold AOVs, the images other than radiance.
#ifndef LAMPYRIS_OUTPUT_LAYERS_H
#define LAMPYRIS_OUTPUT_LAYERS_H

#include "image/image.h"

#define LAYERS_MAX 15

struct layers {
    struct image_layer list[LAYERS_MAX];
    uint32_t count;
};

struct film_image;

// Lists the requested layers of the film (AOV_*); their values belong to the film.
void layers_list(const struct film_image *film, uint32_t wanted, struct layers *out);
// Returns the greatest number of bytes per pixel of the layers in a file, uncompressed.
uint64_t layers_bytes(uint32_t wanted, bool half_float);

#endif
