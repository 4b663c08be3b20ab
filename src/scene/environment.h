// Images of what surrounds the scene, in latitude and longitude.
//
// The convention is that of the Khronos glTF Sample Viewer (function dirToUV of its shader
// panorama_to_cubemap.frag), so that an image lights a glTF model here as it does there. A unit
// direction (x, y, z) sees the image at
//
//   u = 1/2 + atan2(z, x) / (2 pi)    0 at the left edge
//   v = acos(y) / pi                  0 at the upper edge
//
// The upper edge is the zenith (+Y), the lower one the nadir. The middle of the image is +X; to the
// right follow +Z (u = 3/4), -X (the right edge and the left), and -Z (u = 1/4). Inside the sphere
// with +Y upwards this is not mirrored: +Z is to the right of one who looks along +X.
//
// A texel is a patch of constant radiance: column floor(u width), row floor(v height), and the last
// one where that reaches the end.
#ifndef LAMPYRIS_SCENE_ENVIRONMENT_H
#define LAMPYRIS_SCENE_ENVIRONMENT_H

#include "scene.h"

// Sides of an image: the kernels take each in 16 bits.
#define ENVIRONMENT_SIZE_MAX 65535

// Replaces the scene's environment. file NULL: `radiance`, W/(sr m^2), from all directions; else
// the image of that (trusted) path times `radiance`, where NULL means 1. Texels that are negative
// or not finite become 0, with a note that counts them. The scene's hash goes on over what is set.
// ERR_INPUT for the file, for radiance outside [0, SCENE_RADIANCE_MAX] and for an image with a
// texel that exceeds it after the multiplication.
bool scene_set_environment(struct scene *scene, const char *file, const float radiance[3],
                           struct err *err);

// The texel that a unit direction sees, row * width + column.
uint32_t environment_texel(const struct environment *environment, const double direction[3]);
// Of each texel of a row, steradians.
double environment_texel_solid_angle(const struct environment *environment, uint32_t row);
// The mean luminance (BT.709) over all directions, its factor included.
double environment_luminance(const struct environment *environment);

#endif
