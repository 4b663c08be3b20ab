// Reports how much memory instances save.
#ifndef LAMPYRIS_CLI_SHARING_H
#define LAMPYRIS_CLI_SHARING_H

#include "flatten/flatten.h"

#include <jansson.h>

// Prints a line of text, or nothing if there are no instances: "shared 12 meshes by 1000000
// instances: …". `features` are the features of the kernels, which determine the data that the
// corners of triangles have.
void sharing_print(const struct flat_scene *flat, uint32_t features);
json_t *sharing_json(const struct flat_scene *flat, uint32_t features);

#endif
