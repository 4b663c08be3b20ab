// Small pictures as PNG files in memory, for glTF files that carry them.
#ifndef LAMPYRIS_TESTS_GLTF_PICTURE_H
#define LAMPYRIS_TESTS_GLTF_PICTURE_H

#include "gltf_fixture.h"

// An 8-bit RGBA PNG of one colour, its pixels stored uncompressed. width * height up to 4096.
struct bytes png_bytes(uint32_t width, uint32_t height, const uint8_t rgba[4]);
// Returns the PNG as a data URI of that type; the caller frees it.
char *png_uri(const uint8_t rgba[4], const char *mime_type);

#endif
