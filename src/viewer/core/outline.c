#include "viewer/core/outline.h"

#include "base/maths.h"
#include "scene/core/affine.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

// A circle is drawn as a polygon with this many corners. The polygon deviates from the circle by
// 1 - cos(pi / 40), 0.3 % of the radius.
#define CIRCLE 40u
#define BODY_MAX (2u * CIRCLE)
// Parts of a body that are nearer than this fraction of its farthest point are cut off, because
// their projection grows without limit towards the plane of the camera.
#define NEAR_PART 0x1p-10

// A convex body in world space: the hull of these points.
struct body {
    double points[BODY_MAX][3];
    uint32_t count;
};

// --- bodies --------------------------------------------------------------------------------------

struct bounds outline_mesh_bounds(const struct mesh *mesh)
{
    struct bounds bounds = BOUNDS_EMPTY;
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        double point[3];
        mesh_vertex(mesh, v, point);
        bounds_add_point(&bounds, point);
    }
    return bounds;
}

static void add_sum(struct body *body, const double center[3], const double axes[3][3],
                    const double factors[3])
{
    double *to = body->points[body->count++];
    for (int c = 0; c < 3; c++)
        to[c] =
            center[c] + factors[0] * axes[0][c] + factors[1] * axes[1][c] + factors[2] * axes[2][c];
}

// Adds the corners of a box with the given half edges, of which the last may be 0.
static void add_box(struct body *body, const double center[3], const double axes[3][3])
{
    for (int corner = 0; corner < 8; corner++)
        add_sum(body, center, axes,
                (const double[3]){corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1});
}

// Adds a circle about an axis, which need not be a unit vector.
static void add_circle(struct body *body, const double center[3], const double axis[3],
                       double radius)
{
    double axes[3][3] = {{0}};
    int least = fabs(axis[0]) < fabs(axis[1]) ? 0 : 1;
    if (fabs(axis[2]) < fabs(axis[least]))
        least = 2;
    axes[2][least] = 1;
    vec3_cross(axis, axes[2], axes[0]);
    vec3_normalize(axes[0]);
    vec3_cross(axis, axes[0], axes[1]);
    vec3_normalize(axes[1]);
    for (uint32_t i = 0; i < CIRCLE; i++) {
        double angle = 2 * M_PI * i / CIRCLE;
        add_sum(body, center, (const double(*)[3])axes,
                (const double[3]){radius * cos(angle), radius * sin(angle), 0});
    }
}

// Adds the circle in which the tangents from the camera touch a sphere: with the distance d of the
// centre, it is r^2 / d nearer to the camera and has the radius r sqrt(1 - r^2 / d^2).
static void add_sphere(struct body *body, const struct shape *shape, const struct camera *camera)
{
    double axis[3], center[3], radius = shape->radius, nearer = 0;
    if (camera->kind == CAMERA_ORTHOGRAPHIC) {
        memcpy(axis, camera->direction, sizeof axis);
    } else {
        vec3_subtract(shape->center, camera->position, axis);
        double distance = vec3_length(axis);
        if (!(distance > radius))
            return; // the camera is in the sphere
        nearer = radius * radius / distance;
        radius *= sqrt(1 - radius * radius / (distance * distance));
    }
    vec3_normalize(axis);
    for (int c = 0; c < 3; c++)
        center[c] = shape->center[c] - nearer * axis[c];
    add_circle(body, center, axis, radius);
}

static void add_shape(struct body *body, const struct shape *shape, const struct camera *camera)
{
    double axes[3][3] = {{0}}, end[3];
    switch (shape->kind) {
    case SHAPE_SPHERE:
        add_sphere(body, shape, camera);
        break;
    case SHAPE_DISC:
        add_circle(body, shape->center, shape->normal, shape->radius);
        break;
    case SHAPE_QUAD:
        memcpy(axes, shape->axes, 2 * sizeof axes[0]);
        add_box(body, shape->center, (const double(*)[3])axes);
        break;
    case SHAPE_BOX:
    case SHAPE_SDF:
        add_box(body, shape->center, shape->axes);
        break;
    case SHAPE_CYLINDER:
    case SHAPE_TUBE:
        for (int sign = -1; sign <= 1; sign += 2) {
            for (int c = 0; c < 3; c++)
                end[c] = shape->center[c] + sign * shape->axes[0][c];
            add_circle(body, end, shape->axes[0], shape->radius);
        }
        break;
    default: // a plane has no bounds
        break;
    }
}

static void add_instance(struct body *body, const struct instance *instance,
                         const struct bounds *bounds)
{
    for (int corner = 0; corner < 8 && !bounds_is_empty(bounds); corner++) {
        const double point[3] = {corner & 1 ? bounds->max[0] : bounds->min[0],
                                 corner & 2 ? bounds->max[1] : bounds->min[1],
                                 corner & 4 ? bounds->max[2] : bounds->min[2]};
        affine_point(instance->transform, point, body->points[body->count++]);
    }
}

// --- projection ----------------------------------------------------------------------------------

