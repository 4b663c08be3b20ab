// Defines closed forms for the other integrators: ambient occlusion and Whitted's recursion.
#include "check/case_list.h"
#include "check/closed_form.h"
#include <math.h>

static double radians(double degrees)
{
    return degrees * M_PI / 180.0;
}

static double part(double rho, double le, double value)
{
    (void)rho, (void)le;
    return value;
}
static const char part_is[] = "the part of the hemisphere that is open";

static double all(double rho, double le, double value)
{
    (void)rho;
    return value * le;
}
static const char all_is[] = "Le times a known factor";

// Returns the visibility at a point next to a wall of height 1 that extends from z = -1 to 1 at the
// distance d. It is 1 - 2 F, where F is the configuration factor of one half of the wall, (atan(1 /
// d) - d / r atan(1 / r)) / (2 pi) with r^2 = d^2 + 1 (Howell's catalogue of configuration factors,
// B-4).
static double beside_wall(double rho, double le, double d)
{
    double r = sqrt(d * d + 1.0);
    (void)rho, (void)le;
    return 1.0 - (atan(1.0 / d) - d / r * atan(1.0 / r)) / M_PI;
}
static const char beside_wall_is[] = "1 - 2 F, factor B-4";

// --- Whitted ------------------------------------------------------------------------------------

static double mirrors(double rho, double le, double count)
{
    return le * pow(rho, count);
}
static const char mirrors_is[] = "R^k Le for k mirrors";

// Returns the Fresnel reflectance of glass with index 1.5 for unpolarised light.
static double reflectance(double degrees)
{
    double c = cos(radians(degrees)), t = sqrt(1.0 - (1.0 - c * c) / 2.25);
    double s = (c - 1.5 * t) / (c + 1.5 * t), p = (1.5 * c - t) / (1.5 * c + t);
    return 0.5 * (s * s + p * p);
}

// Returns the light that leaves a slab of glass on the far side (`side` 0) or on the near side (1).
// Internal reflections are followed as long as their weight is at least 2^-10 of the camera ray's,
// and for at most `depth` events.
static double leaves_slab(double degrees, int side, int depth)
{
    double r = reflectance(degrees), inside = 1.0 - r, sum = side ? r : 0.0;
    for (int face = 0; face + 2 <= depth; face++) {
        sum += face % 2 == side ? inside * (1.0 - r) : 0.0;
        inside *= r;
        if (inside < 1.0 / 1024.0)
            break;
    }
    return sum;
}

static double through_slab(double rho, double le, double degrees)
{
    (void)rho;
    return le * leaves_slab(degrees, 0, 64);
}
static const char through_slab_is[] = "Le times the sum of T^2 R^2k";

static double from_slab(double rho, double le, double degrees)
{
    (void)rho;
    return le * leaves_slab(degrees, 1, 64);
}
static const char from_slab_is[] = "Le (R + the sum of T^2 R^(2k+1))";

// Follows at most three events: refraction into the glass and two reflections, or refraction into
// the glass and out of it.
static double shallow_slab(double rho, double le, double degrees)
{
    (void)rho;
    return le * leaves_slab(degrees, 0, 3);
}
static const char shallow_slab_is[] = "Le T^2";

static double shallow_from_slab(double rho, double le, double degrees)
{
    (void)rho;
    return le * leaves_slab(degrees, 1, 3);
}
static const char shallow_from_slab_is[] = "Le (R + T^2 R)";

// Returns the radiance under a point light 1 m away, 60 degrees off the normal. The camera is in
// the direction of the light. The BRDF is kd / pi + ks (n + 2) / (2 pi) cos^n, with ks = 1/4 and kd
// at most 1 - ks.
static double phong(double rho, double le, double n)
{
    double kd = fmin(rho, 0.75), cosine = 0.5;
    return le * cosine * (kd / M_PI + 0.25 * (n + 2.0) / (2.0 * M_PI) * pow(cosine, n));
}
static const char phong_is[] = "Le cos (kd / pi + ks (n + 2) cos^n / (2 pi))";

