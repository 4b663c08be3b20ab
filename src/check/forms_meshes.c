// Defines cases of meshes and instances with known radiance that are degenerate, small, coplanar,
// mirrored or flattened (docs/verification.md, C).
#include "check/case_list.h"
#include "check/closed_form.h"
#include "check/made_mesh.h"
#include "scene/core/affine.h"
#include <math.h>
#include <string.h>

// --- the forms ----------------------------------------------------------------------------------

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

// Returns the radiance of a slope under a sun of irradiance `le`; `cosine` is the cosine of the
// angle between the slope's normal and the direction to the sun.
static double slope(double rho, double le, double cosine)
{
    return rho * le * cosine / M_PI;
}
static const char slope_is[] = "rho E cos / pi";

// Returns the radiance seen through fog (index of refraction 1) with the transmittance rho per
// metre.
static double fog(double rho, double le, double metres)
{
    return le * pow(rho, metres);
}
static const char fog_is[] = "Le exp(-sigma length)";

// --- few triangles, and triangles without area ---------------------------------------------------

static bool add_floor(struct scene *scene, double unused, struct err *err)
{
    (void)unused;
    return made_mesh_add_square(scene, 1, 0, err) != NULL;
}

static bool add_one(struct scene *scene, double unused, struct err *err)
{
    struct mesh *mesh = made_mesh_add(scene, 1, err);
    (void)unused;
    if (!mesh)
        return false;
    made_mesh_set(mesh, 0, -1, 0, -1);
    made_mesh_set(mesh, 1, 0, 0, 1);
    made_mesh_set(mesh, 2, 1, 0, -1);
    return true;
}

// Adds the four triangles between the sides of a square and its centre, at which the camera looks.
static bool add_four(struct scene *scene, double unused, struct err *err)
{
    static const double corners[5][2] = {{-1, -1}, {-1, 1}, {1, 1}, {1, -1}, {-1, -1}};
    struct mesh *mesh = made_mesh_add(scene, 4, err);
    (void)unused;
    for (uint32_t i = 0; mesh && i < 4; i++) {
        made_mesh_set(mesh, 3 * i, 0, 0, 0);
        made_mesh_set(mesh, 3 * i + 1, corners[i][0], 0, corners[i][1]);
        made_mesh_set(mesh, 3 * i + 2, corners[i + 1][0], 0, corners[i + 1][1]);
    }
    return mesh != NULL;
}

static bool add_none(struct scene *scene, double unused, struct err *err)
{
    (void)unused;
    return made_mesh_add(scene, 0, err) != NULL;
}

// Adds emitters with zero area above the floor: a point, and lines that cross the view.
static bool add_dead_lamps(struct scene *scene, double unused, struct err *err)
{
    if (!add_floor(scene, unused, err))
        return false;
    struct mesh *mesh = made_mesh_add(scene, 3, err);
    if (!mesh)
        return false;
    for (uint32_t i = 0; i < 9; i++)
        made_mesh_set(mesh, i, i < 3 ? 0.0 : (double)(i % 3) - 1.0, 1e-4, 0);
    made_mesh_set(mesh, 8, -1, 1e-4, 0); // two vertices of this triangle are equal
    return made_mesh_blacken(scene, mesh, 1e6, err);
}

// --- identical and coplanar triangles ------------------------------------------------------------

// Adds a floor and a second one in the same plane, whose triangles have the other diagonal and the
// other orientation. No triangle may shadow another one.
static bool add_two_floors(struct scene *scene, double unused, struct err *err)
{
    static const double corners[6][2] = {{1, -1}, {-1, -1}, {-1, 1}, {1, -1}, {-1, 1}, {1, 1}};
    if (!add_floor(scene, unused, err))
        return false;
    struct mesh *mesh = made_mesh_add(scene, 2, err);
    for (uint32_t i = 0; mesh && i < 6; i++)
        made_mesh_set(mesh, i, corners[i][0], 0, corners[i][1]);
    return mesh != NULL;
}

