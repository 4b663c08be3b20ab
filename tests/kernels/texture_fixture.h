// Scenes with textures, and running the routines of texture.comp on them.
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

// Replaces `items` by what the routine makes of them; records a failure and returns false if that
// cannot be. With LOBE_ANISOTROPIC, so that there are tangents.
bool texture_run(struct setup *setup, uint32_t routine, union texture_item *items, uint32_t count);

// Texels that look random, in [0, 1): of floats, or of halves rounded from the same floats. A
// `seed` stands for an image: equal ones make equal images.
uint32_t add_image(struct scene *scene, uint32_t width, uint32_t height, bool is_float,
                   uint32_t seed);
// One texel of this colour.
uint32_t add_plain_image(struct scene *scene, const float color[4], bool is_float);
// Component c of a texel, as the device is to see it.
double image_texel(const struct texture_image *image, uint32_t x, uint32_t y, int c);

// A texture of the scene's last material that reads an image as it lies.
struct texture *add_texture(struct scene *scene, uint32_t image, uint32_t flags);

// A square in z = 0, from (0, 0) to (1, 1), of two triangles with uv = position in set 0, twice
// that in set 1, tangents along x, normals along z and corners of the colours that corner_color()
// gives.
struct mesh *add_square(struct scene *scene, uint32_t material);
void corner_color(uint32_t vertex, float out[4]); // exact in halves

#endif
