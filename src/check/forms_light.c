// Defines cases of scenes whose radiance has a closed form (numbers as in docs/verification.md, B
// and C): furnaces, delta lights, configuration factors, mirrors, an edge.
#include "base/maths.h"
#include "check/case_list.h"
#include "check/closed_form.h"
#include "check/made_mesh.h"
#include <math.h>

// --- the forms ----------------------------------------------------------------------------------
// A configuration factor is the fraction of the light leaving a diffuse surface element that
// reaches another surface. B-3 and C-11 are from Howell, "A Catalog of Radiation Heat Transfer
// Configuration Factors".

static double sky(double rho, double le, double unused)
{
    (void)rho, (void)unused;
    return le;
}
static const char sky_is[] = "Le";

// A convex body receives light from the environment only.
static double convex(double rho, double le, double unused)
{
    (void)unused;
    return rho * le;
}
static const char convex_is[] = "rho Le";

// Every ray hits a wall, so the radiance is the sum of the first `bounces` + 1 terms of a geometric
// series.
static double closed(double rho, double le, double bounces)
{
    return le * (1.0 - pow(rho, bounces + 1.0)) / (1.0 - rho);
}
static const char closed_is[] = "Le (1 - rho^(d+1)) / (1 - rho) for d bounces";

// Returns the radiance of the wall with a point light of intensity `le` in the centre of a sphere
// of radius 2. The wall's first reflection is (le / 2^2) rho / pi; the geometric series of closed()
// follows.
static double lamp_in_sphere(double rho, double le, double bounces)
{
    return rho / M_PI * le / 4.0 * (1.0 - pow(rho, bounces)) / (1.0 - rho);
}
static const char lamp_in_sphere_is[] =
    "(rho / pi) (I / R^2) (1 - rho^d) / (1 - rho) for d bounces";

// Returns the radiance under a point light at `distance`, 60 degrees off the normal.
static double lamp_above(double rho, double le, double distance)
{
    return rho / M_PI * le * 0.5 / (distance * distance);
}
static const char lamp_above_is[] = "rho I cos / (pi d^2)";

// Returns the radiance under a point light at 2 m with a range of 3 m (KHR_lights_punctual).
static double lamp_with_range(double rho, double le, double unused)
{
    (void)unused;
    return lamp_above(rho, le, 2.0) * (1.0 - pow(2.0 / 3.0, 4.0));
}
static const char lamp_with_range_is[] = "rho I cos / (pi d^2) (1 - (d / range)^4)";

static double sun_above(double rho, double le, double degrees)
{
    return rho / M_PI * le * cos(degrees * M_PI / 180.0);
}
static const char sun_above_is[] = "rho E cos / pi";

// Returns the radiance under a spot light 2 m above, whose axis misses the point by 10 degrees.
// `outer` is its outer cone angle in degrees; the inner angle is half of it (KHR_lights_punctual).
static double spot_above(double rho, double le, double outer)
{
    double degree = M_PI / 180.0, edge = cos(outer * degree);
    double falloff = (cos(10 * degree) - edge) / fmax(1e-3, cos(0.5 * outer * degree) - edge);
    falloff = fmin(fmax(falloff, 0.0), 1.0);
    return rho / M_PI * le / 4.0 * falloff * falloff;
}
static const char spot_above_is[] = "rho I / (pi d^2) clamp((cos - cos o) / (cos i - cos o))^2";

// Returns the radiance under a spot light with inner angle 0 and outer angle 0.5 degrees, whose
// axis misses the point by 0.25 degrees.
static double narrow_spot(double rho, double le, double unused)
{
    (void)unused;
    double degree = M_PI / 180.0;
    double falloff = (cos(0.25 * degree) - cos(0.5 * degree)) / 1e-3;
    return rho / M_PI * le / 4.0 * falloff * falloff;
}
static const char narrow_spot_is[] = "rho I / (pi d^2) ((cos - cos o) / 0.001)^2";

// Returns the radiance below a square of side 2, parallel to the surface element and centred above
// it. Its factor is four times B-3, the factor of a rectangle a x b with a corner above the
// element; here a = b = 1 / height.
static double square_above(double rho, double le, double height)
{
    double a = 1.0 / height, root = sqrt(1.0 + a * a);
    double corner = a / root * atan(a / root) / M_PI;
    return rho * le * 4.0 * corner;
}
static const char square_above_is[] = "rho Le F, factor B-3";

