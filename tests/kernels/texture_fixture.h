// Makes scenes with textures, and runs the routines of texture.comp on them.
#ifndef LAMPYRIS_TESTS_TEXTURE_FIXTURE_H
#define LAMPYRIS_TESTS_TEXTURE_FIXTURE_H

#include "image/image.h"
#include "kernel_fixture.h"
#include "scene/core/texture_load.h"
#include "texture_item.h"

// Inputs and outputs of an item; see texture_item.h.
union texture_item {
    float f[4][4];
    uint32_t u[4][4];
};

#define TEXTURE_SLOTS (1u << 16)

// Replaces `items` by the output of the routine. Returns false, and records a failure, if the
// device failed. LOBE_ANISOTROPIC is compiled in, so that there are tangents.
bool texture_run(struct setup *setup, uint32_t routine, union texture_item *items, uint32_t count);

// Adds an image of 8-bit codes. Images with equal seeds count as equal; 0: equal to none.
uint32_t add_codes(struct scene *scene, uint32_t width, uint32_t height, const uint8_t (*codes)[4],
                   bool is_srgb, uint32_t seed);
// Adds an image of texels in [0, 1] that look random: floats, or codes, which are sRGB-encoded if
// the seed is odd. Equal seeds make equal images.
uint32_t add_image(struct scene *scene, uint32_t width, uint32_t height, bool is_float,
                   uint32_t seed);
// Adds an image of floats with one texel of this colour.
uint32_t add_plain_image(struct scene *scene, const float color[4]);
// Returns component c of a texel, as the device should read it.
double image_texel(const struct texture_image *image, uint32_t x, uint32_t y, int c);

// Adds a texture to the scene's last material, which reads the image without a transform.
struct texture *add_texture(struct scene *scene, uint32_t image, uint32_t flags);

// Adds a square in z = 0, from (0, 0) to (1, 1), of two triangles. In UV set 0 the coordinates
// equal the position, in set 1 twice the position. Tangents are along x, normals along z, and
// vertices have the colours of corner_color().
struct mesh *add_square(struct scene *scene, uint32_t material);
void corner_color(uint32_t vertex, float out[4]); // halves represent it exactly

#endif
