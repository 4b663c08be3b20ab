#include "bounds.h"

#include "affine.h"
#include <math.h>

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
    // Comparisons rather than fmin and fmax, which are function calls: this is the inner loop of
    // every pass over a mesh.
    for (int i = 0; i < 3; i++) {
        if (point[i] < bounds->min[i])
            bounds->min[i] = point[i];
        if (point[i] > bounds->max[i])
            bounds->max[i] = point[i];
    }
}

void bounds_add_shape(struct bounds *bounds, const struct shape *shape)
{
    double low[3], high[3];
    for (int i = 0; i < 3; i++) {
        // A disc reaches along an axis as far as the sine of the angle between axis and normal.
        double n = shape->normal[i];
        double reach = shape->kind == SHAPE_DISC ? sqrt(fmax(1 - n * n, 0)) : 1.0;
        low[i] = shape->center[i] - reach * shape->radius;
        high[i] = shape->center[i] + reach * shape->radius;
    }
    bounds_add_point(bounds, low);
    bounds_add_point(bounds, high);
}

bool bounds_is_empty(const struct bounds *bounds)
{
    return bounds->min[0] > bounds->max[0];
}

static void add_instance(const struct scene *scene, const struct instance *instance,
                         struct bounds *bounds)
{
    const struct mesh *mesh = &scene->meshes[instance->mesh];
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        for (int corner = 0; corner < 3; corner++) {
            double point[3];
            mesh_vertex(mesh, mesh->indices[t][corner], point);
            affine_point(instance->transform, point, point);
            bounds_add_point(bounds, point);
        }
    }
}

struct bounds bounds_of_part(const struct scene *scene, const struct scene_part *part)
{
    struct bounds bounds = BOUNDS_EMPTY;
    for (uint32_t i = 0; i < part->instance_count; i++)
        add_instance(scene, &scene->instances[part->first_instance + i], &bounds);
    for (uint32_t i = 0; i < part->shape_count; i++)
        bounds_add_shape(&bounds, &scene->shapes[part->first_shape + i]);
    return bounds;
}

static double distance(const double a[3], const double b[3])
{
    double difference[3];
    vec3_subtract(a, b, difference);
    return sqrt(vec3_dot(difference, difference));
}

static double instance_radius(const struct scene *scene, const struct instance *instance,
                              const double center[3])
{
    const struct mesh *mesh = &scene->meshes[instance->mesh];
    double radius = 0;
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        for (int corner = 0; corner < 3; corner++) {
            double point[3];
            mesh_vertex(mesh, mesh->indices[t][corner], point);
            affine_point(instance->transform, point, point);
            radius = fmax(radius, distance(point, center));
        }
    }
    return radius;
}

double bounds_radius(const struct scene *scene, const struct scene_part *part,
                     const double center[3])
{
    double radius = 0;
    for (uint32_t i = 0; i < part->instance_count; i++) {
        const struct instance *instance = &scene->instances[part->first_instance + i];
        radius = fmax(radius, instance_radius(scene, instance, center));
    }
    for (uint32_t i = 0; i < part->shape_count; i++) {
        const struct shape *shape = &scene->shapes[part->first_shape + i];
        radius = fmax(radius, distance(shape->center, center) + shape->radius);
    }
    return radius;
}
