// Environment images, in latitude-longitude format.
//
// The convention is that of the Khronos glTF Sample Viewer (function dirToUV of its shader
// panorama_to_cubemap.frag), so that an image lights a glTF model here as it does there. The unit
// direction (x, y, z) corresponds to the image position
//
//   u = 1/2 + atan2(z, x) / (2 pi)    0 at the left edge
//   v = acos(y) / pi                  0 at the upper edge
//
// The upper edge is the zenith (+Y), the lower one the nadir. The centre of the image is +X; to the
// right follow +Z (u = 3/4), -X (the right edge and the left), and -Z (u = 1/4). A viewer inside
// the sphere with +Y up sees the image unmirrored: when looking along +X, +Z is to the right.
//
// The texel in column i and row j holds the radiance at its centre, where u width is i + 1/2 and v
// height is j + 1/2. Between centres, radiance is interpolated bilinearly in u and v. The first
// column follows the last one. The radiance at a pole is the mean of the texels of the first or the
// last row; between the pole and the centres of that row, interpolation is bilinear, too, so that
// radiance is a continuous function of the direction. (All texels of the row are equally far from
// the pole, so the mean is exact if radiance is linear near the pole.)
//
// With ENVIRONMENT_FILTER_NEAREST a texel is a patch of constant radiance instead: column floor(u
// width), row floor(v height), clamped to the last column and row.
//
// The rotation turns the environment about +Y, counter-clockwise as seen from above: a rotation by
// 90 degrees moves what was in direction +Z to direction +X.
#ifndef LAMPYRIS_SCENE_CORE_ENVIRONMENT_H
#define LAMPYRIS_SCENE_CORE_ENVIRONMENT_H

#include "scene/core/scene.h"

// The maximum width and height of an image, because the kernels store each in 16 bits.
#define ENVIRONMENT_SIZE_MAX 65535
// Limits of suns' angular diameters, in degrees. Below the minimum, directions in single precision
// no longer resolve positions on the disc.
#define ENVIRONMENT_SUN_DIAMETER_MIN 1e-4
#define ENVIRONMENT_SUN_DIAMETER_MAX 180.0
// Number of rows of the image that represents a gradient.
#define ENVIRONMENT_GRADIENT_ROWS 1024

// Replaces the scene's environment. If `file` is NULL, it has constant radiance from all
// directions: `radiance`, in W/(sr m^2). Otherwise it is the image at that (trusted) path,
// multiplied by `radiance`, where NULL means 1. Texels that are negative or not finite become 0,
// and a note counts them. All of this is added to the scene's hash. Fails with ERR_INPUT if the
// file cannot be read, if `radiance` is outside [0, SCENE_RADIANCE_MAX], or if a texel exceeds that
// maximum after the multiplication.
bool scene_set_environment(struct scene *scene, const char *file, const float radiance[3],
                           struct err *err);

// A radiance that is piecewise linear in the y of a direction: horizon at y = 0, zenith at y = 1
// and nadir at y = -1. Each texel of the image holds the mean over the texel, which differs from
// the radiance at its edges by at most 0.16 % of the difference of two colours. The colours are
// added to the scene's hash.
struct environment_gradient {
    float zenith[3], horizon[3], nadir[3]; // W/(sr m^2)
};
bool scene_set_gradient(struct scene *scene, const struct environment_gradient *gradient,
                        struct err *err);

// Rotates the scene's environment by a further angle, and multiplies its radiance, including that
// of a sky's sun and of the light made from the sun. Does nothing to a scene without an
// environment. Fails with ERR_INPUT if the result exceeds SCENE_RADIANCE_MAX.
bool scene_adjust_environment(struct scene *scene, double radians, double strength,
                              struct err *err);
// Appends the sky's sun to the lights. Must be called once, after the last replacement of the
// environment.
bool scene_add_sky_sun(struct scene *scene, struct err *err);

// Inserts a light before the sky's sun, which stays the last light; *index is the new light's
// index. Returns NULL when out of memory. scene_take_light() removes the last light before the sun.
struct light *scene_insert_light(struct scene *scene, uint32_t *index);
void scene_take_light(struct scene *scene);
// Returns the index of the light that is the sky's sun; SCENE_NONE if there is none.
uint32_t scene_sun_light(const struct scene *scene);

// Removes the sun of the environment `former`, which was replaced, from the end of the lights.
void scene_remove_sun(struct scene *scene, const struct environment *former);

// Returns the radiance of a disc of this angular radius (radians, at most pi / 2) that causes this
// irradiance on a surface facing it.
double environment_sun_radiance(double irradiance, double angular_radius);

// Returns the solid angle of each texel of a row, in steradians.
double environment_texel_solid_angle(const struct environment *environment, uint32_t row);
// Returns the solid angle, in steradians, of a cell between centres of texels. Row 0 of the cells
// is between the zenith and the first row of texels, row `height` between the last row and the
// nadir.
double environment_cell_solid_angle(const struct environment *environment, uint32_t row);
// Returns the maximum component of the radiance, including the factor `radiance`.
float environment_greatest(const struct environment *environment);
// Returns the mean luminance (BT.709) over all directions, including the factor `radiance`.
double environment_luminance(const struct environment *environment);
// Returns the mean over all directions of max(0, luminance - `floor`) of the image, including the
// factor `radiance`.
double environment_luminance_above(const struct environment *environment, double floor);

#endif
