#include "scene/core/bounds.h"

#include "scene/core/affine.h"
#include <math.h>
#include <string.h>

const struct bounds BOUNDS_EMPTY = {{INFINITY, INFINITY, INFINITY},
                                    {-INFINITY, -INFINITY, -INFINITY}};

struct scene_part scene_whole(const struct scene *scene)
{
    return (struct scene_part){
        .instance_count = scene->instance_count,
        .shape_count = scene->shape_count,
    };
}

void mesh_vertex(const struct mesh *mesh, uint32_t vertex, double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = mesh->exact_positions ? mesh->exact_positions[vertex][i]
                                       : (double)mesh->positions[vertex][i];
}

void bounds_add_point(struct bounds *bounds, const double point[3])
{
    // Comparisons are used because fmin() and fmax() are function calls, and this is the inner loop
    // of every pass over a mesh.
    for (int i = 0; i < 3; i++) {
        if (point[i] < bounds->min[i])
            bounds->min[i] = point[i];
        if (point[i] > bounds->max[i])
            bounds->max[i] = point[i];
    }
}

// Returns the largest n.(v - centre) over the points v of a disc: its radius times |n| times the
// sine of the angle between n and the disc's normal.
static double disc_extent(const double normal[3], double radius, const double n[3])
{
    double along = vec3_dot(normal, n);
    return radius * sqrt(fmax(vec3_dot(n, n) - along * along, 0));
}

double shape_extent(const struct shape *shape, const double n[3])
{
    double unit[3];
    memcpy(unit, shape->axes[0], sizeof unit);
    vec3_normalize(unit);
    double edges = fabs(vec3_dot(shape->axes[0], n)) + fabs(vec3_dot(shape->axes[1], n));
    switch (shape->kind) {
    case SHAPE_SPHERE:
        return shape->radius * vec3_length(n);
    case SHAPE_DISC:
        return disc_extent(shape->normal, shape->radius, n);
    case SHAPE_QUAD:
        return edges;
    case SHAPE_BOX:
    case SHAPE_SDF:
        return edges + fabs(vec3_dot(shape->axes[2], n));
    case SHAPE_CYLINDER:
    case SHAPE_TUBE:
        return fabs(vec3_dot(shape->axes[0], n)) + disc_extent(unit, shape->radius, n);
    default:
        return INFINITY;
    }
}

bool shape_reach(const struct shape *shape, double reach[3])
{
    if (shape->kind == SHAPE_PLANE)
        return false;
    for (int i = 0; i < 3; i++) {
        const double axis[3] = {i == 0, i == 1, i == 2};
        reach[i] = shape_extent(shape, axis);
    }
    return true;
}

void bounds_add_shape(struct bounds *bounds, const struct shape *shape)
{
    double reach[3], low[3], high[3];
    if (!shape_reach(shape, reach))
        return;
    for (int i = 0; i < 3; i++) {
        low[i] = shape->center[i] - reach[i];
        high[i] = shape->center[i] + reach[i];
    }
    bounds_add_point(bounds, low);
    bounds_add_point(bounds, high);
}

bool bounds_is_empty(const struct bounds *bounds)
{
    return bounds->min[0] > bounds->max[0];
}

bool bounds_are_a_point(const struct bounds *bounds)
{
    for (int i = 0; i < 3; i++)
        if (bounds->min[i] < bounds->max[i])
            return false;
    return true;
}

// Calls `visit` for every corner of an instance's triangles. Inlined, so that `visit` is inlined as
// well.
static inline void each_corner(const struct scene *scene, const struct instance *instance,
                               void (*visit)(void *context, const double point[3]), void *context)
{
    const struct mesh *mesh = &scene->meshes[instance->mesh];
    for (uint32_t t = 0; t < mesh->triangle_count && !progress_stops_at(scene->progress, t + 1);
         t++) {
        for (int corner = 0; corner < 3; corner++) {
            double point[3];
            mesh_vertex(mesh, mesh->indices[t][corner], point);
            affine_point(instance->transform, point, point);
            visit(context, point);
        }
    }
}

static void extend_bounds(void *context, const double point[3])
{
    bounds_add_point(context, point);
}

