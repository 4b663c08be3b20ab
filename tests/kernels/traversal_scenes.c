#include "traversal_scenes.h"

#include "scene/generate/generate.h"

// --- scenes --------------------------------------------------------------------------------------

void add_soup(struct scene *scene, uint32_t count, double extent, double size,
              const double center[3], uint64_t seed)
{
    struct random random = {seed};
    float(*triangles)[3][3] = calloc(count, sizeof *triangles);
    for (uint32_t i = 0; triangles && i < count; i++) {
        double corner[3];
        for (int c = 0; c < 3; c++)
            corner[c] = center[c] + random_between(&random, -extent / 2, extent / 2);
        for (int v = 0; v < 3; v++)
            for (int c = 0; c < 3; c++)
                triangles[i][v][c] = (float)(corner[c] + random_between(&random, 0, size));
    }
    if (triangles)
        add_triangles(scene, (const float(*)[3][3])triangles, count, 0);
    free(triangles);
}

void add_slivers(struct scene *scene, uint32_t count, double aspect, uint64_t seed)
{
    struct random random = {seed};
    float(*triangles)[3][3] = calloc(count, sizeof *triangles);
    for (uint32_t i = 0; triangles && i < count; i++) {
        float along[3], other[3];
        random_direction(&random, along);
        random_direction(&random, other);
        for (int c = 0; c < 3; c++) {
            double corner = random_between(&random, -1, 1);
            triangles[i][0][c] = (float)corner;
            triangles[i][1][c] = (float)(corner + (double)along[c]);
            triangles[i][2][c] = (float)(corner + (double)along[c] / 2 + (double)other[c] / aspect);
        }
    }
    if (triangles)
        add_triangles(scene, (const float(*)[3][3])triangles, count, 0);
    free(triangles);
}

void add_spheres_and_discs(struct scene *scene, uint32_t count, uint64_t seed)
{
    struct random random = {seed};
    for (uint32_t i = 0; i < count; i++) {
        double center[3], normal[3];
        float direction[3];
        random_direction(&random, direction);
        for (int c = 0; c < 3; c++) {
            center[c] = random_between(&random, -0.5, 0.5);
            normal[c] = (double)direction[c];
        }
        // The radii span three orders of magnitude.
        double radius = 0.2 * pow(10, random_between(&random, -3, 0));
        if (i % 2 == 0)
            add_sphere(scene, center, radius, 0);
        else
            add_disc(scene, center, normal, radius, 0);
    }
}

bool add_blob(struct scene *scene, uint32_t triangles, double scale, const double center[3])
{
    uint32_t mesh;
    struct instance *instance =
        generate_blob(scene, triangles, 0, &mesh, NULL) ? scene_add_instance(scene, NULL) : NULL;
    if (!instance)
        return false;
    *instance = (struct instance){.mesh = mesh, .material = SCENE_NONE};
    for (int c = 0; c < 3; c++) {
        instance->transform[c][c] = scale;
        instance->transform[c][3] = center[c];
    }
    return true;
}

bool load_mesh_file(const char *name, struct scene *scene, struct err *err)
{
    char path[4096];
    const char *data = getenv("LAMPYRIS_DATA"), *root = getenv("LAMPYRIS_SOURCE_ROOT");
    snprintf(path, sizeof path, "%s%s/mesh/%s",
             data   ? ""
             : root ? root
                    : ".",
             data ? data : "/../shared/data", name);
    return scene_load(&(struct scene_load_params){.path = path}, scene, err);
}

// --- rays ----------------------------------------------------------------------------------------

void aim(const float from[3], const float to[3], float direction[3])
{
    double d[3];
    subtract(to, from, d);
    double factor = 1 / vec3_norm(d);
    for (int c = 0; c < 3; c++)
        direction[c] = (float)(d[c] * factor);
}

static void normalize(float v[3])
{
    static const float zero[3] = {0};
    aim(zero, v, v);
}

static void point_inside(const struct flat_scene *flat, struct random *random, float point[3])
{
    for (int c = 0; c < 3; c++)
        point[c] =
            (float)random_between(random, (double)flat->bounds_min[c], (double)flat->bounds_max[c]);
}

// Returns a point on a sphere about the centre of the bounds, with twice the radius of their
// bounding sphere.
static void point_around(const struct flat_scene *flat, struct random *random, float point[3])
{
    double diagonal[3];
    float direction[3];
    subtract(flat->bounds_max, flat->bounds_min, diagonal);
    random_direction(random, direction);
    for (int c = 0; c < 3; c++)
        point[c] = (float)(((double)flat->bounds_min[c] + (double)flat->bounds_max[c]) / 2 +
                           (double)direction[c] * vec3_norm(diagonal));
}

// Returns a vertex of a triangle, or the middle of one of its edges.
static void point_on_triangle_edge(const struct flat_triangle *triangle, struct random *random,
                                   float point[3])
{
    uint32_t a = random_u32(random) % 3, b = random_u32(random) % 2 ? a : (a + 1) % 3;
    for (int c = 0; c < 3; c++)
        point[c] = (float)(((double)triangle->v[a][c] + (double)triangle->v[b][c]) / 2);
}

