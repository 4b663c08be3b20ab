// Analytic shapes (sphere, disc, plane, cylinder; quads and boxes on request), and their
// transforms.
#include "scene/json/load_json.h"

#include "scene/core/affine.h"
#include "scene/generate/scatter.h"
#include <math.h>
#include <string.h>

static bool add_shape(struct scene *scene, const struct shape *shape, struct err *err)
{
    struct shape *added = scene_add_shape(scene, NULL);
    if (!added)
        return err_memory(err, "a shape", sizeof *added);
    *added = *shape;
    return true;
}

bool load_json_is_analytic(const struct json_node *object, bool *analytic, struct err *err)
{
    static const char *const forms[] = {"triangles", "analytic", NULL};
    uint32_t form = *analytic;
    bool ok = node_read_choice(object, "as", forms, &form, err);
    *analytic = form == 1;
    return ok;
}

// --- sphere, disc --------------------------------------------------------------------------------

static bool add_icosphere(struct scene *scene, const struct shape *shape, uint32_t subdivision,
                          struct err *err)
{
    uint32_t mesh;
    if (!generate_icosphere(scene, subdivision, &mesh, err))
        return false;
    struct instance *instance = scene_add_instance(scene, NULL);
    if (!instance)
        return err_memory(err, "an instance", sizeof *instance);
    *instance = (struct instance){.mesh = mesh, .material = shape->material};
    for (int c = 0; c < 3; c++) {
        instance->transform[c][c] = shape->radius;
        instance->transform[c][3] = shape->center[c];
    }
    return true;
}

bool load_json_sphere(struct scene *scene, const struct json_node *sphere, uint32_t material,
                      struct err *err)
{
    struct shape shape = {.kind = SHAPE_SPHERE, .material = material};
    const struct json_node divided = node_member(sphere, "subdivision");
    uint64_t subdivision = SCATTER_SUBDIVISION;
    bool analytic = true;
    if (!node_read_vector(sphere, "center", RANGE_COORDINATE, shape.center, err) ||
        !node_read_number(sphere, "radius", RANGE_RADIUS, &shape.radius, err) ||
        !load_json_is_analytic(sphere, &analytic, err) ||
        !node_read_integer(sphere, "subdivision", 0, SCATTER_SUBDIVISION_MAX, &subdivision, err))
        return false;
    if (analytic && divided.value)
        return node_fail(&divided, err, "requires \"as\": \"triangles\"");
    return analytic ? add_shape(scene, &shape, err)
                    : add_icosphere(scene, &shape, (uint32_t)subdivision, err);
}

static bool read_direction(const struct json_node *object, const char *key, double out[3],
                           struct err *err)
{
    const struct json_node node = node_member(object, key);
    return node_read_vector(object, key, RANGE_COORDINATE, out, err) &&
           (vec3_normalize(out) || node_fail(&node, err, "is zero; expected a direction"));
}

bool load_json_disc(struct scene *scene, const struct json_node *disc, uint32_t material,
                    struct err *err)
{
    struct shape shape = {.kind = SHAPE_DISC, .material = material};
    return node_read_vector(disc, "center", RANGE_COORDINATE, shape.center, err) &&
           node_read_number(disc, "radius", RANGE_RADIUS, &shape.radius, err) &&
           read_direction(disc, "normal", shape.normal, err) && add_shape(scene, &shape, err);
}

// --- plane, cylinder -----------------------------------------------------------------------------

// Replaces v by the nearest unit vector that is orthogonal to the unit vector n. Returns false if v
// is parallel to n.
static bool make_orthogonal(const double n[3], double v[3])
{
    double along;
    if (!vec3_normalize(v))
        return false;
    along = vec3_dot(n, v);
    for (int c = 0; c < 3; c++)
        v[c] -= along * n[c];
    if (!(vec3_dot(v, v) > 1e-12) || !vec3_normalize(v))
        return false;
    // The second pass removes the rounding error that cancellation left after the first.
    along = vec3_dot(n, v);
    for (int c = 0; c < 3; c++)
        v[c] -= along * n[c];
    return vec3_normalize(v);
}

