// Defines stiff and extreme cases with known radiance (docs/verification.md, C).
#include "base/maths.h"
#include "check/case_list.h"
#include "check/closed_form.h"
#include "check/made_mesh.h"
#include <math.h>
#include <string.h>

// --- the forms ----------------------------------------------------------------------------------

static double sky(double rho, double le, double factor)
{
    (void)rho;
    return le * factor;
}
static const char sky_is[] = "Le";

// A convex body receives light from the environment only.
static double convex(double rho, double le, double unused)
{
    (void)unused;
    return rho * le;
}
static const char convex_is[] = "rho Le";

// Walls with albedo 1 add their emission at each vertex of the path.
static double lossless(double rho, double le, double bounces)
{
    (void)rho;
    return le * (bounces + 1.0);
}
static const char lossless_is[] = "Le (d + 1) for d bounces";

static double nothing(double rho, double le, double unused)
{
    (void)rho, (void)le, (void)unused;
    return 0.0;
}
static const char nothing_is[] = "0";

// --- many lamps ----------------------------------------------------------------------------------

// The lamps are n x n triangles with legs of LAMP_SIZE, parallel to the floor at height 1,
// distributed over a square of side 2. One lamp is n^2 times as bright as each other lamp.
#define LAMP_SIZE 1e-4

static void lamp_corner(uint32_t n, uint32_t index, double out[3])
{
    out[0] = 2.0 * (index % n + 0.5) / n - 1.0;
    out[1] = 1.0;
    out[2] = 2.0 * (index / n + 0.5) / n - 1.0;
}

static uint32_t bright_lamp(uint32_t n)
{
    return n / 3 * n + n / 2;
}

// Returns the sum over all lamps of rho / pi Le A cos^2 / d^2, where both cosines are 1 / d at
// height 1.
static double lamps(double rho, double le, double side)
{
    uint32_t n = (uint32_t)side;
    double sum = 0.0;
    for (uint32_t i = 0; i < n * n; i++) {
        double at[3];
        lamp_corner(n, i, at);
        at[0] += LAMP_SIZE / 3;
        at[2] += LAMP_SIZE / 3;
        double square = vec3_dot(at, at);
        sum += (i == bright_lamp(n) ? (double)n * n : 1.0) / (square * square);
    }
    return rho / M_PI * le * 0.5 * LAMP_SIZE * LAMP_SIZE * sum;
}
static const char lamps_is[] = "the sum of rho Le A cos cos' / (pi d^2)";

// --- meshes ------------------------------------------------------------------------------------

// The number of strips of a floor; each strip has two triangles 1 m long and 1e-6 m wide.
#define STRIPS 256

static bool add_slivers(struct scene *scene, double unused, struct err *err)
{
    struct mesh *mesh = made_mesh_add(scene, 2 * STRIPS, err);
    (void)unused;
    if (!mesh)
        return false;
    for (uint32_t i = 0; i < STRIPS; i++) {
        double x = 1e-6 * ((double)i - STRIPS / 2), next = x + 1e-6;
        made_mesh_set(mesh, 6 * i, x, 0, 0.5);
        made_mesh_set(mesh, 6 * i + 1, next, 0, 0.5);
        made_mesh_set(mesh, 6 * i + 2, next, 0, -0.5);
        made_mesh_set(mesh, 6 * i + 3, x, 0, 0.5);
        made_mesh_set(mesh, 6 * i + 4, next, 0, -0.5);
        made_mesh_set(mesh, 6 * i + 5, x, 0, -0.5);
    }
    return true;
}

// Adds a mesh whose vertex normals are all zero.
static bool add_without_normals(struct scene *scene, double unused, struct err *err)
{
    if (!add_slivers(scene, unused, err))
        return false;
    struct mesh *mesh = &scene->meshes[scene->mesh_count - 1];
    mesh->normals = arena_alloc(&scene->arena, mesh->vertex_count, sizeof *mesh->normals);
    return mesh->normals || err_memory(err, "normals", mesh->vertex_count);
}

