// Defines cases of distance fields in scenes with known radiance, and beside analytic shapes of the
// same form: closed rooms, convex bodies under a constant environment, glass and fog.
#include "check/case_list.h"
#include "check/closed_form.h"
#include <math.h>

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

// Defines a room that is an emissive distance field, with the camera inside.
// clang-format off
#define ROOM(x, y, z, ...)                                                                         \
    {"camera", JSON({"position": [x, y, z], "direction": [0.3, -0.2, -1], "fov_degrees": 90})},    \
    {"shapes", "[{\"type\": \"sdf\", \"material\": \"glowing\", " JSON(__VA_ARGS__) "}]"},         \
    {"settings", JSON({"max_bounces": 2})}
#define ROOM_FILE "sphere_furnace.json"
#define BODY(...)                                                                                  \
    {"camera", JSON({"position": [0, 2, 0], "target": [0, 0, -3], "fov_degrees": 5})},             \
    {"environment", JSON({"radiance": [1, 2, 4]})},                                                \
    {"shapes", "[{\"type\": \"sdf\", \"material\": \"plane\", " JSON(__VA_ARGS__) "}]"}
#define BODY_FILE "plane.json"
#define MEDIUM(...) {"bodies", "[{\"type\": \"sdf\", \"material\": \"body\", " JSON(__VA_ARGS__) "}]"}
#define MEDIUM_FILE "media.json"

static const struct check_case forms[] = {
    FORM("B3 field sphere", ROOM_FILE, closed, 2, BY_STATISTICS, BSDF_ALONE,
     {ROOM(0.3, -0.2, 0.4, "field": {"type": "sphere", "radius": 1})}),
    FORM("C1 field sphere of 1e-6", ROOM_FILE, closed, 2, BY_STATISTICS, BSDF_ALONE,
     {ROOM(3e-7, -2e-7, 4e-7, "field": {"type": "sphere", "radius": 1e-6})}),
    FORM("C1 field sphere of 1e6", ROOM_FILE, closed, 2, BY_STATISTICS, BSDF_ALONE,
     {ROOM(3e5, -2e5, 4e5, "field": {"type": "sphere", "radius": 1e6})}),
    FORM("C2 field sphere at 1e5", ROOM_FILE, closed, 2, BY_STATISTICS, BSDF_ALONE,
     {ROOM(100000.3, 99999.8, -99999.6, "field": {"type": "sphere", "radius": 1},
           "transform": {"translate": [1e5, 1e5, -1e5]})}),
    FORM("B3 field box, turned and mirrored", ROOM_FILE, closed, 2, BY_STATISTICS, BSDF_ALONE,
     {ROOM(0.3, -0.2, 0.4, "field": {"type": "box", "size": [1, 1.5, 1.2]}, "transform":
           [{"scale": [2, -2, 2]}, {"rotate": {"axis": [1, 2, 3], "degrees": 40}}])}),
    LONG_FORM("B3 field of smooth joints", ROOM_FILE, closed, 2, BY_STATISTICS, BSDF_ALONE,
     {ROOM(0.3, -0.2, 0.4, "field": {"type": "union", "smooth": 0.3, "of": [
           {"type": "sphere", "radius": 1}, {"type": "torus", "radius": 1, "tube": 0.5},
           {"type": "capsule", "from": [0, -2, 0], "to": [0, 2, 0], "radius": 0.5}]})}),
    LONG_FORM("B3 field twisted", ROOM_FILE, closed, 2, BY_STATISTICS, BSDF_ALONE,
     {ROOM(0.3, -0.2, 0.4, "field": {"type": "twist", "degrees": 60, "of":
           {"type": "box", "size": [1.6, 2, 1.6], "round": 0.2}})}),
    LONG_FORM("B3 field of metaballs", ROOM_FILE, closed, 2, BY_STATISTICS, BSDF_ALONE,
     {ROOM(0.1, -0.1, 0.1, "field": {"type": "metaballs", "balls": [[0, 0, 0, 1],
           [0.6, 0, 0, 1], [0, 0.7, 0.2, 0.8]]})}),
    FORM("B2 field sphere under a sky", BODY_FILE, convex, 0, BY_STATISTICS, EACH_ALONE,
     {BODY("field": {"type": "sphere", "radius": 50}, "transform": {"translate": [0, -50, 0]})}),
    FORM("B2 field plane under a sky", BODY_FILE, convex, 0, BY_STATISTICS, EACH_ALONE,
     {BODY("field": {"type": "plane", "normal": [0, 1, 0]},
           "bounds": {"min": [-9, -1, -9], "max": [9, 1, 9]})}),
    FORM("B21 camera in a field of glass", MEDIUM_FILE, all, 2.25, WITHOUT_VARIANCE, 0,
     {{"body", JSON({"type": "dielectric", "ior": 1.5})}, {"from", "[0.2, 0.1, 0.1]"},
      {"towards", "[1, 0, 0]"}, {"fov", "20"},
      MEDIUM("field": {"type": "box", "size": [1, 1, 1]}, "transform": {"scale": 2})}),
    FORM("B19 field ball of fog", MEDIUM_FILE, fog, 2, WITHOUT_VARIANCE, 0,
     {{"body", JSON({"type": "dielectric", "ior": 1, "absorption": {"color": [0.8, 0.5, 0.2],
      "distance": 1}})}, {"fov", "1e-5"}, MEDIUM("field": {"type": "sphere", "radius": 1})}),
};
// clang-format on

CHECK_GROUP(check_fields, "fields", "distance fields whose radiance is known", forms);
