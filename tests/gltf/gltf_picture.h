// Makes small PNG files in memory, for glTF files that contain them.
#ifndef LAMPYRIS_TESTS_GLTF_PICTURE_H
#define LAMPYRIS_TESTS_GLTF_PICTURE_H

#include "gltf_fixture.h"

// Makes an 8-bit RGBA PNG of one colour with uncompressed pixels. width * height is at most 4096.
struct bytes png_bytes(uint32_t width, uint32_t height, const uint8_t rgba[4]);
// Returns the PNG as a data URI with this type, to be freed by the caller.
char *png_uri(const uint8_t rgba[4], const char *mime_type);

#endif
