// Defines cases of analytic shapes in scenes with known radiance: closed furnaces of every shape
// and scale, irradiance of a floor from emissive shapes, infinite planes and huge spheres as
// ground, and views from inside glass and fog.
#include "base/maths.h"
#include "check/case_list.h"
#include "check/closed_form.h"
#include <math.h>

// --- the forms ----------------------------------------------------------------------------------

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

// Returns the radiance of one of two infinite planes that face each other; the lower plane emits.
static double plates(double rho, double le, double unused)
{
    (void)unused;
    return le / (1.0 - rho * rho);
}
static const char plates_is[] = "Le / (1 - rho^2)";

static double sun_above(double rho, double le, double degrees)
{
    return rho / M_PI * le * cos(degrees * M_PI / 180.0);
}
static const char sun_above_is[] = "rho E cos / pi";

// Returns the radiance below a square of side 2, centred above the point: four times factor B-3 of
// Howell's catalogue.
static double square_above(double rho, double le, double height)
{
    double a = 1.0 / height, root = sqrt(1.0 + a * a);
    return rho * le * 4.0 * a / root * atan(a / root) / M_PI;
}
static const char square_above_is[] = "rho Le F, factor B-3";

// Returns Lambert's sum over the edges of a parallelogram above the horizon of a floor in y = 0, as
// a fraction of pi Le. The sign tells which side of the parallelogram faces the origin.
static double parallelogram(const double center[3], const double u[3], const double v[3])
{
    double corners[4][3], sum = 0.0;
    for (int i = 0; i < 3; i++) {
        corners[0][i] = center[i] - u[i] - v[i];
        corners[1][i] = center[i] + u[i] - v[i];
        corners[2][i] = center[i] + u[i] + v[i];
        corners[3][i] = center[i] - u[i] + v[i];
    }
    for (int i = 0; i < 4; i++) {
        double normal[3];
        vec3_cross(corners[i], corners[(i + 1) % 4], normal);
        double sine = sqrt(vec3_dot(normal, normal));
        sum += atan2(sine, vec3_dot(corners[i], corners[(i + 1) % 4])) * normal[1] / sine;
    }
    return 0.5 * sum / M_PI;
}

// Returns the radiance under a box with half edges (0.9, 0.5, 1.4), rotated by 30 degrees about z,
// at (1, 1.5, 0.5). The factor is the sum over the faces that face the origin.
static double box_above(double rho, double le, double unused)
{
    (void)unused;
    double c = cos(M_PI / 6), s = sin(M_PI / 6), factor = 0.0;
    const double center[3] = {1, 1.5, 0.5};
    const double axes[3][3] = {{0.9 * c, 0.9 * s, 0}, {-0.5 * s, 0.5 * c, 0}, {0, 0, 1.4}};
    for (int face = 0; face < 6; face++) {
        double at[3], sign = face < 3 ? 1 : -1;
        for (int i = 0; i < 3; i++)
            at[i] = center[i] + sign * axes[face % 3][i];
        if (sign * vec3_dot(at, axes[face % 3]) < 0)
            factor += fabs(parallelogram(at, axes[(face + 1) % 3], axes[(face + 2) % 3]));
    }
    return rho * le * factor;
}
static const char box_above_is[] = "rho (Le / 2 pi) sum of beta cos gamma";

// Returns the configuration factor, for the floor at the origin, of a small piece of surface at p.
// `normal` is its outward unit normal times its area.
static double piece(const double p[3], const double normal[3])
{
    double square = vec3_dot(p, p), away = -vec3_dot(p, normal);
    return away > 0 && p[1] > 0 ? away * p[1] / (M_PI * square * square) : 0.0;
}

#define STEPS 600