// Returns a point near the outline of a sphere or disc, as seen from `origin`: inside or outside by
// 1e-8 to 1e-2 of its radius.
static void point_at_rim(const struct flat_shape *shape, const float origin[3],
                         struct random *random, float point[3])
{
    double axis[3], aside[3], other[3], radius = (double)shape->radius;
    float direction[3];
    random_direction(random, direction);
    for (int c = 0; c < 3; c++) {
        axis[c] = shape->kind == SHAPE_SPHERE ? (double)shape->center[c] - (double)origin[c]
                                              : (double)shape->normal[c];
        other[c] = (double)direction[c];
    }
    vec3_cross(axis, other, aside);
    // Seen from nearby, the outline of a sphere is in front of its centre.
    double sine = radius / vec3_norm(axis);
    if (shape->kind == SHAPE_SPHERE && sine < 1)
        radius /= sqrt(1 - sine * sine);
    double by = pow(10, random_between(random, -8, -2));
    radius *= random_u32(random) & 1u ? 1 + by : 1 - by;
    for (int c = 0; c < 3; c++)
        point[c] = (float)((double)shape->center[c] + radius * aside[c] / vec3_norm(aside));
}

static void point_on_edge(const struct flat_scene *flat, const float origin[3],
                          struct random *random, float point[3])
{
    uint32_t i = random_u32(random) % (flat->triangle_count + flat->shape_count);
    if (i < flat->triangle_count)
        point_on_triangle_edge(&flat->triangles[i], random, point);
    else
        point_at_rim(&flat->shapes[i - flat->triangle_count], origin, random, point);
}

bool ray_is_delicate(uint32_t ray)
{
    return ray % 8 == 7;
}

static float signed_zero(struct random *random)
{
    return random_u32(random) & 1u ? -0.0f : 0.0f;
}

// Keeps `components` components of a direction and replaces the others by zeros of either sign.
static void flatten_ray(struct random *random, uint32_t components, struct probe_ray *ray)
{
    uint32_t first = random_u32(random) % 3;
    for (uint32_t i = components; i < 3; i++)
        ray->direction[(first + i) % 3] = signed_zero(random);
    if (ray->direction[first] == 0.0f)
        ray->direction[first] = 1.0f;
    normalize(ray->direction);
}

void random_closest_rays(const struct flat_scene *flat, uint32_t count, uint64_t seed,
                         struct probe_ray *rays)
{
    struct random random = {seed};
    for (uint32_t i = 0; i < count; i++) {
        struct probe_ray *ray = &rays[i];
        float target[3];
        if (i % 3 == 0)
            point_inside(flat, &random, ray->origin);
        else
            point_around(flat, &random, ray->origin);
        if (ray_is_delicate(i))
            point_on_edge(flat, ray->origin, &random, target);
        else
            point_inside(flat, &random, target);
        aim(ray->origin, target, ray->direction);
        switch (i % 8) {
        case 4: // along an axis
            point_inside(flat, &random, ray->origin);
            flatten_ray(&random, 1, ray);
            break;
        case 5: // in a coordinate plane
            point_inside(flat, &random, ray->origin);
            flatten_ray(&random, 2, ray);
            break;
        case 6: // nearly in a coordinate plane, down to components whose square underflows
            ray->direction[random_u32(&random) % 3] =
                (float)pow(10, random_between(&random, -30, -3));
            normalize(ray->direction);
            break;
        default:
            break;
        }
    }
}

// Makes a segment through a point of a triangle, with a length from a hundred-thousandth of the
// scene's extent to all of it.
static void cross_triangle(const struct flat_scene *flat, struct random *random,
                           struct probe_ray *ray)
{
    const struct flat_triangle *triangle =
        &flat->triangles[random_u32(random) % flat->triangle_count];
    double diagonal[3], u = random_unit(random), v = random_unit(random) * (1 - u);
    subtract(flat->bounds_max, flat->bounds_min, diagonal);
    double reach = vec3_norm(diagonal) * pow(10, random_between(random, -5, 0));
    double before = random_unit(random);
    float direction[3];
    random_direction(random, direction);
    for (int c = 0; c < 3; c++) {
        double point = (1 - u - v) * (double)triangle->v[0][c] + u * (double)triangle->v[1][c] +
                       v * (double)triangle->v[2][c];
        ray->direction[c] = (float)(reach * (double)direction[c]);
        ray->origin[c] = (float)(point - before * reach * (double)direction[c]);
    }
}

void random_shadow_rays(const struct flat_scene *flat, uint32_t count, uint64_t seed,
                        struct probe_ray *rays)
{
    struct random random = {seed};
    for (uint32_t i = 0; i < count; i++) {
        struct probe_ray *ray = &rays[i];
        float target[3];
        if (i % 2 == 0)
            point_inside(flat, &random, ray->origin);
        else
            point_around(flat, &random, ray->origin);
        if (ray_is_delicate(i))
            point_on_edge(flat, ray->origin, &random, target);
        else
            point_inside(flat, &random, target);
        for (int c = 0; c < 3; c++)
            ray->direction[c] = target[c] - ray->origin[c];
        if (i % 8 == 6)
            ray->direction[random_u32(&random) % 3] = signed_zero(&random);
        if (i % 16 == 15 && flat->triangle_count > 0)
            cross_triangle(flat, &random, ray);
    }
}
