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
// The radiance of column i, row j of an image is that of the centre of its texel, where u width is
// i + 1/2 and v height is j + 1/2. Between centres it is bilinear in u and v. To the right of the
// last column is the first one. What is seen at a pole is the mean of the texels about it, that is
// of the first or the last row, and from there to their centres radiance is bilinear, too: so it is
// a continuous function of the direction. (All texels of the row are equally far from the pole;
// where radiance has a gradient there, each cancels the one half a turn away.)
//
// With ENVIRONMENT_FILTER_NEAREST a texel is a patch of constant radiance instead: column
// floor(u width), row floor(v height), and the last one where that reaches the end.
//
// Its rotation turns the environment about +Y, counter-clockwise seen from above: by 90 degrees,
// what was seen towards +Z is seen towards +X.
#ifndef LAMPYRIS_SCENE_CORE_ENVIRONMENT_H
#define LAMPYRIS_SCENE_CORE_ENVIRONMENT_H

#include "scene/core/scene.h"

// Sides of an image: the kernels take each in 16 bits.
#define ENVIRONMENT_SIZE_MAX 65535
// Angular diameters of suns, degrees: below, directions in single precision say nothing of a place
// on the disc.
#define ENVIRONMENT_SUN_DIAMETER_MIN 1e-4
#define ENVIRONMENT_SUN_DIAMETER_MAX 180.0
// Rows that a gradient is baked to.
#define ENVIRONMENT_GRADIENT_ROWS 1024

// Replaces the scene's environment. file NULL: `radiance`, W/(sr m^2), from all directions; else
// the image of that (trusted) path times `radiance`, where NULL means 1. Texels that are negative
// or not finite become 0, with a note that counts them. The scene's hash goes on over what is set.
// ERR_INPUT for the file, for radiance outside [0, SCENE_RADIANCE_MAX] and for an image with a
// texel that exceeds it after the multiplication.
bool scene_set_environment(struct scene *scene, const char *file, const float radiance[3],
                           struct err *err);

// Radiance that changes evenly with the height y of a direction: from the horizon's at 0 to the
// zenith's at 1 and the nadir's at -1. A texel holds its mean, and differs from what is at its
// edges by at most 0.16 % of the difference of two colours. The hash goes on over the colours.
struct environment_gradient {
    float zenith[3], horizon[3], nadir[3]; // W/(sr m^2)
};
bool scene_set_gradient(struct scene *scene, const struct environment_gradient *gradient,
                        struct err *err);

// Turns the scene's environment by a further angle, and multiplies its radiance, that of a sky's
// sun and of the light that it may have become, too. Does nothing to a scene without one. ERR_INPUT
// where that exceeds SCENE_RADIANCE_MAX.
bool scene_adjust_environment(struct scene *scene, double radians, double strength,
                              struct err *err);
// Appends the sky's sun to the lights. To be called once, when nothing replaces the environment any
// more.
bool scene_add_sky_sun(struct scene *scene, struct err *err);

// Adds a light before the sky's sun, which stays the last one, and takes the last of those before
// it away. *index: the light's place. NULL when out of memory.
struct light *scene_insert_light(struct scene *scene, uint32_t *index);
void scene_take_light(struct scene *scene);
// The light that the sky's sun is; SCENE_NONE.
uint32_t scene_sun_light(const struct scene *scene);

// Takes the sun of an environment that was replaced, the last of the lights, from them.
void scene_remove_sun(struct scene *scene, const struct environment *former);

// Radiance of a disc of that angular radius (radians, to pi / 2) which has this irradiance on a
// surface that faces it.
double environment_sun_radiance(double irradiance, double angular_radius);

// The solid angle of each texel of a row, steradians.
double environment_texel_solid_angle(const struct environment *environment, uint32_t row);
// Returns the solid angle of a cell between centres of texels. Row 0 of cells is between the zenith
// and the first row of texels, row `height` between the last one and the nadir.
double environment_cell_solid_angle(const struct environment *environment, uint32_t row);
// The greatest component of all its radiance, its factor included.
float environment_greatest(const struct environment *environment);
// The mean luminance (BT.709) over all directions, its factor included.
double environment_luminance(const struct environment *environment);
// The mean over all directions of what its image's luminance, factor included, exceeds `floor` by.
double environment_luminance_above(const struct environment *environment, double floor);

#endif