// Returns the radiance under a closed cylinder of radius 0.8 about the axis from (1, 1, -1) to
// (1.5, 2, 1). The factor is computed by the midpoint rule over the side and the caps.
static double cylinder_above(double rho, double le, double unused)
{
    (void)unused;
    const double center[3] = {1.25, 1.5, 0}, half[3] = {0.25, 0.5, 1}, radius = 0.8;
    double length = sqrt(vec3_dot(half, half)), axis[3], x[3], y[3], factor = 0.0;
    for (int i = 0; i < 3; i++)
        axis[i] = half[i] / length;
    vec3_cross(axis, (double[3]){1, 0, 0}, x);
    double norm = sqrt(vec3_dot(x, x));
    for (int i = 0; i < 3; i++)
        x[i] /= norm;
    vec3_cross(axis, x, y);
    for (int a = 0; a < STEPS; a++) {
        double angle = 2 * M_PI * (a + 0.5) / STEPS;
        for (int b = 0; b < STEPS; b++) {
            double along = 2 * (b + 0.5) / STEPS - 1, ring = radius * (b + 0.5) / STEPS;
            double wall = 2 * length / STEPS * 2 * M_PI * radius / STEPS;
            double cap = radius / STEPS * ring * 2 * M_PI / STEPS;
            double p[3], caps[2][3], outward[3], up[3], down[3];
            for (int i = 0; i < 3; i++) {
                double across = cos(angle) * x[i] + sin(angle) * y[i];
                p[i] = center[i] + along * half[i] + radius * across;
                caps[0][i] = center[i] + half[i] + ring * across;
                caps[1][i] = center[i] - half[i] + ring * across;
                outward[i] = wall * across;
                up[i] = cap * axis[i];
                down[i] = -cap * axis[i];
            }
            factor += piece(p, outward) + piece(caps[0], up) + piece(caps[1], down);
        }
    }
    return rho * le * factor;
}
static const char cylinder_above_is[] = "rho Le F by quadrature";

// Returns the radiance below an upright open cylinder of radius 1 from height 1 to 3. The inside of
// its wall is visible between the directions to its lower and its upper rim.
static double tube_above(double rho, double le, double unused)
{
    (void)unused;
    return rho * le * (0.5 - 0.1);
}
static const char tube_above_is[] = "rho Le (F of a disc - F of another)";

// Returns the radiance under a disc of radius 0.5, so close that it almost fills the hemisphere.
static double touching(double rho, double le, double gap)
{
    return rho * le * 0.25 / (0.25 + gap * gap);
}
static const char touching_is[] = "rho Le R^2 / (R^2 + h^2)";

// Returns the radiance inside glass; `part` is the square of the index of refraction.
static double all(double rho, double le, double part)
{
    (void)rho;
    return part * le;
}
static const char all_is[] = "Le times a known factor";

// Returns the radiance seen through fog (index of refraction 1) with the transmittance rho per
// metre.
static double fog(double rho, double le, double metres)
{
    return le * pow(rho, metres);
}
static const char fog_is[] = "Le exp(-sigma length)";

// --- the scenes ---------------------------------------------------------------------------------

// The camera is inside of a room that extends by the argument of BOX, SPHERE, CYLINDER or PIPE in
// each direction. These macros define the camera and the room's shapes.
// clang-format off
#define EYE(x, y, z)                                                                               \
    {"camera", JSON({"position": [x, y, z], "direction": [0.3, -0.2, -1], "fov_degrees": 90})}
#define ROOM(...) {"shapes", "[" JSON(__VA_ARGS__) "]"}
#define NEAR(x, y, z, ...) EYE(x, y, z), ROOM(__VA_ARGS__)
#define BOX(a) {"type": "box", "material": "glowing", "as": "analytic", "min": [-a, -a, -a],       \
    "max": [a, a, a]}
#define SPHERE(a) {"type": "sphere", "material": "glowing", "radius": a}
#define CYLINDER(a) {"type": "cylinder", "material": "glowing", "radius": a, "from": [0, -a, 0],   \
    "to": [0, a, 0]}
// Defines an open cylinder that is closed by two discs.
#define PIPE(a) {"type": "cylinder", "material": "glowing", "radius": a, "from": [-a, 0, 0],       \
    "to": [a, 0, 0], "caps": "${open}"},                                                               \
    {"type": "disc", "material": "glowing", "radius": a, "center": [a, 0, 0], "normal": [1, 0, 0]},\
    {"type": "disc", "material": "glowing", "radius": a, "center": [-a, 0, 0], "normal": [1, 0, 0]}
