// Reports how much memory instances save.
#ifndef LAMPYRIS_CLI_SHARING_H
#define LAMPYRIS_CLI_SHARING_H

#include "flatten/flatten.h"

#include <jansson.h>

// Prints a line of text, or nothing if there are no instances: "shared 12 meshes by 1000000
// instances: …". `features` are those of the kernels; they determine which data a triangle's
// corners have.
void sharing_print(const struct flat_scene *flat, uint32_t features);
json_t *sharing_json(const struct flat_scene *flat, uint32_t features);

#endif