// Transforms points to the camera's space: to the right, up and ahead. Returns the greatest of the
// last coordinates.
static double to_camera(struct body *body, const struct camera *camera)
{
    double right[3], up[3], way[3], farthest = 0;
    vec3_cross(camera->direction, camera->up, right);
    vec3_normalize(right);
    vec3_cross(right, camera->direction, up);
    for (uint32_t i = 0; i < body->count; i++) {
        double *point = body->points[i];
        vec3_subtract(point, camera->position, way);
        point[0] = vec3_dot(way, right);
        point[1] = vec3_dot(way, up);
        point[2] = vec3_dot(way, camera->direction);
        farthest = fmax(farthest, point[2]);
    }
    return farthest;
}

static void project(const struct camera *camera, double aspect, const double point[3],
                    struct outline *out)
{
    double half = camera->kind == CAMERA_ORTHOGRAPHIC ? 0.5 * camera->height
                                                      : point[2] * tan(0.5 * camera->fov_y);
    double *to = out->points[out->count];
    to[0] = 0.5 + 0.5 * point[0] / (half * aspect);
    to[1] = 0.5 - 0.5 * point[1] / half;
    if (isfinite(to[0]) && isfinite(to[1]) && out->count < OUTLINE_POINTS_MAX - 1)
        out->count++;
}

// Projects the part of a body that is ahead of the camera: the points that are, and those in which
// the lines between two points cross the near plane. All of them are in the body, and its edges are
// among the lines.
static void project_body(const struct body *body, double near, const struct camera *camera,
                         double aspect, struct outline *out)
{
    for (uint32_t i = 0; i < body->count; i++) {
        const double *a = body->points[i];
        if (a[2] >= near)
            project(camera, aspect, a, out);
        for (uint32_t j = 0; j < body->count && a[2] < near; j++) {
            const double *b = body->points[j];
            double part = (near - a[2]) / (b[2] - a[2]), cut[3];
            if (b[2] < near)
                continue;
            for (int c = 0; c < 3; c++)
                cut[c] = a[c] + part * (b[c] - a[c]);
            project(camera, aspect, cut, out);
        }
    }
}

// --- hull ----------------------------------------------------------------------------------------

static int by_position(const void *a, const void *b)
{
    const double *p = a, *q = b;
    int x = (p[0] > q[0]) - (p[0] < q[0]);
    return x ? x : (p[1] > q[1]) - (p[1] < q[1]);
}

// Returns whether the path a, b, c turns to the left at b.
static bool turns_left(const double a[2], const double b[2], const double c[2])
{
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) > 0;
}

// Adds a point to a chain that only turns left, which begins at `first`.
static void add_to_chain(double (*hull)[2], uint32_t first, uint32_t *count, const double point[2])
{
    while (*count >= first + 2 && !turns_left(hull[*count - 2], hull[*count - 1], point))
        --*count;
    memcpy(hull[(*count)++], point, sizeof *hull);
}

// Replaces points by the corners of their convex hull: A. M. Andrew, Another efficient algorithm
// for convex hulls in two dimensions, Information Processing Letters 9(5), 1979.
static void make_hull(struct outline *outline)
{
    double hull[2 * OUTLINE_POINTS_MAX][2];
    uint32_t count = 0, points = outline->count;
    qsort(outline->points, points, sizeof *outline->points, by_position);
    for (uint32_t i = 0; i < points; i++)
        add_to_chain(hull, 0, &count, outline->points[i]);
    const uint32_t back = count ? count - 1 : 0;
    for (uint32_t i = points; i-- > 1;)
        add_to_chain(hull, back, &count, outline->points[i - 1]);
    outline->count = count > 1 ? count - 1 : 0; // the last point is the first
    memcpy(outline->points, hull, outline->count * sizeof *hull);
}

void outline_of_object(const struct scene *scene, uint32_t object, const struct bounds *bounds,
                       const struct camera *camera, double aspect, struct outline *out)
{
    struct body body = {.count = 0};
    out->count = 0;
    if (camera->kind == CAMERA_PANORAMIC)
        return;
    if (object < scene->instance_count)
        add_instance(&body, &scene->instances[object], bounds);
    else
        add_shape(&body, &scene->shapes[object - scene->instance_count], camera);
    double farthest = to_camera(&body, camera);
    if (!(farthest > 0))
        return;
    project_body(&body, NEAR_PART * farthest, camera, aspect, out);
    make_hull(out);
}

// Clips a line by the method of Y.-D. Liang and B. A. Barsky, A new concept and method for line
// clipping, ACM Transactions on Graphics 3(1), 1984.
bool outline_clip(const double rect[4], double from[2], double to[2])
{
    const double start[2] = {from[0], from[1]}, way[2] = {to[0] - from[0], to[1] - from[1]};
    double first = 0, last = 1;
    for (int side = 0; side < 4; side++) {
        int c = side & 1;
        bool is_low = side < 2;
        double speed = is_low ? -way[c] : way[c];
        double room = is_low ? start[c] - rect[c] : rect[2 + c] - start[c];
        if (speed == 0 && room < 0)
            return false;
        if (speed < 0)
            first = fmax(first, room / speed);
        else if (speed > 0)
            last = fmin(last, room / speed);
    }
    for (int c = 0; c < 2 && first <= last; c++) {
        from[c] = start[c] + first * way[c];
        to[c] = start[c] + last * way[c];
    }
    return first <= last;
}