#define SIDE(x, y, z, a, b, c, d, e, f) {"type": "quad", "material": "glowing", "as": "analytic",  \
    "corner": [x, y, z], "u": [a, b, c], "v": [d, e, f]}
// Defines the sides of a room, some of which have the opposite orientation.
#define SIDES                                                                                      \
    SIDE(-1, -1, -1, 2, 0, 0, 0, 2, 0), SIDE(-1, -1, 1, 2, 0, 0, 0, 2, 0),                         \
    SIDE(-1, -1, -1, 0, 0, 2, 2, 0, 0), SIDE(-1, 1, -1, 2, 0, 0, 0, 0, 2),                         \
    SIDE(-1, -1, -1, 0, 2, 0, 0, 0, 2), SIDE(1, -1, -1, 0, 0, 2, 0, 2, 0)
#define PLANE(x, y, z) {"type": "plane", "material": "glowing", "point": [x, y, z],                \
    "normal": [x, y, z]}
#define PLANES PLANE(1, 0, 0), PLANE(-1, 0, 0), PLANE(0, 1, 0), PLANE(0, -1, 0), PLANE(0, 0, 1),   \
    PLANE(0, 0, -1)
#define TWO_BOUNCES {"settings", JSON({"max_bounces": 2})}
#define OPEN {"define.open", "false"}
#define NO_LIGHT {"light", "0"}
#define ROOM_FILE "sphere_furnace.json"
#define FLOOR_FILE "floor_light.json"
#define LIGHT(...) {"light", JSON(__VA_ARGS__)}
// The light is closer to the floor than the camera of the file is, so this camera is placed between
// the floor and the light.
#define SQUEEZED {"camera", JSON({"position": [0, 2e-5, 0], "direction": [0, -1, 0],               \
    "up": [0, 0, 1], "fov_degrees": 5e-5})}
#define GROUND(...) {"shapes", "[" JSON(__VA_ARGS__) "]"}
#define SKY {"environment", JSON({"radiance": [1, 2, 4]})}
#define STANDING(height, fov) {"camera", JSON({"position": [0, height, 0],                         \
    "target": [0, 0, -10], "fov_degrees": fov})}
#define HUGE_BALL(r) {"type": "sphere", "material": "plane", "radius": r, "center": [0, -r, 0]}
#define LOWER {"type": "plane", "material": "lower", "normal": [0, 1, 0]}
#define UPPER {"type": "plane", "material": "upper", "normal": [0, 1, 0], "point": [0, 1, 0]}