bool load_json_plane(struct scene *scene, const struct json_node *plane, uint32_t material,
                     struct err *err)
{
    struct shape shape = {.kind = SHAPE_PLANE, .material = material};
    if (!node_read_vector(plane, "point", RANGE_COORDINATE, shape.center, err) ||
        !read_direction(plane, "normal", shape.normal, err))
        return false;
    // Textures are upright; on floors and ceilings their lower edge is along +x.
    const double up[3] = {0, 1, 0}, *n = shape.normal;
    if (fabs(n[1]) < 1 - 1e-9)
        vec3_cross(up, n, shape.axes[1]);
    else
        shape.axes[1][0] = 1;
    return (make_orthogonal(n, shape.axes[1]) || err_set(err, ERR_BUG, "the plane has no axes")) &&
           add_shape(scene, &shape, err);
}

// Reads the axis, given by both ends, or by centre, direction and height.
static bool read_axis(const struct json_node *cylinder, struct shape *shape, struct err *err)
{
    double ends[2][3], height = 0;
    bool by_ends = node_member(cylinder, "from").value != NULL;
    const char *const keys[2][3] = {{"axis", "height", "center"}, {"from", "to", NULL}};
    if (!node_check_either(cylinder, "from", "axis", err))
        return false;
    for (int i = 0; i < 3; i++)
        if (keys[!by_ends][i] && node_member(cylinder, keys[!by_ends][i]).value)
            return node_fail(cylinder, err, "\"%s\" cannot be combined with \"%s\"",
                             keys[!by_ends][i], keys[by_ends][0]);
    if (!node_member(cylinder, keys[by_ends][1]).value)
        return node_fail(cylinder, err, "\"%s\" is missing", keys[by_ends][1]);
    if (!by_ends) {
        if (!node_read_vector(cylinder, "center", RANGE_COORDINATE, shape->center, err) ||
            !node_read_number(cylinder, "height", RANGE_RADIUS, &height, err) ||
            !read_direction(cylinder, "axis", shape->axes[0], err))
            return false;
        for (int c = 0; c < 3; c++)
            shape->axes[0][c] *= height / 2;
        return true;
    }
    if (!node_read_vector(cylinder, "from", RANGE_COORDINATE, ends[0], err) ||
        !node_read_vector(cylinder, "to", RANGE_COORDINATE, ends[1], err))
        return false;
    for (int c = 0; c < 3; c++) {
        shape->center[c] = ends[0][c] / 2 + ends[1][c] / 2;
        shape->axes[0][c] = ends[1][c] / 2 - ends[0][c] / 2;
    }
    height = 2 * vec3_length(shape->axes[0]);
    return (height >= RANGE_RADIUS.min && height <= RANGE_RADIUS.max) ||
           node_fail(cylinder, err, "\"from\" and \"to\" are %.9g apart; expected [%g, %g]", height,
                     RANGE_RADIUS.min, RANGE_RADIUS.max);
}

bool load_json_cylinder(struct scene *scene, const struct json_node *cylinder, uint32_t material,
                        struct err *err)
{
    struct shape shape = {.kind = SHAPE_CYLINDER, .material = material};
    bool caps = true;
    if (!read_axis(cylinder, &shape, err) ||
        !node_read_number(cylinder, "radius", RANGE_RADIUS, &shape.radius, err) ||
        !node_read_boolean(cylinder, "caps", &caps, err))
        return false;
    shape.kind = caps ? SHAPE_CYLINDER : SHAPE_TUBE;
    // The seam of a texture is at the back, as on spheres.
    double unit[3], *across = shape.axes[1];
    memcpy(unit, shape.axes[0], sizeof unit);
    vec3_normalize(unit);
    across[2] = -1;
    if (!make_orthogonal(unit, across)) {
        memcpy(across, (double[3]){0, 1, 0}, sizeof shape.axes[1]);
        make_orthogonal(unit, across);
    }
    return add_shape(scene, &shape, err);
}

// --- quad, box -----------------------------------------------------------------------------------

// The relative tolerance for right angles and equal lengths. Numbers in files may have only six
// digits.
#define SHAPE_TOLERANCE 1e-5

static bool check_edge(const struct json_node *node, const double half_edge[3], struct err *err)
{
    double half = vec3_length(half_edge);
    return (half >= RANGE_RADIUS.min && half <= RANGE_RADIUS.max) ||
           node_fail(node, err, "half of an edge is %.9g; expected [%g, %g]", half,
                     RANGE_RADIUS.min, RANGE_RADIUS.max);
}

