// Defines cases of scenes with sizes from 1e-12 m to 1e12 m, and of cameras at such distances.
// Their closed forms do not depend on the unit of length.
#include "check/case_list.h"
#include "check/closed_form.h"
#include <math.h>

// --- scales --------------------------------------------------------------------------------------

// Returns the radiance of the scene all_lengths.json. It has a square of side 2 at 1 m (factor
// B-3), a point light at 1 m and 60 degrees, and a slab of fog that an oblique ray crosses.
static double all_lengths(double rho, double le, double unused)
{
    (void)unused;
    double corner = sqrt(0.5) * atan(sqrt(0.5)) / M_PI;
    double floor = rho * le * 4.0 * corner + rho / M_PI * le * 0.5;
    return floor * pow(rho, 0.2 * sqrt(4.25) / 2.0);
}
static const char all_lengths_is[] = "(rho Le F + rho I cos / (pi d^2)) exp(-sigma d)";

#define SCALED(FORM, name, factor)                                                                 \
    FORM(name, "all_lengths.json", all_lengths, 0, BY_STATISTICS, NEE_ALONE, {{0}}, factor)

// clang-format off
static const struct check_case scales[] = {
    SCALED(FORM, "C1 all lengths times 1e-12", 1e-12),
    SCALED(FORM, "C1 all lengths times 1e12", 1e12),
    SCALED(LONG_FORM, "C1 all lengths times 1e-9", 1e-9),
    SCALED(LONG_FORM, "C1 all lengths times 1e9", 1e9),
    SCALED(LONG_FORM, "C1 all lengths times 1e-6", 1e-6),
    SCALED(LONG_FORM, "C1 all lengths times 1e-3", 1e-3),
    SCALED(LONG_FORM, "C1 all lengths", 1.0),
    SCALED(LONG_FORM, "C1 all lengths times 1e3", 1e3),
    SCALED(LONG_FORM, "C1 all lengths times 1e6", 1e6),
};
// clang-format on

// --- distances -----------------------------------------------------------------------------------

// Returns the mean radiance of the scene far.json, which shows a sphere or a disc of radius 1 in a
// field of view 4 m wide and high.
static double part_filled(double rho, double le, double unused)
{
    (void)rho, (void)unused;
    return le * M_PI / 16.0;
}
static const char part_filled_is[] = "Le pi / 16";

// A convex body that fills the image receives light from the sky only.
static double convex(double rho, double le, double unused)
{
    (void)unused;
    return rho * le;
}
static const char convex_is[] = "rho Le";

#define EYE(x, y, z, degrees)                                                                      \
    {                                                                                              \
        "camera",                                                                                  \
            JSON({"position" : [ x, y, z ], "target" : [ 0, 0, 0 ], "fov_degrees" : degrees})      \
    }

// clang-format off
static const struct check_case distances[] = {
    FORM("C45 sphere from 1e8 m", "far.json", part_filled, 0, BY_STATISTICS, BSDF_ALONE, {{0}}),
    FORM("C45 white sphere from 1e8 m", "far.json", convex, 0, WITHOUT_VARIANCE, BSDF_ALONE,
     {EYE(6e7, 0, 8e7, 5.7e-7), {"sky", "[1, 2, 4]"},
      {"shapes", JSON([{"type": "sphere", "material": "floor", "radius": 1}])}}),
    FORM("C45 sphere from 1e12 m, aslant", "far.json", part_filled, 0, BY_STATISTICS, BSDF_ALONE,
     {EYE(3.6e11, 4.8e11, 8e11, 2.2918311805232929e-10)}),
    LONG_FORM("C45 from 1e8 m through a lens", "far.json", part_filled, 0, BY_STATISTICS, BSDF_ALONE,
     {{"camera", JSON({"position": [6e7, 0, 8e7], "target": [0, 0, 0],
                       "fov_degrees": 2.2918311805232929e-6, "aperture_radius_mm": 1e5,
                       "focus": [0, 0, 0]})}}),
    LONG_FORM("C45 from 1e8 m in parallel", "far.json", part_filled, 0, BY_STATISTICS, BSDF_ALONE,
     {{"camera", JSON({"type": "orthographic", "position": [6e7, 0, 8e7], "target": [0, 0, 0],
                       "height": 4})}}),
    LONG_FORM("C45 from 1e8 m beside a plane", "far.json", part_filled, 0, BY_STATISTICS, BSDF_ALONE,
     {EYE(0, 0, 1e8, 2.2918311805232929e-6),
      {"shapes", JSON([{"type": "sphere", "material": "light", "radius": 1},
                       {"type": "plane", "material": "floor", "point": [0, -100, 0],
                        "normal": [0, 1, 0]}])}}),
    FORM("C45 a plane before it", "far.json", convex, 0, WITHOUT_VARIANCE, BSDF_ALONE,
     {EYE(0, 0, 1e8, 2.2918311805232929e-6), {"sky", "[1, 2, 4]"},
      {"shapes", JSON([{"type": "sphere", "material": "light", "radius": 1},
                       {"type": "plane", "material": "floor", "point": [0, 0, 1e3],
                        "normal": [0, 0, 1]}])}}),
};
// clang-format on

