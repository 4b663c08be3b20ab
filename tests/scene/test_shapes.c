// Tests analytic shapes on the host: shapes in scene files, their transforms, and that bounds and
// boxes contain all of their points.
#include "mesh_files.h"

#include "flatten/flatten_shapes.h"
#include "scene/core/affine.h"
#include "scene/core/bounds.h"

static struct scene load_body(const char *body)
{
    char text[4096];
    struct scene scene;
    struct err err = {0};
    snprintf(text, sizeof text, "{\"lampyris\": 1, \"materials\": {\"a\": {}}, \"shapes\": [%s]}",
             body);
    const struct scene_load_params params = {.path = write_text("scene.json", text)};
    CHECK(scene_load(&params, &scene, &err), "%s", err.msg);
    return scene;
}

static bool is_near(const double a[3], double x, double y, double z)
{
    const double b[3] = {x, y, z};
    for (int i = 0; i < 3; i++)
        if (!(fabs(a[i] - b[i]) <= 1e-12))
            return false;
    return true;
}

#define MATERIAL "\"material\": \"a\""

TEST(what_files_say)
{
    struct scene scene = load_body(
        "{\"type\": \"plane\", " MATERIAL ", \"point\": [1, 2, 3], \"normal\": [0, 5, 0]},"
        "{\"type\": \"plane\", " MATERIAL ", \"normal\": [0, 0, -2]},"
        "{\"type\": \"cylinder\", " MATERIAL ", \"radius\": 2, \"from\": [0, 1, 0],"
        " \"to\": [0, 4, 0]},"
        "{\"type\": \"cylinder\", " MATERIAL ", \"radius\": 2, \"axis\": [0, 0, 9],"
        " \"height\": 3, \"center\": [1, 1, 1], \"caps\": false},"
        "{\"type\": \"box\", " MATERIAL ", \"min\": [0, 0, 0], \"max\": [1, 2, 4],"
        " \"as\": \"analytic\"},"
        "{\"type\": \"quad\", " MATERIAL ", \"corner\": [1, 0, 0], \"u\": [2, 0, 0],"
        " \"v\": [0, 0, 4], \"as\": \"analytic\"},"
        "{\"type\": \"sphere\", " MATERIAL ", \"radius\": 2, \"center\": [5, 0, 0],"
        " \"as\": \"triangles\", \"subdivision\": 1}");
    REQUIRE(scene.shape_count == 6 && scene.instance_count == 1);
    const struct shape *s = scene.shapes;
    CHECK(s[0].kind == SHAPE_PLANE && is_near(s[0].center, 1, 2, 3));
    CHECK(is_near(s[0].normal, 0, 1, 0) && is_near(s[0].axes[1], 1, 0, 0));
    CHECK(is_near(s[1].normal, 0, 0, -1) && is_near(s[1].axes[1], -1, 0, 0));
    CHECK(s[2].kind == SHAPE_CYLINDER && is_near(s[2].center, 0, 2.5, 0) && s[2].radius == 2);
    CHECK(is_near(s[2].axes[0], 0, 1.5, 0) && is_near(s[2].axes[1], 0, 0, -1));
    CHECK(s[3].kind == SHAPE_TUBE && is_near(s[3].center, 1, 1, 1));
    CHECK(is_near(s[3].axes[0], 0, 0, 1.5) && is_near(s[3].axes[1], 0, 1, 0));
    CHECK(s[4].kind == SHAPE_BOX && is_near(s[4].center, 0.5, 1, 2));
    CHECK(is_near(s[4].axes[0], 0.5, 0, 0) && is_near(s[4].axes[2], 0, 0, 2));
    CHECK(s[5].kind == SHAPE_QUAD && is_near(s[5].center, 2, 0, 2));
    CHECK(is_near(s[5].axes[0], 1, 0, 0) && is_near(s[5].axes[1], 0, 0, 2));
    CHECK(scene.meshes[0].triangle_count == 80 && scene.instances[0].transform[0][3] == 5 &&
          scene.instances[0].transform[1][1] == 2);
    scene_finish(&scene);
}