// Adds `count` equal triangles. All are black but the lowest one.
static bool add_pile(struct scene *scene, double count, struct err *err)
{
    if (!add_one(scene, 0, err))
        return false;
    struct mesh *mesh = made_mesh_add(scene, (uint32_t)count - 1, err);
    if (!mesh)
        return false;
    const struct mesh *one = &scene->meshes[scene->mesh_count - 2];
    for (uint32_t i = 0; i < mesh->vertex_count; i++)
        memcpy(mesh->positions[i], one->positions[i % 3], sizeof one->positions[0]);
    return made_mesh_blacken(scene, mesh, 0, err);
}

// --- transforms ---------------------------------------------------------------------------------

static bool place(struct scene *scene, const double rows[3][4])
{
    struct instance *instance = &scene->instances[scene->instance_count - 1];
    memcpy(instance->transform, rows, sizeof instance->transform);
    return true;
}

// Both functions add a cube of fog: a mirrored one, and one that is flattened and sheared. `metres`
// is its extent along z.
static bool add_mirrored_fog(struct scene *scene, double metres, struct err *err)
{
    const double rows[3][4] = {{-1.5, 0, 0, 0.2}, {0, 1, 0, -0.1}, {0, 0, metres, 0}};
    return made_mesh_add_cube(scene, 0.5, err) && place(scene, rows);
}

static bool add_sheared_fog(struct scene *scene, double metres, struct err *err)
{
    const double rows[3][4] = {{0.5, 0, 0.125, 0.01}, {0.25, 2, 0, -0.1}, {0, 0, -metres, 0}};
    return made_mesh_add_cube(scene, 0.5, err) && place(scene, rows);
}

// Adds a cube of fog with the camera in its centre.
static bool add_fog_around(struct scene *scene, double metres, struct err *err)
{
    const double rows[3][4] = {{-3, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 2 * metres, 4}};
    return made_mesh_add_cube(scene, 0.5, err) && place(scene, rows);
}

// Adds a square with vertex normals below a sun. The transform makes it a slope of 3 : 4, and its
// normal must be transformed by the inverse transpose; the transform itself would rotate normals by
// only 14 degrees.
static bool add_slope(struct scene *scene, double side, struct err *err)
{
    const double rows[3][4] = {{side, 0.25, 0, 0}, {0.75 * side, 1, 0, 0}, {0, 0, 2, 0}};
    struct mesh *mesh = made_mesh_add_square(scene, 1, 0, err);
    struct light *sun = scene_add_light(scene, NULL);
    if (!mesh)
        return false;
    mesh->normals = arena_alloc(&scene->arena, mesh->vertex_count, sizeof *mesh->normals);
    if (!sun || !mesh->normals)
        return err_memory(err, "normals", mesh->vertex_count);
    for (uint32_t i = 0; i < mesh->vertex_count; i++)
        mesh->normals[i][1] = 1;
    scene->environment.present = false;
    *sun = (struct light){.name = "",
                          .kind = LIGHT_DIRECTIONAL,
                          .direction = {0, -1, 0},
                          .radiant = {1, 2, 4},
                          .range = INFINITY};
    return place(scene, rows);
}

static bool add_right_slope(struct scene *scene, double unused, struct err *err)
{
    (void)unused;
    return add_slope(scene, 1, err);
}

static bool add_mirrored_slope(struct scene *scene, double unused, struct err *err)
{
    (void)unused;
    return add_slope(scene, -1, err);
}

// --- the cases ----------------------------------------------------------------------------------

// The camera is at a height of 2^-11, so that distances are exact; the image is 5e-5 m wide and
// shows the area around the origin.
// clang-format off
#define FROM_ABOVE {"camera", JSON({"type": "orthographic", "position": [0, 0.00048828125, 0],     \
    "target": [0, 0, 0], "up": [0, 0, 1], "height": 5e-5})},                                       \
    {"environment", JSON({"radiance": [1, 2, 4]})}
#define ALONE FROM_ABOVE, {"shapes", "[]"}
#define SMALL {"film", JSON({"width": 4, "height": 4})}
#define QUAD(name) "{\"type\": \"quad\", \"material\": \"" name "\", \"corner\": [-1, 0, 1], "    \
    "\"u\": [2, 0, 0], \"v\": [0, 0, -2]}"
#define FOG {"body", JSON({"type": "dielectric", "ior": 1, "absorption":                           \
    {"color": [0.8, 0.5, 0.2], "distance": 1}})}, {"fov", "1e-5"}, {"bodies", "[]"}

