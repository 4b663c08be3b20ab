// A clear sky and its sun, by the closed formulas of Preetham, Shirley and Smits 1999, "A Practical
// Analytic Model for Daylight". +Y is up.
//
// The formulas give luminances, in thousands of cd/m^2. Here a radiance of luminance Y (by BT.709's
// weights of red, green and blue) corresponds to 683 Y cd/m^2, where 683 lm/W is the luminous
// efficacy of light of 540 THz (SI brochure, 9th edition, section 2.3.1).
#ifndef LAMPYRIS_SCENE_SKY_SKY_H
#define LAMPYRIS_SCENE_SKY_SKY_H

#include "scene/core/scene.h"

#define SKY_TURBIDITY_MIN 2.0
#define SKY_TURBIDITY_MAX 10.0
// The size of the image to which the sky is baked. docs/lighting.md states the resulting error.
#define SKY_WIDTH 1024
#define SKY_HEIGHT 512

struct sky {
    double turbidity;        // haziness, SKY_TURBIDITY_MIN (clear) to SKY_TURBIDITY_MAX
    double sun_direction[3]; // unit vector towards the sun; y >= 0
    double ground_albedo[3]; // albedo of the ground below the horizon, 0 to 1
    bool has_sun;            // the sun is visible and is a light; it always lights the sky
    double sun_diameter;     // diameter of the disc, radians
};

// Returns a sky of turbidity 3, with the sun 45 degrees high above +X and 0.53 degrees wide, and
// ground of albedo 0.2.
struct sky sky_default(void);
// Sets the sun's direction from its elevation above the horizon and its azimuth from +X towards +Z.
void sky_place_sun(struct sky *sky, double elevation_degrees, double azimuth_degrees);
// Parses "KEY=NUMBER,..." with the keys turbidity, elevation, azimuth, albedo, diameter and sun (0
// or 1). Keys that are not given keep their default. Fails with ERR_USAGE.
bool sky_parse(const char *text, struct sky *out, struct err *err);

// The coefficients of the formulas for one turbidity and one position of the sun.
struct sky_model {
    double sun_direction[3];
    double zenith[3];   // Y, x, y at the zenith
    double perez[3][5]; // coefficients A to E of each of Y, x, y
    double scale[3];    // factors that turn the product of Perez's factors into Y, x and y
};
void sky_model_init(const struct sky *sky, struct sky_model *out);
// Computes the radiance for a unit direction with y > 0. Components are negative for colours
// outside the gamut of Rec. 709.
void sky_radiance(const struct sky_model *model, const double direction[3], double rgb[3]);
// Computes the irradiance of the sun on a surface facing it, in W/m^2.
void sky_sun_irradiance(const struct sky *sky, double rgb[3]);

// Replaces the scene's environment by the baked sky; scene_add_sky_sun() turns its sun into a
// light. Negative components of colours outside the gamut of Rec. 709 become 0, and a note counts
// these texels. Fails with ERR_INPUT for parameters out of range.
bool scene_set_sky(struct scene *scene, const struct sky *sky, struct err *err);

#endif