static const struct check_case rooms[] = {
    FORM("B3 box", ROOM_FILE, closed, 2, BY_STATISTICS, EACH_ALONE,
     {NEAR(0.3, -0.2, 0.4, BOX(1)), TWO_BOUNCES}),
    FORM("C1 box of 1e-6", ROOM_FILE, closed, 2, BY_STATISTICS, EACH_ALONE,
     {NEAR(3e-7, -2e-7, 4e-7, BOX(1e-6)), TWO_BOUNCES}),
    FORM("C1 box of 1e6", ROOM_FILE, closed, 2, BY_STATISTICS, EACH_ALONE,
     {NEAR(3e5, -2e5, 4e5, BOX(1e6)), TWO_BOUNCES}),
    FORM("B3 cylinder", ROOM_FILE, closed, 2, BY_STATISTICS, EACH_ALONE,
     {NEAR(0.3, -0.2, 0.4, CYLINDER(1)), TWO_BOUNCES}),
    LONG_FORM("C1 cylinder of 1e-6", ROOM_FILE, closed, 2, BY_STATISTICS, EACH_ALONE,
     {NEAR(3e-7, -2e-7, 4e-7, CYLINDER(1e-6)), TWO_BOUNCES}),
    LONG_FORM("C1 cylinder of 1e6", ROOM_FILE, closed, 2, BY_STATISTICS, EACH_ALONE,
     {NEAR(3e5, -2e5, 4e5, CYLINDER(1e6)), TWO_BOUNCES}),
    LONG_FORM("B3 tube and discs", ROOM_FILE, closed, 2, BY_STATISTICS, EACH_ALONE,
     {NEAR(0.3, -0.2, 0.4, PIPE(1)), TWO_BOUNCES, OPEN}),
    LONG_FORM("C1 tube and discs of 1e-6", ROOM_FILE, closed, 2, BY_STATISTICS, EACH_ALONE,
     {NEAR(3e-7, -2e-7, 4e-7, PIPE(1e-6)), TWO_BOUNCES, OPEN}),
    LONG_FORM("C1 tube and discs of 1e6", ROOM_FILE, closed, 2, BY_STATISTICS, EACH_ALONE,
     {NEAR(3e5, -2e5, 4e5, PIPE(1e6)), TWO_BOUNCES, OPEN}),
    FORM("C1 sphere of 1e-6", ROOM_FILE, closed, 2, BY_STATISTICS, EACH_ALONE,
     {NEAR(3e-7, -2e-7, 4e-7, SPHERE(1e-6)), TWO_BOUNCES}),
    FORM("C1 sphere of 1e6", ROOM_FILE, closed, 2, BY_STATISTICS, EACH_ALONE,
     {NEAR(3e5, -2e5, 4e5, SPHERE(1e6)), TWO_BOUNCES}),
    FORM("C27 quads", ROOM_FILE, closed, 2, BY_STATISTICS, EACH_ALONE,
     {NEAR(0.3, -0.2, 0.4, SIDES), TWO_BOUNCES}),
    FORM("C2 box at 1e5", ROOM_FILE, closed, 2, BY_STATISTICS, EACH_ALONE,
     {NEAR(100000.3, 99999.8, -99999.6, {"type": "box", "material": "glowing", "as": "analytic",
      "min": [99999, 99999, -100001], "max": [100001, 100001, -99999]}), TWO_BOUNCES}),
    FORM("C2 cylinder at 4e6", ROOM_FILE, closed, 2, BY_STATISTICS, EACH_ALONE,
     {NEAR(4000000.3, 3999999.8, -3999999.6, {"type": "cylinder", "material": "glowing", "radius": 1,
      "from": [4e6, 3999999, -4e6], "to": [4e6, 4000001, -4e6]}), TWO_BOUNCES}),
    FORM("B3 planes", ROOM_FILE, closed, 2, BY_STATISTICS, BSDF_ALONE,
     {NEAR(0.3, -0.2, 0.4, PLANES), TWO_BOUNCES}),    LONG_FORM("B3 box, all bounces", ROOM_FILE, closed, INFINITY, BY_STATISTICS, EACH_ALONE,
     {NEAR(0.3, -0.2, 0.4, BOX(1)), {"settings", JSON({"max_bounces": 1000})}}),
};