// --- small lamps ---------------------------------------------------------------------------------

// Returns the radiance of the floor in the scene small_lamp.json, with a lamp of area A at d = (2,
// 1, 0) and with the radiance le / A. It is rho le cos cos' / (pi d^2), where cos and cos' are the
// cosines of the angles between the direction to the lamp and the two normals.
static double level_lamp(double rho, double le, double unused)
{
    (void)unused;
    return rho * le / (25.0 * M_PI);
}
static const char level_lamp_is[] = "rho Le A cos cos' / (pi d^2)";

// Returns the radiance for the lamp TILTED. Its two edges are given in a unit of 1e-7 m, and its
// radiance is le over the square of this unit.
static double tilted_lamp(double rho, double le, double unused)
{
    (void)unused;
    const double n[2] = {0.3 * 1.0 - 0.2 * 0.4, 0.2 * 0.1 - 1.0 * 1.0};
    return rho * le / M_PI * 0.5 * fabs(2.0 * n[0] + n[1]) / 25.0;
}
static const char tilted_lamp_is[] = "rho Le A cos cos' / (pi d^2)";

#define LEVEL(size)                                                                                \
    {                                                                                              \
        "lamp", JSON({                                                                             \
            "type" : "quad",                                                                       \
            "material" : "lamp",                                                                   \
            "corner" : [ 2, 1, 0 ],                                                                \
            "u" : [ size, 0, 0 ],                                                                  \
            "v" : [ 0, 0, size ]                                                                   \
        })                                                                                         \
    }
// The edges are (1, 0.3, 0.2) and (0.1, 0.4, 1) in units of 1e-7 m. The second triangle of the quad
// has no area.
#define TILTED                                                                                     \
    {                                                                                              \
        "lamp", JSON({                                                                             \
            "type" : "quad",                                                                       \
            "material" : "lamp",                                                                   \
            "vertices" : [                                                                         \
                [ 2, 1, 0 ], [ 2.0000001, 1.00000003, 2e-8 ], [ 2.00000001, 1.00000004, 1e-7 ],    \
                [ 2.00000001, 1.00000004, 1e-7 ]                                                   \
            ]                                                                                      \
        })                                                                                         \
    }

#define LAMP(text, form, shape, color)                                                             \
    FORM(text, "small_lamp.json", form, 0, WITHOUT_VARIANCE, NEE_ALONE,                            \
         {shape, {"emission", color}})

static const struct check_case small_lamps[] = {
    LAMP("C14 lamp of 1e-6 m", level_lamp, LEVEL(1e-6), "[1e12, 2e12, 4e12]"),
    LAMP("C14 lamp of 1e-8 m", level_lamp, LEVEL(1e-8), "[1e16, 2e16, 4e16]"),
    LAMP("C14 tilted lamp of 1e-7 m", tilted_lamp, TILTED, "[1e14, 2e14, 4e14]"),
    LAMP("C14 lamp of 3e-6 m", level_lamp, LEVEL(3e-6),
         "[1.1111111e11, 2.2222222e11, 4.4444444e11]"),
    LAMP("C14 lamp of 1e-10 m", level_lamp, LEVEL(1e-10), "[1e20, 2e20, 4e20]"),
};

CHECK_GROUP(check_scales, "scales", "sizes from 1e-12 m to 1e12 m", scales);

CHECK_GROUP(check_distances, "distances", "cameras 1e8 m and 1e12 m away", distances);

CHECK_GROUP(check_small_lamps, "small-lamps", "lamps down to 1e-10 m", small_lamps);