// The square lamps of the scenes with several lamps; none occludes another. A scene has the square
// at height 1 and the first few of these meshes. By default a surface point sends a shadow ray to
// each of up to five lamps; of six or more, the light tree selects one.
struct square_lamp {
    double x, y, z, side; // centre, and half of the side
    double emission;      // radiance relative to the other lamps
};
static const struct square_lamp square_lamps[] = {{3, 2, 0, 0.5, 2},
                                                  {-2.4, 1.5, 0, 0.4, 5},
                                                  {0, 1, 1.8, 0.3, 1},
                                                  {0, 2.5, -3.5, 0.8, 3},
                                                  {2, 1, 2.5, 0.25, 8}};

// Returns factor B-3 of a rectangle a x b at height 1.
static double corner_factor(double a, double b)
{
    double p = sqrt(1.0 + a * a), q = sqrt(1.0 + b * b);
    return (a / p * atan(b / p) + b / q * atan(a / q)) / (2.0 * M_PI);
}

static double lamps_above(double rho, double le, double meshes)
{
    double factor = square_above(1.0, 1.0, 1.0);
    for (size_t i = 0; i < (size_t)meshes; i++) {
        const struct square_lamp *lamp = &square_lamps[i];
        double x[2], z[2];
        for (int end = 0; end < 2; end++) {
            x[end] = (lamp->x + (2 * end - 1) * lamp->side) / lamp->y;
            z[end] = (lamp->z + (2 * end - 1) * lamp->side) / lamp->y;
        }
        factor += lamp->emission * (corner_factor(x[1], z[1]) - corner_factor(x[0], z[1]) -
                                    corner_factor(x[1], z[0]) + corner_factor(x[0], z[0]));
    }
    return rho * le * factor;
}
static const char lamps_above_is[] = "rho Le times the sum of factors B-3";

// Each lamp has eight triangles, two for each quarter of its area.
static bool add_square_lamps(struct scene *scene, double meshes, struct err *err)
{
    static const double corners[6][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}};
    for (size_t i = 0; i < (size_t)meshes; i++) {
        const struct square_lamp *lamp = &square_lamps[i];
        struct mesh *mesh = made_mesh_add(scene, 8, err);
        if (!mesh || !made_mesh_blacken(scene, mesh, lamp->emission, err))
            return false;
        for (uint32_t vertex = 0; vertex < 24; vertex++) {
            const double *corner = corners[vertex % 6];
            uint32_t quarter = vertex / 6;
            made_mesh_set(mesh, vertex, lamp->x + lamp->side * (corner[0] - (double)(quarter & 1)),
                          lamp->y, lamp->z + lamp->side * (corner[1] - (double)(quarter / 2)));
        }
    }
    return true;
}

// Returns the radiance below a disc of radius 1, parallel to the surface element and centred above
// it. The factor is the integral of 2 r h^2 / (r^2 + h^2)^2 dr over rings of radius r.
static double disc_above(double rho, double le, double height)
{
    return rho * le / (1.0 + height * height);
}
static const char disc_above_is[] = "rho Le R^2 / (R^2 + h^2)";

// Returns the radiance under a sphere of radius r = 1 completely above the horizon, at (d, d, 0).
// The factor is (r / d')^2 times the cosine of the angle to its centre, where d' = sqrt(2) d is the
// distance.
static double sphere_above(double rho, double le, double d)
{
    return rho * le / (2.0 * d * d) * sqrt(0.5);
}
static const char sphere_above_is[] = "rho Le (r / d)^2 cos";

// Returns the radiance for docs/verification.md, C15: a sphere of radius 1 touches the floor 5 cm
// away. It is completely above the horizon and fills almost half of the hemisphere. The factor is
// (r / d)^2 cos with cos = 1 / d.
static double touching_sphere(double rho, double le, double unused)
{
    (void)unused;
    return rho * le * pow(1.0 + 0.05 * 0.05, -1.5);
}
static const char touching_sphere_is[] = "rho Le (r / d)^2 cos";

// Returns the radiance for docs/verification.md, C14: a power of 1e8 W from a sphere of radius 1e-4
// (Le = power / (4 pi^2 r^2)) at the distance 1e4.
static double pinpoint(double rho, double le, double unused)
{
    (void)unused;
    return rho * le * 1e14 * 1e-16 * sqrt(0.5);
}
static const char pinpoint_is[] = "rho Le (r / d)^2 cos";