static const struct check_case lights[] = {
    FORM("B8 analytic square at 1", FLOOR_FILE, square_above, 1, BY_STATISTICS, EACH_ALONE,
     {LIGHT({"type": "quad", "as": "analytic", "material": "light", "corner": [-1, 1, 1],
             "u": [2, 0, 0], "v": [0, 0, -2]})}),
    FORM("B9 analytic square at 0.001", FLOOR_FILE, square_above, 1e-3, BY_STATISTICS, BSDF_ALONE,
     {LIGHT({"type": "quad", "as": "analytic", "material": "light", "corner": [-1, 1e-3, 1],
             "u": [2, 0, 0], "v": [0, 0, -2]})}),
    FORM("B9 analytic square at 1000", FLOOR_FILE, square_above, 1e3, BY_STATISTICS, NEE_ALONE,
     {LIGHT({"type": "quad", "as": "analytic", "material": "light", "corner": [-1, 1e3, 1],
             "u": [2, 0, 0], "v": [0, 0, -2]})}),
    LONG_FORM("B12 box", FLOOR_FILE, box_above, 0, BY_STATISTICS, EACH_ALONE,
     {LIGHT({"type": "box", "as": "analytic", "material": "light", "min": [-0.9, -0.5, -1.4],
             "max": [0.9, 0.5, 1.4], "transform": [{"rotate": {"axis": [0, 0, 1], "degrees": 30}},
             {"translate": [1, 1.5, 0.5]}]})}),
    LONG_FORM("B12 tube", FLOOR_FILE, tube_above, 0, BY_STATISTICS, EACH_ALONE,
     {OPEN, NO_LIGHT, GROUND({"type": "disc", "material": "floor", "radius": 2, "normal": [0, 1, 0]},
      {"type": "cylinder", "caps": "${open}", "material": "light", "radius": 1, "from": [0, 1, 0],
       "to": [0, 3, 0]})}),

    FORM("C3 cylinder over a box", FLOOR_FILE, touching, 4e-5, BY_STATISTICS, BSDF_ALONE,
     {SQUEEZED, NO_LIGHT, GROUND({"type": "box", "as": "analytic", "material": "floor", "min": [-1, -1, -1],
      "max": [1, 0, 1]}, {"type": "cylinder", "material": "light", "radius": 0.5,
      "from": [0, 4e-5, 0], "to": [0, 1, 0]})}),
    FORM("C3 disc over a cylinder", FLOOR_FILE, touching, 4e-5, BY_STATISTICS, BSDF_ALONE,
     {SQUEEZED, NO_LIGHT, GROUND({"type": "cylinder", "material": "floor", "radius": 1, "from": [0, -1, 0],
      "to": [0, 0, 0]}, {"type": "disc", "material": "light", "radius": 0.5,
      "center": [0, 4e-5, 0], "normal": [0, 1, 0]})}),
    FORM("C3 plane over a quad", FLOOR_FILE, convex, 0, BY_STATISTICS, BSDF_ALONE,
     {SQUEEZED, NO_LIGHT, GROUND({"type": "quad", "as": "analytic", "material": "floor", "corner": [-1, 0, -1],
      "u": [2, 0, 0], "v": [0, 0, 2]}, {"type": "plane", "material": "light", "normal": [0, 1, 0],
      "point": [0, 4e-5, 0]})}),    LONG_FORM("B12 cylinder", FLOOR_FILE, cylinder_above, 0, BY_STATISTICS, EACH_ALONE,
     {LIGHT({"type": "cylinder", "material": "light", "radius": 0.8, "from": [1, 1, -1],
             "to": [1.5, 2, 1]})}),
};

static const struct check_case grounds[] = {
    FORM("B14 planes", "plates.json", plates, 0, BY_STATISTICS, BSDF_ALONE, {GROUND(LOWER, UPPER)}),
    FORM("B2 plane under a sky", "plane.json", convex, 0, BY_STATISTICS, EACH_ALONE,
     {SKY, STANDING(2, 5), GROUND({"type": "plane", "material": "plane", "normal": [0, 1, 0]})}),
    FORM("B2 plane on edge at 1e5", "plane.json", convex, 0, BY_STATISTICS, EACH_ALONE,
     {SKY, {"camera", JSON({"position": [100001, 5e4, 7], "target": [1e5, 50001, 8],
      "fov_degrees": 5})}, GROUND({"type": "plane", "material": "plane", "normal": [1, 0, 0],
      "point": [1e5, 0, 0]})}),
    FORM("B6 sun on a plane", FLOOR_FILE, sun_above, 60, WITHOUT_VARIANCE, NEE_ALONE,
     {STANDING(2, 5), NO_LIGHT, GROUND({"type": "plane", "material": "floor", "normal": [0, 1, 0]}),
      {"lights", JSON([{"type": "directional", "irradiance": [1, 2, 4],
      "direction": [-0.8660254037844386, -0.5, 0]}])}}),
    FORM("C13 ground sphere of 1e6", "plane.json", convex, 0, BY_STATISTICS, EACH_ALONE,
     {SKY, STANDING(2, 5), GROUND(HUGE_BALL(1e6))}),
    FORM("C13 ground sphere of 1e4", "plane.json", convex, 0, BY_STATISTICS, EACH_ALONE,
     {SKY, STANDING(2, 5), GROUND(HUGE_BALL(1e4))}),};

