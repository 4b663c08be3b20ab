// What the other integrators show, in closed form: ambient occlusion, Whitted's recursion, and the
// fading of what the camera sees.
#include "closed_form.h"

// Beyond the seeds of the other closed forms.
#define FIRST_SEED 200000u

static double radians(double degrees)
{
    return degrees * M_PI / 180.0;
}

static double part(double rho, double le, double value)
{
    (void)rho, (void)le;
    return value;
}

static double all(double rho, double le, double value)
{
    (void)rho;
    return value * le;
}

// Beside a wall of height 1 from z = -1 to 1 at distance d: 1 - 2 F of one half, with F = (atan(1 /
// d) - d / r atan(1 / r)) / (2 pi), r^2 = d^2 + 1 (Howell's catalogue of configuration factors,
// B-4).
static double beside_wall(double rho, double le, double d)
{
    double r = sqrt(d * d + 1.0);
    (void)rho, (void)le;
    return 1.0 - (atan(1.0 / d) - d / r * atan(1.0 / r)) / M_PI;
}

// --- Whitted ------------------------------------------------------------------------------------

static double mirrors(double rho, double le, double count)
{
    return le * pow(rho, count);
}

// Reflectance of glass of index 1.5 (Fresnel), unpolarised.
static double reflectance(double degrees)
{
    double c = cos(radians(degrees)), t = sqrt(1.0 - (1.0 - c * c) / 2.25);
    double s = (c - 1.5 * t) / (c + 1.5 * t), p = (1.5 * c - t) / (1.5 * c + t);
    return 0.5 * (s * s + p * p);
}

// The light that leaves a slab of glass on the far side (`side` 0) or the near one (1): what is
// reflected inside is followed while it is 2^-10 of the camera ray at least, and for `depth`
// events.
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

static double from_slab(double rho, double le, double degrees)
{
    (void)rho;
    return le * leaves_slab(degrees, 1, 64);
}

// Three events: in, reflected, reflected; or in and out.
static double shallow_slab(double rho, double le, double degrees)
{
    (void)rho;
    return le * leaves_slab(degrees, 0, 3);
}

static double shallow_from_slab(double rho, double le, double degrees)
{
    (void)rho;
    return le * leaves_slab(degrees, 1, 3);
}

// A point light 1 m away, 60 degrees off the normal that is also the direction to the viewer:
// kd / pi + ks (n + 2) / (2 pi) cos^n, with ks = 1/4 and kd at most the rest.
static double phong(double rho, double le, double n)
{
    double kd = fmin(rho, 0.75), cosine = 0.5;
    return le * cosine * (kd / M_PI + 0.25 * (n + 2.0) / (2.0 * M_PI) * pow(cosine, n));
}

// A sphere of radius 1 at (d, d, 0), as if all of it were in its centre: as far as irradiance goes
// the same.
static double sphere_above(double rho, double le, double d)
{
    return rho * le / (2.0 * d * d) * sqrt(0.5);
}

// A disc of area pi at height h that faces the floor: pi le / h^2 at its centre.
static double disc_above(double rho, double le, double h)
{
    return rho * le / (h * h);
}