static double square_above(double rho, double le, double height);

// Returns the radiance under a square, a point light, a sun and a spot together.
static double all_lights(double rho, double le, double unused)
{
    (void)unused;
    return square_above(rho, le, 3.0) + lamp_above(rho, le, 2.0) + sun_above(rho, le, 60.0) +
           spot_above(rho, le, 60.0);
}
static const char all_lights_is[] = "the sum of B5 to B8";

static const double triangle[3][3] = {{-0.5, 0.25, 0.5}, {0.75, 0.5, 0.25}, {0.5, 1.5, -0.5}};

// Returns the radiance by Lambert's sum over the edges of a polygon completely above the horizon of
// a floor in y = 0 (Lambert 1760, "Photometria"): E = (Le / 2) |sum of beta_i cos gamma_i|. beta_i
// is the angle that edge i subtends at the origin, and gamma_i the angle between the floor's normal
// and the normal of the plane through the edge and the origin.
static double triangle_above(double rho, double le, double unused)
{
    (void)unused;
    double sum = 0.0;
    for (int i = 0; i < 3; i++) {
        const double *a = triangle[i], *b = triangle[(i + 1) % 3];
        double normal[3];
        vec3_cross(a, b, normal);
        double sine = vec3_norm(normal), cosine = vec3_dot(a, b);
        sum += atan2(sine, cosine) * normal[1] / sine;
    }
    return rho / M_PI * 0.5 * le * fabs(sum);
}
static const char triangle_above_is[] = "rho (Le / 2 pi) |sum of beta cos gamma|";

// Returns the mean radiance of one of two equal squares of side 1 at distance 1. The mean
// configuration factor is C-11 with X = Y = 1.
static double facing_squares(double rho, double le, double unused)
{
    (void)unused;
    double factor =
        2.0 / M_PI * (log(sqrt(4.0 / 3.0)) + 2.0 * sqrt(2.0) * atan(sqrt(0.5)) - 2.0 * atan(1.0));
    return rho * le * factor;
}
static const char facing_squares_is[] = "rho Le F, factor C-11";

// Returns the radiance of one of two infinite plates: L1 = Le + rho L2, L2 = rho L1.
static double plates(double rho, double le, double unused)
{
    (void)unused;
    return le / (1.0 - rho * rho);
}
static const char plates_is[] = "Le / (1 - rho^2)";

static double mirrors(double rho, double le, double count)
{
    return le * pow(rho, count);
}
static const char mirrors_is[] = "R^k Le for k mirrors";

// Returns the mean radiance of the image. Over the disc of the sphere the mean is (2/3) rho E / pi
// (Lambert's sphere at full phase), where E / pi = Le sin^2 of the light's angular radius. The disc
// fills pi / 2.2^2 of the image.
static double full_moon(double rho, double le, double light_radius)
{
    double mean = 2.0 / 3.0 * rho * le * light_radius * light_radius;
    return mean * M_PI / (2.2 * 2.2);
}
static const char full_moon_is[] = "(2/3) rho E / pi over the disc";

// Returns the radiance seen through layers of surfaces with opacity 0.3.
static double veiled(double rho, double le, double layers)
{
    (void)rho;
    return le * pow(0.7, layers);
}
static const char veiled_is[] = "Le (1 - a)^N";

static double veiled_square(double rho, double le, double layers)
{
    return square_above(rho, le, 1.0) * pow(0.7, layers);
}
static const char veiled_square_is[] = "rho Le F (1 - a)^N";

static double part_covered(double rho, double le, double part)
{
    (void)rho;
    return le * part;
}
static const char part_covered_is[] = "0.3 Le";

#define WHITE_BODY                                                                                 \
    {"albedo", "[0.8, 0.5, 0.2]"}, {"sky", "[1, 2, 4]"},                                           \
    {                                                                                              \
        "camera.fov_degrees", "5"                                                                  \
    }
#define COLORS                                                                                     \
    {"albedo", "[0.8, 0.5, 0.2]"},                                                                 \
    {                                                                                              \
        "emission", "[1, 2, 4]"                                                                    \
    }