static bool check_area(const struct json_node *node, const struct shape *quad, struct err *err)
{
    double unit[2][3], normal[3];
    if (!check_edge(node, quad->axes[0], err) || !check_edge(node, quad->axes[1], err))
        return false;
    memcpy(unit, quad->axes, sizeof unit);
    vec3_normalize(unit[0]);
    vec3_normalize(unit[1]);
    vec3_cross(unit[0], unit[1], normal);
    return vec3_length(normal) > 1e-6 ||
           node_fail(node, err, "the quad's edges are parallel; expected an area");
}

bool load_json_analytic_quad(struct scene *scene, const struct json_node *quad,
                             const double vertices[4][3], uint32_t material, struct err *err)
{
    struct shape shape = {.kind = SHAPE_QUAD, .material = material};
    double gap = 0, size = 0;
    for (int c = 0; c < 3; c++) {
        double diagonals[2] = {vertices[0][c] / 2 + vertices[2][c] / 2,
                               vertices[1][c] / 2 + vertices[3][c] / 2};
        gap = fmax(gap, fabs(diagonals[1] - diagonals[0]));
        shape.center[c] = diagonals[0];
        shape.axes[0][c] = vertices[1][c] / 2 - vertices[0][c] / 2;
        shape.axes[1][c] = vertices[3][c] / 2 - vertices[0][c] / 2;
        size = fmax(size, fmax(fabs(shape.axes[0][c]), fabs(shape.axes[1][c])));
    }
    if (!(gap <= SHAPE_TOLERANCE * size))
        return node_fail(quad, err,
                         "the vertices do not form a parallelogram, because the middles of the "
                         "diagonals are %.9g "
                         "apart; expected a parallelogram, or \"as\": \"triangles\"",
                         gap);
    return check_area(quad, &shape, err) && add_shape(scene, &shape, err);
}

bool load_json_analytic_box(struct scene *scene, const struct json_node *box,
                            const double bounds[2][3], uint32_t material, struct err *err)
{
    struct shape shape = {.kind = SHAPE_BOX, .material = material};
    for (int c = 0; c < 3; c++) {
        shape.center[c] = bounds[0][c] / 2 + bounds[1][c] / 2;
        shape.axes[c][c] = bounds[1][c] / 2 - bounds[0][c] / 2;
        if (!check_edge(box, shape.axes[c], err))
            return false;
    }
    return add_shape(scene, &shape, err);
}

// --- transforms ----------------------------------------------------------------------------------

static bool check_radius(const struct json_node *node, double radius, struct err *err)
{
    return (radius >= RANGE_RADIUS.min && radius <= RANGE_RADIUS.max) ||
           node_fail(node, err, "makes the radius %.9g; expected [%g, %g]", radius,
                     RANGE_RADIUS.min, RANGE_RADIUS.max);
}

static bool move_round(const struct json_node *node, const double m[3][4], struct shape *shape,
                       struct err *err)
{
    double scale;
    if (!affine_uniform_scale(m, &scale))
        return node_fail(node, err,
                         "scales a sphere or disc differently along its axes; expected rotation, "
                         "translation and uniform scale");
    shape->radius *= scale;
    affine_vector(m, shape->normal, shape->normal);
    vec3_normalize(shape->normal); // zero stays zero, for spheres
    return check_radius(node, shape->radius, err);
}

static bool move_plane(const struct json_node *node, const double m[3][4], struct shape *shape,
                       struct err *err)
{
    // The cofactor matrix is the inverse transpose times the determinant; the determinant's sign is
    // removed here.
    double cofactors[3][3], normal[3], determinant = affine_determinant(m);
    affine_cofactors(m, cofactors);
    for (int c = 0; c < 3; c++)
        normal[c] = copysign(1, determinant) * vec3_dot(cofactors[c], shape->normal);
    if (determinant == 0 || !vec3_normalize(normal))
        return node_fail(node, err, "is singular; the plane would collapse");
    memcpy(shape->normal, normal, sizeof normal);
    affine_vector(m, shape->axes[1], shape->axes[1]);
    return make_orthogonal(normal, shape->axes[1]) ||
           node_fail(node, err, "shears a plane more than double precision represents");
}

static bool move_quad(const struct json_node *node, const double m[3][4], struct shape *shape,
                      struct err *err)
{
    affine_vector(m, shape->axes[0], shape->axes[0]);
    affine_vector(m, shape->axes[1], shape->axes[1]);
    // A reflection must not exchange the two sides of the quad.
    if (affine_determinant(m) < 0)
        for (int c = 0; c < 3; c++)
            shape->axes[0][c] = -shape->axes[0][c];
    return check_area(node, shape, err);
}