static const struct check_case forms[] = {
    FORM("C7 emitters without area", "plane.json", convex, 0, WITHOUT_VARIANCE, BSDF_ALONE,
     {ALONE}, 0, add_dead_lamps),
    FORM("C8 10000 identical triangles", "plane.json", convex, 10000, WITHOUT_VARIANCE,
     BSDF_ALONE, {ALONE, SMALL}, 0, add_pile),
    LONG_FORM("C8 a million identical triangles", "plane.json", convex, 1e6, WITHOUT_VARIANCE,
     BSDF_ALONE, {ALONE, SMALL}, 0, add_pile),
    FORM("C9 no triangle", "sky.json", sky, 0, EXACT, BSDF_ALONE, {{0}}, 0, add_none),
    FORM("C9 one triangle", "plane.json", convex, 0, WITHOUT_VARIANCE, BSDF_ALONE, {ALONE}, 0,
     add_one),
    FORM("C9 four triangles", "plane.json", convex, 0, WITHOUT_VARIANCE, BSDF_ALONE, {ALONE}, 0,
     add_four),
    FORM("C11 triangles in one plane", "plane.json", convex, 0, WITHOUT_VARIANCE, BSDF_ALONE,
     {ALONE}, 0, add_two_floors),
    FORM("C11 equal triangles: the lowest number", "plane.json", convex, 2, WITHOUT_VARIANCE,
     BSDF_ALONE, {ALONE}, 0, add_pile),
    FORM("C11 equal shapes: the lowest number", "plane.json", convex, 0, WITHOUT_VARIANCE,
     BSDF_ALONE, {FROM_ABOVE, {"materials.veil.opacity", "1"},
      {"shapes", "[" QUAD("plane") ", " QUAD("veil") "]"}}),
    FORM("C11 a triangle before an equal shape", "plane.json", convex, 0, WITHOUT_VARIANCE,
     BSDF_ALONE, {FROM_ABOVE, {"materials.veil.opacity", "1"}, {"shapes", JSON([{"type": "disc",
      "material": "veil", "radius": 1, "normal": [0, 1, 0]}])}}, 0, add_floor),
    FORM("C23 camera in a mirrored body of fog", "media.json", fog, 1.5, WITHOUT_VARIANCE, 0,
     {FOG}, 0, add_fog_around, INSTANCING_OFF),
    FORM("C23 camera in a mirrored instance of fog", "media.json", fog, 1.5, WITHOUT_VARIANCE, 0,
     {FOG}, 0, add_fog_around, INSTANCING_ON),
    FORM("C28 mirrored body of fog", "media.json", fog, 1.5, WITHOUT_VARIANCE, 0, {FOG}, 0,
     add_mirrored_fog, INSTANCING_OFF),
    FORM("C28 mirrored instance of fog", "media.json", fog, 1.5, WITHOUT_VARIANCE, 0, {FOG}, 0,
     add_mirrored_fog, INSTANCING_ON),
    FORM("C28 mirrored slope", "plane.json", slope, 0.8, WITHOUT_VARIANCE, NEE_ALONE, {ALONE}, 0,
     add_mirrored_slope, INSTANCING_OFF),
    FORM("C28 mirrored instance of a slope", "plane.json", slope, 0.8, WITHOUT_VARIANCE, NEE_ALONE,
     {ALONE}, 0, add_mirrored_slope, INSTANCING_ON),
    FORM("C29 sheared body of fog", "media.json", fog, 1.5, WITHOUT_VARIANCE, 0, {FOG}, 0,
     add_sheared_fog, INSTANCING_OFF),
    FORM("C29 sheared instance of fog", "media.json", fog, 1.5, WITHOUT_VARIANCE, 0, {FOG}, 0,
     add_sheared_fog, INSTANCING_ON),
    FORM("C29 squashed and sheared slope", "plane.json", slope, 0.8, WITHOUT_VARIANCE, NEE_ALONE,
     {ALONE}, 0, add_right_slope, INSTANCING_OFF),
    FORM("C29 squashed and sheared instance of a slope", "plane.json", slope, 0.8,
     WITHOUT_VARIANCE, NEE_ALONE, {ALONE}, 0, add_right_slope, INSTANCING_ON),
};
// clang-format on

CHECK_GROUP(check_meshes, "meshes",
            "meshes that are degenerate, in one plane, mirrored or squashed", forms);