// Defines a point light in the plane z = 0 above the point on the floor.
#define LAMP_AT(x, y) JSON({"type" : "point", "position" : [ x, y, 0 ], "intensity" : [ 1, 2, 4 ]})
#define SUN_FROM(x, y)                                                                             \
    JSON({"type" : "directional", "direction" : [ -x, -y, 0 ], "irradiance" : [ 1, 2, 4 ]})
#define SPOT(inner, outer)                                                                         \
    JSON({                                                                                         \
        "type" : "spot",                                                                           \
        "position" : [ 0, 2, 0 ],                                                                  \
        "intensity" : [ 1, 2, 4 ],                                                                 \
        "direction" : [ 0.17364817766693033, -0.984807753012208, 0 ],                              \
        "inner_degrees" : inner,                                                                   \
        "outer_degrees" : outer                                                                    \
    })

// clang-format off
#define SQUARE_AT_1                                                                                \
    {"light", JSON({"type": "quad", "material": "light", "corner": [-1, 1, 1], "u": [2, 0, 0],     \
                    "v": [0, 0, -2]})}
static const struct check_case forms[] = {
    FORM("B1 sky", "sky.json", sky, 0, EXACT, EACH_ALONE, {{0}}),

    FORM("B2 convex: sphere", "furnace_sky.json", convex, 0, WITHOUT_VARIANCE, EACH_ALONE,
     {WHITE_BODY}),
    FORM("B2 convex: disc", "furnace_sky.json", convex, 0, WITHOUT_VARIANCE, EACH_ALONE,
     {WHITE_BODY, {"shape", JSON({"type": "disc", "material": "white", "radius": 1,
                                  "normal": [1, 1, 2]})}}),
    FORM("B2 convex: box", "furnace_sky.json", convex, 0, WITHOUT_VARIANCE, EACH_ALONE,
     {WHITE_BODY, {"shape", JSON({"type": "box", "material": "white", "min": [-1, -1, -1],
                                  "max": [1, 1, 1]})}}),

    FORM("B3 glowing sphere, 0 bounces", "sphere_furnace.json", closed, 0, WITHOUT_VARIANCE,
     EACH_ALONE, {{"settings", JSON({"max_bounces": 0})}}),
    FORM("B3 glowing sphere, 1 bounce", "sphere_furnace.json", closed, 1, BY_STATISTICS,
     EACH_ALONE, {{"settings", JSON({"max_bounces": 1})}}),
    FORM("B3 glowing sphere, 2 bounces", "sphere_furnace.json", closed, 2, BY_STATISTICS,
     EACH_ALONE, {{"settings", JSON({"max_bounces": 2})}}),
    FORM("B3 glowing sphere, 9 bounces", "sphere_furnace.json", closed, 9, BY_STATISTICS,
     EACH_ALONE, {{0}}),
    FORM("B3 glowing sphere, all bounces", "sphere_furnace.json", closed, INFINITY, BY_STATISTICS,
     EACH_ALONE, {{"settings", JSON({"max_bounces": 1000})}}),
    FORM("B3 glowing room", "furnace.json", closed, 6, BY_STATISTICS, BSDF_ALONE,
     {COLORS, {"film", JSON({"width": 32, "height": 32})},
      {"settings", JSON({"max_bounces": 6, "roulette_min_bounces": "off"})}}),

    FORM("B4 lamp in a sphere, 1 bounce", "sphere_lamp.json", lamp_in_sphere, 1, WITHOUT_VARIANCE,
     NEE_ALONE, {{"settings", JSON({"max_bounces": 1})}}),
    LONG_FORM("B4 lamp in a sphere, all bounces", "sphere_lamp.json", lamp_in_sphere, INFINITY,
     BY_STATISTICS, NEE_ALONE, {{"settings", JSON({"max_bounces": 1000})}}),
    FORM("B5 lamp at 0.001", "floor_lamp.json", lamp_above, 1e-3, WITHOUT_VARIANCE, NEE_ALONE,
     {{"lamp", LAMP_AT(8.660254037844386e-4, 0.5e-3)}}),
    FORM("B5 lamp at 1", "floor_lamp.json", lamp_above, 1, WITHOUT_VARIANCE, NEE_ALONE,
     {{"lamp", LAMP_AT(0.8660254037844386, 0.5)}}),
    FORM("B5 lamp at 1000", "floor_lamp.json", lamp_above, 1e3, WITHOUT_VARIANCE, NEE_ALONE,
     {{"lamp", LAMP_AT(866.0254037844386, 500)}}),
    FORM("B5 lamp at 1000000", "floor_lamp.json", lamp_above, 1e6, WITHOUT_VARIANCE, NEE_ALONE,
     {{"lamp", LAMP_AT(866025.4037844386, 500000)}}),
    FORM("B5 lamp with a range", "floor_lamp.json", lamp_with_range, 0, WITHOUT_VARIANCE, NEE_ALONE,
     {{"lamp", JSON({"type": "point", "position": [1.7320508075688772, 1, 0],
                     "intensity": [1, 2, 4], "range": 3})}}),
    FORM("B6 sun at 60 degrees", "floor_lamp.json", sun_above, 60, WITHOUT_VARIANCE, NEE_ALONE,
     {{"lamp", SUN_FROM(0.8660254037844386, 0.5)}}),
    FORM("B6 sun at 89 degrees", "floor_lamp.json", sun_above, 89, WITHOUT_VARIANCE, NEE_ALONE,
     {{"lamp", SUN_FROM(0.9998476951563913, 0.01745240643728351)}}),
    FORM("B7 spot, on the slope", "floor_lamp.json", spot_above, 15, WITHOUT_VARIANCE, NEE_ALONE,
     {{"lamp", SPOT(7.5, 15)}}),
    FORM("B7 spot, inside", "floor_lamp.json", spot_above, 30, WITHOUT_VARIANCE, NEE_ALONE,
     {{"lamp", SPOT(15, 30)}}),
    FORM("B7 spot, outside", "floor_lamp.json", spot_above, 9, WITHOUT_VARIANCE, NEE_ALONE,
     {{"lamp", SPOT(4.5, 9)}}),
    FORM("B7 narrow spot", "floor_lamp.json", narrow_spot, 0, WITHOUT_VARIANCE, NEE_ALONE,
     {{"lamp", JSON({"type": "spot", "position": [0, 2, 0], "intensity": [1, 2, 4],
                     "direction": [0.004363309284746571, -0.999990480720734, 0],
                     "inner_degrees": 0, "outer_degrees": 0.5})}}),
    LONG_FORM("B5 to B8 together", "floor_light.json", all_lights, 0, BY_STATISTICS, NEE_ALONE,
     {{"light", JSON({"type": "quad", "material": "light", "corner": [-1, 3, 1], "u": [2, 0, 0],
                      "v": [0, 0, -2]})},
      {"lights", "[" LAMP_AT(1.7320508075688772, 1) "," SUN_FROM(0.8660254037844386, 0.5) ","
                 SPOT(30, 60) "]"}}),
    FORM("C14 pinpoint of 1e8 W", "floor_light.json", pinpoint, 0, WITHOUT_VARIANCE, NEE_ALONE,
     {{"light", JSON({"type": "sphere", "material": "light", "radius": 1e-4,
                      "center": [7071.0678118654752, 7071.0678118654752, 0]})},
      {"emission", "[1e14, 2e14, 4e14]"}}),

    FORM("B8 square at 1", "floor_light.json", square_above, 1, BY_STATISTICS, EACH_ALONE,
     {{"light", JSON({"type": "quad", "material": "light", "corner": [-1, 1, 1], "u": [2, 0, 0],
                      "v": [0, 0, -2]})}}),
    FORM("B8 five lamps, four of them meshes", "floor_light.json", lamps_above, 4, BY_STATISTICS,
     EACH_ALONE, {SQUARE_AT_1}, 0, add_square_lamps),
    FORM("B8 six lamps, five of them meshes", "floor_light.json", lamps_above, 5, BY_STATISTICS,
     EACH_ALONE, {SQUARE_AT_1}, 0, add_square_lamps),
    FORM("B9 square at 0.001", "floor_light.json", square_above, 1e-3, BY_STATISTICS, BSDF_ALONE,
     {{"light", JSON({"type": "quad", "material": "light", "corner": [-1, 1e-3, 1], "u": [2, 0, 0],
                      "v": [0, 0, -2]})}}),
    FORM("B9 square at 1000", "floor_light.json", square_above, 1e3, BY_STATISTICS, NEE_ALONE,
     {{"light", JSON({"type": "quad", "material": "light", "corner": [-1, 1e3, 1], "u": [2, 0, 0],
                      "v": [0, 0, -2]})}}),

    FORM("B10 disc at 1", "floor_light.json", disc_above, 1, BY_STATISTICS, EACH_ALONE,
     {{"light", JSON({"type": "disc", "material": "light", "center": [0, 1, 0],
                      "normal": [0, -1, 0], "radius": 1})}}),
    FORM("B10 disc at 0.25", "floor_light.json", disc_above, 0.25, BY_STATISTICS, EACH_ALONE,
     {{"light", JSON({"type": "disc", "material": "light", "center": [0, 0.25, 0],
                      "normal": [0, 1, 0], "radius": 1})}}),

    FORM("B11 sphere at 2", "floor_light.json", sphere_above, 2, BY_STATISTICS, EACH_ALONE,
     {{"light", JSON({"type": "sphere", "material": "light", "center": [2, 2, 0], "radius": 1})}}),
    FORM("B11 sphere at 10000", "floor_light.json", sphere_above, 1e4, BY_STATISTICS, NEE_ALONE,
     {{"light", JSON({"type": "sphere", "material": "light", "center": [1e4, 1e4, 0],
                      "radius": 1})}}),
    FORM("C15 sphere that touches", "floor_light.json", touching_sphere, 0, BY_STATISTICS,
     EACH_ALONE,
     {{"light", JSON({"type": "sphere", "material": "light", "center": [0.05, 1, 0],
                      "radius": 1})}}),

    FORM("B12 triangle", "floor_light.json", triangle_above, 0, BY_STATISTICS, EACH_ALONE,
     {{"light", JSON({"type": "quad", "material": "light", "vertices": [
                      [-0.5, 0.25, 0.5], [0.75, 0.5, 0.25], [0.5, 1.5, -0.5], [0.5, 1.5, -0.5]]})}}),

    FORM("B13 facing squares", "facing_squares.json", facing_squares, 0, BY_STATISTICS, EACH_ALONE,
     {{0}}),

    LONG_FORM("B14 parallel plates", "plates.json", plates, 0, BY_STATISTICS, BSDF_ALONE, {{0}}),

    FORM("B15 corridor, 1 mirror", "mirror_corridor.json", mirrors, 1, WITHOUT_VARIANCE,
     EACH_ALONE, {{"end", "[1, 0, 0]"}}),
    FORM("B15 corridor, 40 mirrors", "mirror_corridor.json", mirrors, 40, WITHOUT_VARIANCE,
     EACH_ALONE, {{"end", "[40, 0, 0]"}}),
    FORM("B15 corridor, 4 mirrors, roulette", "mirror_corridor.json", mirrors, 4, BY_STATISTICS,
     EACH_ALONE, {{"end", "[4, 0, 0]"}, {"settings", "{}"}}),

    FORM("B23 full moon", "full_moon.json", full_moon, 1e-3, BY_STATISTICS, NEE_ALONE, {{0}}),

    LONG_FORM("B26 three veils", "alpha_layers.json", veiled, 3, BY_STATISTICS, EACH_ALONE, {{0}}),
    FORM("B26 three masks, not there", "alpha_layers.json", veiled, 0, EXACT, EACH_ALONE,
     {{"alpha", "\"mask\""}}),
    LONG_FORM("B26 two veils before a light", "alpha_shadow.json", veiled_square, 2, BY_STATISTICS,
     EACH_ALONE, {{0}}),
    FORM("B26 two masks before a light", "alpha_shadow.json", veiled_square, 0, BY_STATISTICS,
     EACH_ALONE, {{"alpha", "\"mask\""}}),

    FORM("B27 level edge", "edge.json", part_covered, 0.3, BY_STATISTICS, EACH_ALONE, {{0}}),
    LONG_FORM("B27 upright edge", "edge.json", part_covered, 0.3, BY_STATISTICS, EACH_ALONE,
     {{"film", JSON({"width": 1, "height": 1024})}, {"camera.sensor_height_mm", "2048"},
      {"turn", JSON({"rotate": {"axis": [0, 0, 1], "degrees": 90}})}}),
};
// clang-format on

CHECK_GROUP(check_light, "light", "lights, furnaces, mirrors and veils whose radiance is known",
            forms);