// Returns whether two vectors are orthogonal within the tolerance.
static bool is_right_angle(const double a[3], const double b[3])
{
    return fabs(vec3_dot(a, b)) <= SHAPE_TOLERANCE * vec3_length(a) * vec3_length(b);
}

static bool move_box(const struct json_node *node, const double m[3][4], struct shape *shape,
                     struct err *err)
{
    double(*axes)[3] = shape->axes, unit[3][3], lengths[3];
    for (int i = 0; i < 3; i++) {
        affine_vector(m, axes[i], axes[i]);
        if (!check_edge(node, axes[i], err))
            return false;
        lengths[i] = vec3_length(axes[i]);
    }
    for (int i = 0; i < 3; i++)
        if (!is_right_angle(axes[i], axes[(i + 1) % 3]))
            return node_fail(node, err,
                             "changes a box's right angles; expected rotation, "
                             "translation and scales along its edges, or \"as\": \"triangles\"");
    memcpy(unit, axes, sizeof unit);
    if (!vec3_normalize(unit[0]) || !make_orthogonal(unit[0], unit[1]))
        return node_fail(node, err, "is singular; a box would have no volume");
    vec3_cross(unit[0], unit[1], unit[2]); // right-handed even after a reflection
    for (int i = 0; i < 3; i++)
        for (int c = 0; c < 3; c++)
            axes[i][c] = lengths[i] * unit[i][c];
    return true;
}

static bool move_cylinder(const struct json_node *node, const double m[3][4], struct shape *shape,
                          struct err *err)
{
    double unit[3], third[3];
    memcpy(unit, shape->axes[0], sizeof unit);
    vec3_normalize(unit);
    vec3_cross(unit, shape->axes[1], third);
    affine_vector(m, shape->axes[0], shape->axes[0]);
    affine_vector(m, shape->axes[1], shape->axes[1]);
    affine_vector(m, third, third);
    double scales[2] = {vec3_length(shape->axes[1]), vec3_length(third)};
    if (!check_edge(node, shape->axes[0], err))
        return false;
    if (!(fabs(scales[0] - scales[1]) <= SHAPE_TOLERANCE * scales[0]) ||
        !is_right_angle(shape->axes[1], third) || !is_right_angle(shape->axes[0], third) ||
        !is_right_angle(shape->axes[0], shape->axes[1]))
        return node_fail(node, err,
                         "makes a cylinder oblique or its section an ellipse; expected rotation, "
                         "translation, uniform scale, and scale along its axis");
    shape->radius *= sqrt(scales[0] * scales[1]);
    memcpy(unit, shape->axes[0], sizeof unit);
    vec3_normalize(unit);
    return check_radius(node, shape->radius, err) &&
           (make_orthogonal(unit, shape->axes[1]) ||
            node_fail(node, err, "is singular; a cylinder would have no volume"));
}

// Transforms a distance field. A reflection is permitted; it changes the handedness of the axes.
static bool move_field(const struct json_node *node, const double m[3][4], struct shape *shape,
                       struct err *err)
{
    double scale;
    if (!affine_uniform_scale(m, &scale) || !(scale >= RANGE_RADIUS.min))
        return node_fail(node, err,
                         "is not a rotation, translation and uniform scale above %g, the only "
                         "transforms that a distance field can have",
                         RANGE_RADIUS.min);
    for (int i = 0; i < 3; i++) {
        affine_vector(m, shape->axes[i], shape->axes[i]);
        if (!check_edge(node, shape->axes[i], err))
            return false;
    }
    return true;
}

bool load_json_move_shape(const struct json_node *node, const double m[3][4], struct shape *shape,
                          struct err *err)
{
    affine_point(m, shape->center, shape->center);
    switch (shape->kind) {
    case SHAPE_SPHERE:
    case SHAPE_DISC:
        return move_round(node, m, shape, err);
    case SHAPE_PLANE:
        return move_plane(node, m, shape, err);
    case SHAPE_QUAD:
        return move_quad(node, m, shape, err);
    case SHAPE_BOX:
        return move_box(node, m, shape, err);
    case SHAPE_CYLINDER:
    case SHAPE_TUBE:
        return move_cylinder(node, m, shape, err);
    case SHAPE_SDF:
        return move_field(node, m, shape, err);
    case SHAPE_KIND_COUNT:
        break;
    }
    return err_set(err, ERR_BUG, "no transform of shapes of kind %d", (int)shape->kind);
}