// Returns the radiance under a sphere of radius 1 at (d, d, 0), which causes the same irradiance as
// a point at its centre with the same power.
static double sphere_above(double rho, double le, double d)
{
    return rho * le / (2.0 * d * d) * sqrt(0.5);
}
static const char sphere_above_is[] = "rho Le (r / d)^2 cos";

// Returns the radiance below a disc of area pi at the height h, facing the floor. As a point light
// it causes the irradiance pi le / h^2 at the point below its centre.
static double disc_above(double rho, double le, double h)
{
    return rho * le / (h * h);
}
static const char disc_above_is[] = "rho Le A / (pi h^2)";

static double ambient(double rho, double le, double unused)
{
    (void)unused;
    return rho * le;
}
static const char ambient_is[] = "rho Le";

#define AO                                                                                         \
    {                                                                                              \
        "settings", JSON({"integrator" : "ao", "sampler" : "pcg"})                                 \
    }
#define WHITTED(bounces)                                                                           \
    {                                                                                              \
        "settings", JSON({"integrator" : "whitted", "max_bounces" : bounces})                      \
    }
#define GLASS                                                                                      \
    {                                                                                              \
        "slab", JSON({"type" : "dielectric", "ior" : 1.5})                                         \
    }
#define FROM_60                                                                                    \
    {                                                                                              \
        "from", "[0.8660254037844386, 0, 0.5]"                                                     \
    }
#define LAMP                                                                                       \
    {                                                                                              \
        "lamp", JSON({                                                                             \
            "type" : "point",                                                                      \
            "position" : [ 0.8660254037844386, 0.5, 0 ],                                           \
            "intensity" : [ 1, 2, 4 ]                                                              \
        })                                                                                         \
    }