TEST(transforms)
{
    struct scene scene =
        load_body("{\"type\": \"plane\", " MATERIAL ", \"point\": [0, 1, 0], \"normal\": [1, 1, 0],"
                  " \"transform\": {\"scale\": [2, 1, -1]}},"
                  "{\"type\": \"plane\", " MATERIAL ", \"normal\": [0, 1, 0], \"transform\": "
                  "[{\"scale\": [1, -1, 1]}, {\"translate\": [0, 3, 0]}]},"
                  "{\"type\": \"cylinder\", " MATERIAL ", \"radius\": 2, \"from\": [0, 1, 0],"
                  " \"to\": [0, 4, 0], \"transform\": [{\"scale\": [3, -2, 3]},"
                  " {\"rotate\": {\"axis\": [0, 0, 1], \"degrees\": 90}}]},"
                  "{\"type\": \"box\", " MATERIAL ", \"min\": [-1, -1, -1], \"max\": [1, 1, 1],"
                  " \"as\": \"analytic\", \"transform\": {\"scale\": [2, -3, 4]}},"
                  "{\"type\": \"quad\", " MATERIAL ", \"corner\": [0, 0, 0], \"u\": [2, 0, 0],"
                  " \"v\": [0, 2, 0], \"as\": \"analytic\", \"transform\": "
                  "{\"matrix\": [1, 1, 0, 0, 0, 1, 0, 0, 0, 0, -1, 7, 0, 0, 0, 1]}}");
    REQUIRE(scene.shape_count == 5);
    const struct shape *s = scene.shapes;
    // x + y = 1 becomes x / 2 + y = 1.
    CHECK(is_near(s[0].normal, 1 / sqrt(5), 2 / sqrt(5), 0) && is_near(s[0].center, 0, 1, 0));
    CHECK(fabs(vec3_dot(s[0].normal, s[0].axes[1])) < 1e-15);
    // After a reflection, the upper side is the lower one.
    CHECK(is_near(s[1].normal, 0, -1, 0) && is_near(s[1].center, 0, 3, 0));
    CHECK(is_near(s[2].axes[0], 3, 0, 0) && fabs(s[2].radius - 6) < 1e-12, "%g", s[2].radius);
    CHECK(is_near(s[2].center, 5, 0, 0) && is_near(s[2].axes[1], 0, 0, -1));
    // A reflected box is right-handed again.
    double third[3];
    vec3_cross(s[3].axes[0], s[3].axes[1], third);
    CHECK(vec3_dot(third, s[3].axes[2]) > 0 && fabs(s[3].axes[1][1]) == 3);
    // After shearing and reflection, the front faces what it faced before.
    vec3_cross(s[4].axes[0], s[4].axes[1], third);
    CHECK(third[2] < 0 && is_near(s[4].center, 2, 1, 7) && is_near(s[4].axes[1], 1, 1, 0));
    scene_finish(&scene);
}

// --- bounds --------------------------------------------------------------------------------------

static uint64_t random_state = 1;

static double random_unit(void)
{
    random_state = random_state * 6364136223846793005u + 1442695040888963407u;
    return (double)(random_state >> 11) * 0x1p-53;
}

// Returns a shape in single precision, so that points of the shape are points of the flattened
// shape.
static struct shape random_shape(enum shape_kind kind)
{
    struct shape shape = {.kind = kind};
    double size = exp2(40 * random_unit() - 20), m[3][4], axis[3];
    for (int i = 0; i < 3; i++)
        axis[i] = random_unit() - 0.5;
    if (!affine_rotation(axis, 6 * random_unit(), m))
        memcpy(m, AFFINE_IDENTITY, sizeof m);
    for (int a = 0; a < 3; a++) {
        double length = kind >= SHAPE_CYLINDER && a == 1 ? 1 : size * (0.2 + random_unit());
        for (int i = 0; i < 3; i++)
            shape.axes[a][i] = (double)(float)(m[i][a] * length);
        shape.center[a] = (double)(float)(4 * size * (random_unit() - 0.5));
        shape.normal[a] = (double)(float)m[a][2];
    }
    shape.radius = (double)(float)(size * (0.2 + random_unit()));
    return shape;
}

// Returns a random point of the surface.
static void point_of(const struct shape *shape, double out[3])
{
    double a = 2 * random_unit() - 1, b = 2 * random_unit() - 1, angle = 7 * random_unit();
    double c = random_unit() < 0.5 ? -1 : 1;
    double ring = shape->kind == SHAPE_TUBE || random_unit() < 0.5 ? 1 : random_unit();
    double x[3], y[3], unit[3];
    memcpy(unit, shape->kind == SHAPE_DISC ? shape->normal : shape->axes[0], sizeof unit);
    vec3_normalize(unit);
    memcpy(x, shape->axes[1], sizeof x);
    if (shape->kind == SHAPE_DISC)
        vec3_cross(unit, (double[3]){0.3, 0.5, -0.7}, x);
    vec3_normalize(x);
    vec3_cross(unit, x, y);
    if (random_unit() < 0.3)
        a = copysign(1, a);
    if (random_unit() < 0.3)
        b = copysign(1, b);
    for (int i = 0; i < 3; i++) {
        double across = shape->radius * ring * (cos(angle) * x[i] + sin(angle) * y[i]);
        switch (shape->kind) {
        case SHAPE_QUAD:
            out[i] = a * shape->axes[0][i] + b * shape->axes[1][i];
            break;
        case SHAPE_BOX:
            out[i] = a * shape->axes[0][i] + b * shape->axes[1][i] + c * shape->axes[2][i];
            break;
        case SHAPE_DISC:
            out[i] = across;
            break;
        case SHAPE_SPHERE:
            out[i] =
                shape->radius *
                (sqrt(1 - a * a) * (cos(angle) * (i == 0) + sin(angle) * (i == 1)) + a * (i == 2));
            break;
        default:
            out[i] = a * shape->axes[0][i] + across;
        }
        out[i] += shape->center[i];
    }
}