static bool add_lamps(struct scene *scene, double side, struct err *err)
{
    uint32_t n = (uint32_t)side;
    struct material *bright = scene_add_material(scene, NULL);
    struct mesh *mesh = made_mesh_add(scene, n * n, err);
    if (!mesh)
        return false;
    mesh->triangle_material = arena_alloc(&scene->arena, n * n, sizeof *mesh->triangle_material);
    if (!bright || !mesh->triangle_material)
        return err_memory(err, "lamps", (uint64_t)n * n);
    scene->environment.present = false; // the loader adds an environment to scenes without light
    *bright = scene->materials[1];
    for (int c = 0; c < 3; c++)
        bright->emission[c] *= (float)n * (float)n;
    for (uint32_t i = 0; i < n * n; i++) {
        double at[3];
        lamp_corner(n, i, at);
        made_mesh_set(mesh, 3 * i, at[0], at[1], at[2]);
        made_mesh_set(mesh, 3 * i + 1, at[0] + LAMP_SIZE, at[1], at[2]);
        made_mesh_set(mesh, 3 * i + 2, at[0], at[1], at[2] + LAMP_SIZE);
        mesh->triangle_material[i] = i == bright_lamp(n) ? 2 : 1;
    }
    return true;
}

// --- the cases -----------------------------------------------------------------------------------

// clang-format off
#define FLOOR_ALONE {"light", "0"}, {"settings", JSON({"sampler": "pcg"})}, {"shapes", JSON([{"type": "quad", "material": "floor",         \
    "corner": [-2, 0, 2], "u": [4, 0, 0], "v": [0, 0, -4]}])}
// The image is 5e-5 m wide.
#define FROM_ABOVE {"camera", JSON({"type": "orthographic", "position": [0, 0.0005, 0],            \
    "target": [0, 0, 0], "up": [0, 0, 1], "height": 5e-5})},                                       \
    {"environment", JSON({"radiance": [1, 2, 4]})}, {"shapes", "[]"}
#define SIZE(w, h) {"film", JSON({"width": w, "height": h})}

static const struct check_case cases[] = {
    FORM("C5 floor of slivers, 1e6 : 1", "plane.json", convex, 0, WITHOUT_VARIANCE, BSDF_ALONE,
     {FROM_ABOVE}, 0, add_slivers),
    FORM("C16 16384 lamps, one bright", "floor_light.json", lamps, 128, BY_STATISTICS, NEE_ALONE,
     {FLOOR_ALONE}, 0, add_lamps),
    LONG_FORM("C16 a million lamps, one bright", "floor_light.json", lamps, 1000, BY_STATISTICS,
     NEE_ALONE, {FLOOR_ALONE}, 0, add_lamps),
    FORM("C17 albedo 1, depth 1000", "sphere_furnace.json", lossless, 1000, WITHOUT_VARIANCE,
     BSDF_ALONE, {{"albedo", "[1, 1, 1]"}, SIZE(8, 8),
     {"settings", JSON({"max_bounces": 1000, "roulette_min_bounces": "off"})}}),
    FORM("C26 normals that are zero", "plane.json", convex, 0, WITHOUT_VARIANCE, BSDF_ALONE,
     {FROM_ABOVE}, 0, add_without_normals),
    FORM("C34 sky of 4e6", "sky.json", sky, 1e6, EXACT, BSDF_ALONE,
     {{"emission", "[1e6, 2e6, 4e6]"}}),
    FORM("C35 black environment", "furnace_sky.json", nothing, 0, EXACT, BSDF_ALONE,
     {{"sky", "[0, 0, 0]"}, SIZE(16, 16)}),
    FORM("C40 picture of 1 x 1", "sky.json", sky, 1, EXACT, BSDF_ALONE, {SIZE(1, 1)}),
    FORM("C40 picture of 16384 x 1", "sky.json", sky, 1, EXACT, BSDF_ALONE, {SIZE(16384, 1)}),
    FORM("C40 picture of 16385 x 1", "sky.json", sky, 1, EXACT, BSDF_ALONE, {SIZE(16385, 1)}),
    FORM("C40 picture of 1 x 16385", "sky.json", sky, 1, EXACT, BSDF_ALONE, {SIZE(1, 16385)}),
    FORM("C41 field of view of 0.001 degrees", "sky.json", sky, 1, EXACT, BSDF_ALONE,
     {{"camera.fov_degrees", "0.001"}}),
    FORM("C41 field of view of 179.9 degrees", "sky.json", sky, 1, EXACT, BSDF_ALONE,
     {{"camera.fov_degrees", "179.9"}}),
};
// clang-format on

CHECK_GROUP(check_stiff, "stiff", "stiff and extreme cases whose radiance is known", cases);
