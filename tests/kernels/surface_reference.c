#include "surface_reference.h"

#include "solid_angle_reference.h"

static void load_triangle(const struct renderer *r, const struct gpu_path *path,
                          struct surface_point *out)
{
    uint32_t index = r->bvh.triangle_order[path->primitive];
    const struct flat_triangle *triangle = &r->flat.triangles[index];
    double edge[2][3],
        weight[3] = {1 - (double)path->u - (double)path->v, (double)path->u, (double)path->v};
    subtract(triangle->v[1], triangle->v[0], edge[0]);
    subtract(triangle->v[2], triangle->v[0], edge[1]);
    vec3_cross(edge[0], edge[1], out->geometric);
    vec3_normalize(out->geometric);
    memcpy(out->shading, out->geometric, sizeof out->shading);
    for (int c = 0; c < 3; c++) {
        out->plane_point[c] = (double)triangle->v[0][c];
        out->position[c] = 0;
        for (int v = 0; v < 3; v++)
            out->position[c] += weight[v] * (double)triangle->v[v][c];
    }
    if (r->flat.normals) {
        for (int c = 0; c < 3; c++) {
            out->shading[c] = 0;
            for (int v = 0; v < 3; v++)
                out->shading[c] += weight[v] * (double)r->flat.normals[index][v][c];
        }
        vec3_normalize(out->shading);
    }
    out->triangle = triangle;
    out->material = &r->scene->materials[triangle->material];
}

static void load_shape(const struct renderer *r, const struct gpu_path *path,
                       struct surface_point *out)
{
    const struct flat_shape *shape = &r->flat.shapes[path->primitive & ~PRIMITIVE_SHAPE];
    for (int c = 0; c < 3; c++) {
        out->position[c] = (double)path->origin[c] + (double)path->t * (double)path->direction[c];
        out->plane_point[c] = (double)shape->center[c];
        out->geometric[c] = shape->kind == SHAPE_SPHERE
                                ? out->position[c] - (double)shape->center[c]
                                : (double)shape->normal[c];
    }
    vec3_normalize(out->geometric);
    memcpy(out->shading, out->geometric, sizeof out->shading);
    out->shape = shape;
    out->material = &r->scene->materials[shape->material];
}

static void turn_to(double normal[3], const double towards[3])
{
    double sign = vec3_dot(normal, towards) < 0 ? -1 : 1;
    for (int c = 0; c < 3; c++)
        normal[c] *= sign;
}

struct surface_point surface_at(const struct renderer *r, const struct gpu_path *path)
{
    struct surface_point out = {.distance = (double)path->t};
    double back[3];
    for (int c = 0; c < 3; c++)
        back[c] = -(double)path->direction[c];
    if (path->primitive & PRIMITIVE_SHAPE)
        load_shape(r, path, &out);
    else
        load_triangle(r, path, &out);
    turn_to(out.geometric, back);
    turn_to(out.shading, out.geometric);
    return out;
}

// --- lights --------------------------------------------------------------------------------------

double pick_density(const struct renderer *r, const struct material *material)
{
    double power = 0;
    for (uint32_t i = 0; i < r->flat.triangle_count; i++) {
        const struct flat_triangle *triangle = &r->flat.triangles[i];
        double edge[2][3], normal[3];
        subtract(triangle->v[1], triangle->v[0], edge[0]);
        subtract(triangle->v[2], triangle->v[0], edge[1]);
        vec3_cross(edge[0], edge[1], normal);
        power +=
            luminance(r->scene->materials[triangle->material].emission) * vec3_norm(normal) / 2;
    }
    for (uint32_t i = 0; i < r->flat.shape_count; i++) {
        const struct flat_shape *shape = &r->flat.shapes[i];
        double radius = (double)shape->radius;
        power += luminance(r->scene->materials[shape->material].emission) * M_PI * radius * radius *
                 (shape->kind == SHAPE_SPHERE ? 4 : 1);
    }
    return power > 0 ? luminance(material->emission) / power : 0;
}

double light_density(const struct renderer *r, const double origin[3], const double direction[3],
                     const struct surface_point *light)
{
    double density = pick_density(r, light->material);
    if (light->shape && light->shape->kind == SHAPE_SPHERE) {
        double to_center[3], radius = (double)light->shape->radius;
        for (int c = 0; c < 3; c++)
            to_center[c] = (double)light->shape->center[c] - origin[c];
        double sine = radius / vec3_norm(to_center);
        // From outside the sphere: uniform in the cone that it subtends.
        if (sine < 1)
            return density * 4 * M_PI * radius * radius / (2 * M_PI * (1 - sqrt(1 - sine * sine)));
    }
    if (light->triangle) {
        double corners[3][3], edge[2][3], normal[3];
        for (int i = 0; i < 3; i++)
            for (int c = 0; c < 3; c++)
                corners[i][c] = (double)light->triangle->v[i][c] - origin[c];
        vec3_subtract(corners[1], corners[0], edge[0]);
        vec3_subtract(corners[2], corners[0], edge[1]);
        vec3_cross(edge[0], edge[1], normal);
        double solid_angle = exact_solid_angle(corners);
        if (is_chosen_by_solid_angle(solid_angle))
            return density * vec3_norm(normal) / 2 / solid_angle;
    }
    return density * light->distance * light->distance /
           fabs(vec3_dot(direction, light->geometric));
}

double power_heuristic(double pdf, double other_pdf)
{
    return pdf * pdf / (pdf * pdf + other_pdf * other_pdf);
}

// --- random numbers ------------------------------------------------------------------------------

void random_4d(uint32_t pixel, uint32_t sample, uint32_t dimension, uint32_t seed, double out[4])
{
    uint32_t v[4] = {pixel, sample, dimension, seed};
    pcg4d(v);
    for (int i = 0; i < 4; i++)
        out[i] = (v[i] >> 8) * 0x1p-24;
}