// clang-format off
static const struct check_case forms[] = {
    FORM("ao, plane alone", "floor_light.json", part, 1, EXACT, 0,
     {AO, {"light", JSON({"type": "disc", "material": "light", "center": [0, -1, 0],
                          "normal": [0, 1, 0], "radius": 1})}}),
    FORM("ao, background", "sky.json", part, 1, EXACT, 0, {AO}),
    FORM("ao, closed", "sphere_furnace.json", part, 0, EXACT, 0, {AO}),
    FORM("ao, corner", "floor_light.json", beside_wall, 1e-3, BY_STATISTICS, 0,
     {AO, {"light", JSON({"type": "quad", "material": "light", "corner": [1e-3, 0, -1],
                          "u": [0, 0, 2], "v": [0, 1, 0]})}}),
    FORM("ao, beside a wall", "floor_light.json", beside_wall, 0.25, BY_STATISTICS, 0,
     {AO, {"light", JSON({"type": "quad", "material": "light", "corner": [0.25, 0, -1],
                          "u": [0, 0, 2], "v": [0, 1, 0]})}}),
    FORM("ao, below a disc", "floor_light.json", part, 0.5, BY_STATISTICS, 0,
     {AO, {"light", JSON({"type": "disc", "material": "light", "center": [0, 1, 0],
                          "normal": [0, -1, 0], "radius": 1})}}),
    // Only the part of the disc within the distance 0.8 occludes; the square of its radius is 0.8^2
    // - 0.5^2.
    FORM("ao, as far as 0.8", "floor_light.json", part, 1 - 0.39 / 0.64, BY_STATISTICS, 0,
     {{"settings", JSON({"integrator": "ao", "ao_distance": 0.8, "sampler": "pcg"})},
      {"light", JSON({"type": "disc", "material": "light", "center": [0, 0.5, 0],
                      "normal": [0, -1, 0], "radius": 1})}}),
    FORM("ao, below a veil", "floor_light.json", part, 1 - 0.3 * 0.5, BY_STATISTICS, 0,
     {AO, {"materials.light", JSON({"opacity": 0.3, "alpha": "blend"})},
      {"light", JSON({"type": "disc", "material": "light", "center": [0, 1, 0],
                      "normal": [0, -1, 0], "radius": 1})}}),

    FORM("B15 corridor, 40 mirrors, whitted", "mirror_corridor.json", mirrors, 40,
     WITHOUT_VARIANCE, 0, {WHITTED(1000), {"end", "[40, 0, 0]"}}),
    FORM("B16 slab, whitted", "slab.json", through_slab, 0, WITHOUT_VARIANCE, 0,
     {WHITTED(64), GLASS}),
    FORM("B16 slab at 60, whitted", "slab.json", through_slab, 60, WITHOUT_VARIANCE, 0,
     {WHITTED(64), GLASS, FROM_60}),
    FORM("B16 slab at 60, reflected, whitted", "slab.json", from_slab, 60, WITHOUT_VARIANCE, 0,
     {WHITTED(64), GLASS, FROM_60, {"light", "[0, 0, 5]"}}),
    FORM("B16 slab at 60, 3 events", "slab.json", shallow_slab, 60, WITHOUT_VARIANCE, 0,
     {WHITTED(3), GLASS, FROM_60}),
    FORM("B16 slab at 60, reflected, 3 events", "slab.json", shallow_from_slab, 60,
     WITHOUT_VARIANCE, 0, {WHITTED(3), GLASS, FROM_60, {"light", "[0, 0, 5]"}}),
    FORM("B20 total reflection, whitted", "slab.json", all, 1, EXACT, 0,
     {WHITTED(9), {"slab", JSON({"type": "dielectric", "ior": 0.5})}, FROM_60,
      {"light", "[0, 0, 5]"}}),
    // The internal reflection would exceed the permitted number of events.
    FORM("B21 camera in glass, whitted", "media.json", all, 0.96 * 2.25, WITHOUT_VARIANCE, 0,
     {WHITTED(1), {"body", JSON({"type": "dielectric", "ior": 1.5})},
      {"bodies", JSON([{"type": "sphere", "material": "body", "radius": 1}])},
      {"from", "[0, 0, 0]"}, {"fov", "1e-4"}}),
    FORM("Phong highlight", "floor_lamp.json", phong, 10, WITHOUT_VARIANCE, 0,
     {WHITTED(1), LAMP, {"materials.floor", JSON({"type": "phong", "exponent": 10,
      "base_color": [0.8, 0.5, 0.2], "specular_color": [0.25, 0.25, 0.25]})}}),
    FORM("lamp, Lambert, whitted", "floor_lamp.json", ambient, 0, WITHOUT_VARIANCE, 0,
     {WHITTED(1), {"lamp", JSON({"type": "point", "position": [0, 0.5, 0],
                   "intensity": [0.7853981633974483, 1.5707963267948966, 3.141592653589793]})}}),
    FORM("sphere for a point, whitted", "floor_light.json", sphere_above, 2, WITHOUT_VARIANCE, 0,
     {WHITTED(1), {"light", JSON({"type": "sphere", "material": "light", "center": [2, 2, 0],
                                  "radius": 1})}}),
    FORM("disc for a point, whitted", "floor_light.json", disc_above, 2, WITHOUT_VARIANCE, 0,
     {WHITTED(1), {"light", JSON({"type": "disc", "material": "light", "center": [0, 2, 0],
                                  "normal": [0, -1, 0], "radius": 1})}}),
    FORM("ambient, whitted", "furnace_sky.json", ambient, 0, WITHOUT_VARIANCE, 0,
     {WHITTED(1), {"albedo", "[0.8, 0.5, 0.2]"}, {"sky", "[1, 2, 4]"},
      {"camera.fov_degrees", "5"}, {"film", JSON({"width": 16, "height": 16})}}),
};
// clang-format on

CHECK_GROUP(check_integrators, "integrators", "ambient occlusion and Whitted's recursion", forms);