static void check_boxes(enum shape_kind kind)
{
    struct material material = {0};
    for (int trial = 0; trial < 200; trial++) {
        struct arena arena = {0};
        struct shape shape = random_shape(kind);
        struct scene scene = {
            .shapes = &shape, .shape_count = 1, .materials = &material, .material_count = 1};
        struct flat_scene flat;
        struct err err = {0};
        float min[3], max[3];
        REQUIRE(
            scene_flatten(&(struct flatten_params){&scene, INSTANCING_AUTO}, &arena, &flat, &err),
            "%s", err.msg);
        REQUIRE(flat.origin[0] == 0 && flat.origin[1] == 0 && flat.origin[2] == 0);
        flat_shape_box(&flat.shapes[0], min, max);
        const struct scene_part whole = scene_whole(&scene);
        double center[3] = {1, 2, 3}, radius = bounds_radius(&scene, &whole, center);
        // The fraction of the box that points reach shows that it is not much too large.
        double low[3] = {1, 1, 1}, high[3] = {0, 0, 0};
        for (int n = 0; n < 2000; n++) {
            double point[3], from[3];
            point_of(&shape, point);
            vec3_subtract(point, center, from);
            CHECK(vec3_length(from) <= radius * (1 + 1e-9), "kind %d", (int)kind);
            flat_from_world(&flat, point, point);
            for (int c = 0; c < 3; c++) {
                CHECK(point[c] >= (double)min[c] && point[c] <= (double)max[c],
                      "kind %d, axis %d: %.9g outside of [%.9g, %.9g]", (int)kind, c, point[c],
                      (double)min[c], (double)max[c]);
                CHECK(min[c] <= flat.bounds_min[c] && max[c] >= flat.bounds_max[c]);
                double at = (point[c] - (double)min[c]) / ((double)max[c] - (double)min[c]);
                low[c] = fmin(low[c], at);
                high[c] = fmax(high[c], at);
            }
        }
        for (int c = 0; c < 3; c++)
            CHECK(low[c] < 0.2 && high[c] > 0.8, "kind %d, axis %d: %g to %g", (int)kind, c, low[c],
                  high[c]);
        arena_finish(&arena);
    }
}

TEST(boxes_hold_every_point)
{
    for (uint32_t kind = 0; kind < SHAPE_SDF; kind++)
        if (kind != SHAPE_PLANE)
            check_boxes((enum shape_kind)kind);
}

// --- planes --------------------------------------------------------------------------------------

TEST(planes_have_no_bounds)
{
    struct arena arena = {0};
    struct flat_scene flat;
    struct err err = {0};
    struct scene alone = load_body("{\"type\": \"plane\", " MATERIAL ", \"normal\": [0, 1, 0]}");
    CHECK(alone.camera_is_framed && isfinite(alone.cameras[0].position[2]));
    REQUIRE(scene_flatten(&(struct flatten_params){&alone, INSTANCING_AUTO}, &arena, &flat, &err),
            "%s", err.msg);
    CHECK(flat.bounds_min[0] > flat.bounds_max[0] && flat.shape_count == 1);
    scene_finish(&alone);

    struct scene with_ball = load_body(
        "{\"type\": \"sphere\", " MATERIAL ", \"radius\": 1, \"center\": [1e5, 0, 0]},"
        "{\"type\": \"plane\", " MATERIAL ", \"point\": [0, -1, 0], \"normal\": [0, 3, 4]}");
    REQUIRE(
        scene_flatten(&(struct flatten_params){&with_ball, INSTANCING_AUTO}, &arena, &flat, &err),
        "%s", err.msg);
    CHECK(flat.origin[0] == 1e5 && flat.bounds_max[1] < 1.001f);
    // Its point is now near the origin, and still in the plane: 3 y + 4 z = -3.
    const float *point = flat.shapes[1].center;
    CHECK(fabsf(point[0]) < 1 && fabsf(3 * point[1] + 4 * point[2] + 3) < 1e-5f);
    scene_finish(&with_ball);
    arena_finish(&arena);
}

TEST(boxes_of_planes)
{
    float min[3], max[3];
    const struct flat_shape floor = {
        .kind = SHAPE_PLANE, .center = {1, 2, 3}, .normal = {0, -1, 0}};
    const struct flat_shape slope = {
        .kind = SHAPE_PLANE, .center = {1, 2, 3}, .normal = {0.6f, 0.8f, 0}};
    flat_shape_box(&floor, min, max);
    CHECK(min[1] < 2 && min[1] > 1.9999f && max[1] > 2 && max[1] < 2.0001f);
    CHECK(min[0] < -1e17f && max[0] > 1e17f && min[2] < -1e17f && max[2] > 1e17f);
    flat_shape_box(&slope, min, max);
    for (int c = 0; c < 3; c++)
        CHECK(min[c] < -1e17f && max[c] > 1e17f && isfinite(min[c]) && isfinite(max[c]));
}

int main(int argc, char **argv)
{
    static const struct test_case cases[] = {
        TEST_CASE(what_files_say),         TEST_CASE(transforms),
        TEST_CASE(boxes_hold_every_point), TEST_CASE(planes_have_no_bounds),
        TEST_CASE(boxes_of_planes),
    };
    if (!begin_mesh_tests())
        return 1;
    return test_run(cases, sizeof cases / sizeof cases[0], argc, argv);
}