#define MEDIA_FILE "media.json"
#define GLASS {"body", JSON({"type": "dielectric", "ior": 1.5})}
#define FOG {"body", JSON({"type": "dielectric", "ior": 1,                                         \
    "absorption": {"color": [0.8, 0.5, 0.2], "distance": 1}})}
#define BODIES(...) {"bodies", "[" JSON(__VA_ARGS__) "]"}
#define LOOKING(x, y, z) {"from", "[0.2, 0.1, 0.1]"}, {"towards", JSON([x, y, z])}, {"fov", "20"}
#define THIN {"fov", "1e-5"}
#define WALL(x, y, z, a, b, c, d, e, f) {"type": "quad", "material": "body", "as": "analytic",     \
    "corner": [x, y, z], "u": [a, b, c], "v": [d, e, f]}

static const struct check_case bodies[] = {
    FORM("B21 camera in a box of glass", MEDIA_FILE, all, 2.25, WITHOUT_VARIANCE, 0,
     {GLASS, LOOKING(1, 0, 0), BODIES({"type": "box", "as": "analytic", "material": "body",
      "min": [-1, -1, -1], "max": [1, 1, 1]})}),
    FORM("B21 camera in a cylinder of glass", MEDIA_FILE, all, 2.25, WITHOUT_VARIANCE, 0,
     {GLASS, LOOKING(0, 0, 1), BODIES({"type": "cylinder", "material": "body", "radius": 1,
      "from": [0, 0, -1], "to": [0, 0, 1]})}),
    FORM("B21 camera in walls of glass", MEDIA_FILE, all, 2.25, WITHOUT_VARIANCE, 0,
     {GLASS, LOOKING(0, 0, 1), BODIES(
      WALL(-1, -1, 1, 2, 0, 0, 0, 2, 0), WALL(-1, -1, -1, 0, 2, 0, 2, 0, 0),
      WALL(1, -1, -1, 0, 2, 0, 0, 0, 2), WALL(-1, -1, -1, 0, 0, 2, 0, 2, 0),
      WALL(-1, 1, -1, 0, 0, 2, 2, 0, 0), WALL(-1, -1, -1, 2, 0, 0, 0, 0, 2))}),
    FORM("B19 camera in fog behind a plane", MEDIA_FILE, fog, 1.5, WITHOUT_VARIANCE, 0,
     {FOG, THIN, {"from", "[-1.5, 1, 2]"}, {"towards", "[1, 0, 0]"},
      BODIES({"type": "plane", "material": "body", "normal": [1, 0, 0]})}),
    FORM("B19 camera before fog", MEDIA_FILE, fog, 0, WITHOUT_VARIANCE, 0,
     {FOG, THIN, {"from", "[1.5, 1, 2]"}, {"towards", "[1, 0, 0]"},
      BODIES({"type": "plane", "material": "body", "normal": [1, 0, 0]})}),
    FORM("B19 box of fog", MEDIA_FILE, fog, 2, WITHOUT_VARIANCE, 0,
     {FOG, THIN, BODIES({"type": "box", "as": "analytic", "material": "body", "min": [-1, -1, -1],
      "max": [1, 1, 1]})}),
    FORM("B19 cylinder of fog at 0.6", MEDIA_FILE, fog, 1.6, WITHOUT_VARIANCE, 0,
     {FOG, THIN, {"from", "[0.6, 0, 4]"}, BODIES({"type": "cylinder", "material": "body",
      "radius": 1, "from": [0, -1, 0], "to": [0, 1, 0]})}),};

// clang-format on

CHECK_GROUP(check_rooms, "rooms", "closed emissive rooms of every shape and size", rooms);

CHECK_GROUP(check_lamps, "lamps", "emissive shapes above a floor", lights);

CHECK_GROUP(check_grounds, "grounds", "infinite planes and huge spheres as ground", grounds);

CHECK_GROUP(check_bodies, "bodies", "views from inside of and through shapes of glass and fog",
            bodies);
