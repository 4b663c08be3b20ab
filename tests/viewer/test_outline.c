// Tests the outlines of objects in the image.
#include "base/maths.h"
#include "scene/core/affine.h"
#include "test.h"
#include "viewer/core/outline.h"

static struct camera ahead(uint32_t kind)
{
    return (struct camera){.kind = kind,
                           .position = {0, 0, 5},
                           .direction = {0, 0, -1},
                           .up = {0, 1, 0},
                           .fov_y = M_PI / 2,
                           .height = 10};
}

static struct outline outline_of_shape(struct shape shape, const struct camera *camera,
                                       double aspect)
{
    const struct scene scene = {.shapes = &shape, .shape_count = 1};
    struct outline outline;
    outline_of_object(&scene, 0, &BOUNDS_EMPTY, camera, aspect, &outline);
    return outline;
}

static void extent(const struct outline *outline, double out[4])
{
    memcpy(out, (const double[4]){INFINITY, INFINITY, -INFINITY, -INFINITY}, 4 * sizeof *out);
    for (uint32_t i = 0; i < outline->count; i++)
        for (int c = 0; c < 2; c++) {
            out[c] = fmin(out[c], outline->points[i][c]);
            out[2 + c] = fmax(out[2 + c], outline->points[i][c]);
        }
}

static void check_extent(const struct outline *outline, const double expected[4], double tolerance)
{
    double found[4];
    extent(outline, found);
    for (int i = 0; i < 4; i++)
        CHECK(fabs(found[i] - expected[i]) <= tolerance, "side %d: %.9g, expected %.9g", i,
              found[i], expected[i]);
}

TEST(quads_have_four_corners)
{
    const struct shape quad = {.kind = SHAPE_QUAD, .axes = {{1, 0, 0}, {0, 2, 0}}};
    const struct camera perspective = ahead(CAMERA_PERSPECTIVE);
    struct outline outline = outline_of_shape(quad, &perspective, 2);
    CHECK(outline.count == 4, "%u corners", outline.count);
    // At a distance of 5, the image shows 10 units of height, and 20 of width.
    check_extent(&outline, (const double[4]){0.45, 0.3, 0.55, 0.7}, 1e-12);
    const struct camera parallel = ahead(CAMERA_ORTHOGRAPHIC);
    outline = outline_of_shape(quad, &parallel, 2);
    check_extent(&outline, (const double[4]){0.45, 0.3, 0.55, 0.7}, 1e-12);
}

TEST(spheres_have_the_tangents_of_the_camera)
{
    const struct shape sphere = {.kind = SHAPE_SPHERE, .radius = 3};
    const struct camera camera = ahead(CAMERA_PERSPECTIVE);
    struct outline outline = outline_of_shape(sphere, &camera, 1);
    // The tangent touches the sphere under the angle whose sine is 3/5; its tangent is 3/4.
    check_extent(&outline, (const double[4]){0.125, 0.125, 0.875, 0.875}, 1e-12);
    CHECK(outline.count == 40, "%u corners", outline.count);
    struct shape around = sphere;
    around.radius = 6;
    outline = outline_of_shape(around, &camera, 1);
    CHECK(outline.count == 0, "the camera is inside");
}

TEST(boxes_and_meshes_agree)
{
    const struct camera camera = ahead(CAMERA_PERSPECTIVE);
    const struct shape box = {
        .kind = SHAPE_BOX, .center = {0.5, 0, 0}, .axes = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    struct outline expected = outline_of_shape(box, &camera, 1.5), found;
    float positions[2][3] = {{-1, -1, -1}, {1, 1, 1}};
    struct mesh mesh = {.vertex_count = 2, .positions = positions};
    struct instance instance = {.transform = {{1, 0, 0, 0.5}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    const struct scene scene = {
        .meshes = &mesh, .mesh_count = 1, .instances = &instance, .instance_count = 1};
    const struct bounds bounds = outline_mesh_bounds(&mesh);
    outline_of_object(&scene, 0, &bounds, &camera, 1.5, &found);
    double sides[4];
    extent(&expected, sides);
    CHECK(found.count == expected.count && found.count >= 4, "%u and %u corners", found.count,
          expected.count);
    check_extent(&found, sides, 1e-12);
}

TEST(what_is_not_ahead_is_cut_off)
{
    const struct camera camera = ahead(CAMERA_PERSPECTIVE);
    // A floor that begins behind the camera.
    const struct shape floor = {
        .kind = SHAPE_QUAD, .center = {0, -1, 0}, .axes = {{1, 0, 0}, {0, 0, 100}}};
    struct outline outline = outline_of_shape(floor, &camera, 1);
    double sides[4];
    extent(&outline, sides);
    CHECK(sides[1] > 0.5, "all of it is below the horizon: %g", sides[1]);
    CHECK(sides[3] > 1, "it goes on below the image: %g", sides[3]);
    const struct shape behind = {.kind = SHAPE_SPHERE, .center = {0, 0, 20}, .radius = 1};
    outline = outline_of_shape(behind, &camera, 1);
    CHECK(outline.count == 0, "%u corners behind the camera", outline.count);
    const struct shape plane = {.kind = SHAPE_PLANE, .normal = {0, 1, 0}};
    outline = outline_of_shape(plane, &camera, 1);
    CHECK(outline.count == 0, "a plane has no bounds");
}

TEST(lines_are_clipped)
{
    const double rect[4] = {10, 20, 110, 70};
    double from[2] = {-1e9, 45}, to[2] = {1e9, 45};
    CHECK(outline_clip(rect, from, to));
    CHECK(fabs(from[0] - 10) < 1e-6 && fabs(to[0] - 110) < 1e-6, "%g %g", from[0], to[0]);
    double a[2] = {30, 30}, b[2] = {50, 90};
    CHECK(outline_clip(rect, a, b) && a[0] == 30 && a[1] == 30 && fabs(b[1] - 70) < 1e-12);
    double c[2] = {0, 0}, d[2] = {9, 100};
    CHECK(!outline_clip(rect, c, d), "beside it");
    double e[2] = {5, 30}, f[2] = {5, 60};
    CHECK(!outline_clip(rect, e, f), "parallel to a side");
}

TEST_MAIN(TEST_CASE(quads_have_four_corners), TEST_CASE(spheres_have_the_tangents_of_the_camera),
          TEST_CASE(boxes_and_meshes_agree), TEST_CASE(what_is_not_ahead_is_cut_off),
          TEST_CASE(lines_are_clipped))