static double ambient(double rho, double le, double unused)
{
    (void)unused;
    return rho * le;
}

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
static const struct closed_form forms[] = {
    {"ao, plane alone", OURS "floor_light.json", part, 1, EXACT, 0,
     {AO, {"light", JSON({"type": "disc", "material": "light", "center": [0, -1, 0],
                          "normal": [0, 1, 0], "radius": 1})}}},
    {"ao, background", OURS "sky.json", part, 1, EXACT, 0, {AO}},
    {"ao, closed", OURS "sphere_furnace.json", part, 0, EXACT, 0, {AO}},
    {"ao, corner", OURS "floor_light.json", beside_wall, 1e-3, BY_STATISTICS, 0,
     {AO, {"light", JSON({"type": "quad", "material": "light", "corner": [1e-3, 0, -1],
                          "u": [0, 0, 2], "v": [0, 1, 0]})}}},
    {"ao, beside a wall", OURS "floor_light.json", beside_wall, 0.25, BY_STATISTICS, 0,
     {AO, {"light", JSON({"type": "quad", "material": "light", "corner": [0.25, 0, -1],
                          "u": [0, 0, 2], "v": [0, 1, 0]})}}},
    {"ao, below a disc", OURS "floor_light.json", part, 0.5, BY_STATISTICS, 0,
     {AO, {"light", JSON({"type": "disc", "material": "light", "center": [0, 1, 0],
                          "normal": [0, -1, 0], "radius": 1})}}},
    // Of the disc as far as 0.8: radius^2 = 0.8^2 - 0.5^2.
    {"ao, as far as 0.8", OURS "floor_light.json", part, 1 - 0.39 / 0.64, BY_STATISTICS, 0,
     {{"settings", JSON({"integrator": "ao", "ao_distance": 0.8, "sampler": "pcg"})},
      {"light", JSON({"type": "disc", "material": "light", "center": [0, 0.5, 0],
                      "normal": [0, -1, 0], "radius": 1})}}},
    {"ao, below a veil", OURS "floor_light.json", part, 1 - 0.3 * 0.5, BY_STATISTICS, 0,
     {AO, {"materials.light", JSON({"opacity": 0.3, "alpha": "blend"})},
      {"light", JSON({"type": "disc", "material": "light", "center": [0, 1, 0],
                      "normal": [0, -1, 0], "radius": 1})}}},

    {"15 corridor, 40 mirrors, whitted", OURS "mirror_corridor.json", mirrors, 40,
     WITHOUT_VARIANCE, 0, {WHITTED(1000), {"end", "[40, 0, 0]"}}},
    {"16 slab, whitted", OURS "slab.json", through_slab, 0, WITHOUT_VARIANCE, 0,
     {WHITTED(64), GLASS}},
    {"16 slab at 60, whitted", OURS "slab.json", through_slab, 60, WITHOUT_VARIANCE, 0,
     {WHITTED(64), GLASS, FROM_60}},
    {"16 slab at 60, reflected, whitted", OURS "slab.json", from_slab, 60, WITHOUT_VARIANCE, 0,
     {WHITTED(64), GLASS, FROM_60, {"light", "[0, 0, 5]"}}},
    {"16 slab at 60, 3 events", OURS "slab.json", shallow_slab, 60, WITHOUT_VARIANCE, 0,
     {WHITTED(3), GLASS, FROM_60}},
    {"16 slab at 60, reflected, 3 events", OURS "slab.json", shallow_from_slab, 60,
     WITHOUT_VARIANCE, 0, {WHITTED(3), GLASS, FROM_60, {"light", "[0, 0, 5]"}}},
    {"20 total reflection, whitted", OURS "slab.json", all, 1, EXACT, 0,
     {WHITTED(9), {"slab", JSON({"type": "dielectric", "ior": 0.5})}, FROM_60,
      {"light", "[0, 0, 5]"}}},
    // What is reflected inside is an event too many.
    {"21 camera in glass, whitted", OURS "media.json", all, 0.96 * 2.25, WITHOUT_VARIANCE, 0,
     {WHITTED(1), {"body", JSON({"type": "dielectric", "ior": 1.5})},
      {"bodies", JSON([{"type": "sphere", "material": "body", "radius": 1}])},
      {"from", "[0, 0, 0]"}, {"fov", "1e-4"}}},
    {"Phong highlight", OURS "floor_lamp.json", phong, 10, WITHOUT_VARIANCE, 0,
     {WHITTED(1), LAMP, {"materials.floor", JSON({"type": "phong", "exponent": 10,
      "base_color": [0.8, 0.5, 0.2], "specular_color": [0.25, 0.25, 0.25]})}}},
    {"lamp, Lambert, whitted", OURS "floor_lamp.json", ambient, 0, WITHOUT_VARIANCE, 0,
     {WHITTED(1), {"lamp", JSON({"type": "point", "position": [0, 0.5, 0],
                   "intensity": [0.7853981633974483, 1.5707963267948966, 3.141592653589793]})}}},
    {"sphere for a point, whitted", OURS "floor_light.json", sphere_above, 2, WITHOUT_VARIANCE, 0,
     {WHITTED(1), {"light", JSON({"type": "sphere", "material": "light", "center": [2, 2, 0],
                                  "radius": 1})}}},
    {"disc for a point, whitted", OURS "floor_light.json", disc_above, 2, WITHOUT_VARIANCE, 0,
     {WHITTED(1), {"light", JSON({"type": "disc", "material": "light", "center": [0, 2, 0],
                                  "normal": [0, -1, 0], "radius": 1})}}},
    {"ambient, whitted", "scenes/furnace_sky.json", ambient, 0, WITHOUT_VARIANCE, 0,
     {WHITTED(1), {"albedo", "[0.8, 0.5, 0.2]"}, {"sky", "[1, 2, 4]"},
      {"camera.fov_degrees", "5"}, {"film", JSON({"width": 16, "height": 16})}}},
};
// clang-format on

#define FORM_COUNT (sizeof forms / sizeof forms[0])

TEST(by_default)
{
    closed_forms_by_default(forms, FORM_COUNT, FIRST_SEED);
}

TEST(validation_is_silent)
{
    closed_forms_validated(forms, FORM_COUNT);
}

TEST_MAIN(TEST_CASE(by_default), TEST_CASE(validation_is_silent))