struct bounds bounds_of_part(const struct scene *scene, const struct scene_part *part)
{
    struct bounds bounds = BOUNDS_EMPTY;
    for (uint32_t i = 0; i < part->instance_count && !progress_should_stop(scene->progress); i++)
        each_corner(scene, &scene->instances[part->first_instance + i], extend_bounds, &bounds);
    for (uint32_t i = 0; i < part->shape_count; i++)
        bounds_add_shape(&bounds, &scene->shapes[part->first_shape + i]);
    return bounds;
}

struct support {
    uint32_t count;
    const double (*normals)[3];
    double *out;
};

static void extend_support(void *context, const double point[3])
{
    const struct support *support = context;
    for (uint32_t i = 0; i < support->count; i++) {
        double along = vec3_dot(point, support->normals[i]);
        if (along > support->out[i])
            support->out[i] = along;
    }
}

void bounds_support(const struct scene *scene, const struct scene_part *part, uint32_t count,
                    const double (*normals)[3], double *out)
{
    struct support support = {count, normals, out};
    for (uint32_t i = 0; i < count; i++)
        out[i] = -INFINITY;
    for (uint32_t i = 0; i < part->instance_count && !progress_should_stop(scene->progress); i++)
        each_corner(scene, &scene->instances[part->first_instance + i], extend_support, &support);
    for (uint32_t s = 0; s < part->shape_count; s++) {
        const struct shape *shape = &scene->shapes[part->first_shape + s];
        for (uint32_t i = 0; i < count && shape->kind != SHAPE_PLANE; i++)
            out[i] =
                fmax(out[i], vec3_dot(shape->center, normals[i]) + shape_extent(shape, normals[i]));
    }
}

static double distance(const double a[3], const double b[3])
{
    double difference[3];
    vec3_subtract(a, b, difference);
    return vec3_norm(difference);
}

struct reach {
    const double *center;
    double radius;
};

static void extend_reach(void *context, const double point[3])
{
    struct reach *reach = context;
    reach->radius = fmax(reach->radius, distance(point, reach->center));
}

// Returns an upper bound of the distance from `center` to any point of a shape; 0 for a plane.
static double shape_radius(const struct shape *shape, const double center[3])
{
    double radius = 0;
    switch (shape->kind) {
    case SHAPE_SPHERE:
    case SHAPE_DISC:
        return distance(shape->center, center) + shape->radius;
    case SHAPE_QUAD:
    case SHAPE_BOX:
    case SHAPE_SDF:
    case SHAPE_CYLINDER:
    case SHAPE_TUBE:
        break;
    default:
        return 0;
    }
    // The farthest points are among the corners, or on the rims at the ends of the axis.
    bool is_round = shape->kind == SHAPE_CYLINDER || shape->kind == SHAPE_TUBE;
    double across = is_round ? 0 : 1;
    double depth = shape->kind == SHAPE_BOX || shape->kind == SHAPE_SDF ? 1 : 0;
    for (int corner = 0; corner < 8; corner++) {
        const double signs[3] = {corner & 1 ? 1 : -1, corner & 2 ? across : -across,
                                 corner & 4 ? depth : -depth};
        double point[3];
        for (int i = 0; i < 3; i++)
            point[i] = shape->center[i] + signs[0] * shape->axes[0][i] +
                       signs[1] * shape->axes[1][i] + signs[2] * shape->axes[2][i];
        radius = fmax(radius, distance(point, center) + (is_round ? shape->radius : 0));
    }
    return radius;
}

double bounds_radius(const struct scene *scene, const struct scene_part *part,
                     const double center[3])
{
    struct reach reach = {center, 0};
    for (uint32_t i = 0; i < part->instance_count && !progress_should_stop(scene->progress); i++)
        each_corner(scene, &scene->instances[part->first_instance + i], extend_reach, &reach);
    for (uint32_t i = 0; i < part->shape_count; i++) {
        const struct shape *shape = &scene->shapes[part->first_shape + i];
        reach.radius = fmax(reach.radius, shape_radius(shape, center));
    }
    return reach.radius;
}
