#include "render/probe/emitter_shape.h"

#include "base/maths.h"
#include "scene/core/emission.h"
#include "scene/core/environment.h"
#include "scene/core/light.h"
#include <math.h>

bool emitter_is_far(struct emitter_part part)
{
    return part.kind == EMITTER_SUN || part.kind == EMITTER_TEXEL;
}

static const struct flat_shape *shape_of(const struct renderer *r, struct emitter_part part)
{
    return &r->flat.shapes[part.index];
}

// Computes from + a u + b v.
static void combine(const double from[3], double a, const double u[3], double b, const double v[3],
                    double out[3])
{
    for (int c = 0; c < 3; c++)
        out[c] = from[c] + a * u[c] + b * v[c];
}

// Finds two unit vectors at right angles to each other and to a unit vector.
static void find_basis(const double normal[3], double u[3], double v[3])
{
    const double other[3] = {fabs(normal[0]) <= 0.6, fabs(normal[0]) > 0.6, 0};
    vec3_cross(normal, other, u);
    vec3_normalize(u);
    vec3_cross(normal, u, v);
}

// --- centres and sizes ---------------------------------------------------------------------------

// Finds corner 0 of a triangle and the two edges from it.
static void find_triangle(const struct renderer *r, uint32_t id, double corner[3],
                          double edges[2][3])
{
    vec3_widen(r->flat.triangles[id].v[0], corner);
    flat_triangle_edges(&r->flat, id, edges);
}

// Finds the direction of a position in a texel of the environment, by the convention of
// environment.h.
static void find_texel(const struct environment *environment, uint32_t index, double across,
                       double down, double out[3])
{
    uint32_t x = index % environment->width, y = index / environment->width;
    double longitude = 2 * M_PI * ((x + across) / environment->width - 0.5) - environment->rotation;
    double colatitude = M_PI * (y + down) / environment->height;
    out[0] = sin(colatitude) * cos(longitude);
    out[1] = cos(colatitude);
    out[2] = sin(colatitude) * sin(longitude);
}

void emitter_center(const struct renderer *r, struct emitter_part part, double out[3])
{
    double corner[3], edges[2][3];
    switch ((enum emitter_kind)part.kind) {
    case EMITTER_TRIANGLE:
        find_triangle(r, part.index, corner, edges);
        combine(corner, 1. / 3, edges[0], 1. / 3, edges[1], out);
        break;
    case EMITTER_SHAPE:
        vec3_widen(shape_of(r, part)->center, out);
        break;
    case EMITTER_SUN:
        for (int c = 0; c < 3; c++)
            out[c] = -r->scene->lights[part.index].direction[c];
        break;
    case EMITTER_TEXEL:
        find_texel(&r->scene->environment, part.index, 0.5, 0.5, out);
        break;
    }
}

static double triangle_radius(const struct renderer *r, struct emitter_part part)
{
    double corner[3], edges[2][3], center[3], from[3];
    emitter_center(r, part, center);
    find_triangle(r, part.index, corner, edges);
    vec3_subtract(corner, center, from);
    double radius = vec3_length(from);
    for (int i = 0; i < 2; i++) {
        combine(corner, 1, edges[i], -1, center, from);
        radius = fmax(radius, vec3_length(from));
    }
    return radius;
}

static double shape_radius(const struct flat_shape *shape)
{
    double square = 0;
    for (int i = 0; i < 3; i++) {
        double axis[3];
        vec3_widen(shape->axes[i], axis);
        bool is_unit = i > 0 && (shape->kind == SHAPE_CYLINDER || shape->kind == SHAPE_TUBE);
        square += is_unit ? 0 : vec3_dot(axis, axis);
    }
    bool is_round = shape->kind == SHAPE_SPHERE || shape->kind == SHAPE_DISC;
    return is_round ? (double)shape->radius : sqrt(square) + (double)shape->radius;
}

double emitter_radius(const struct renderer *r, struct emitter_part part)
{
    switch ((enum emitter_kind)part.kind) {
    case EMITTER_TRIANGLE:
        return triangle_radius(r, part);
    case EMITTER_SHAPE:
        return shape_radius(shape_of(r, part));
    case EMITTER_SUN:
        return tan(fmin(r->scene->lights[part.index].angular_radius, 1.5));
    default:
        return tan(M_PI / r->scene->environment.height);
    }
}

// Returns the area of the parallelogram with half edges u and v, projected along a direction.
static double seen_area(const double u[3], const double v[3], const double direction[3])
{
    double normal[3];
    vec3_cross(u, v, normal);
    return 4 * fabs(vec3_dot(normal, direction));
}

static double shape_area_across(const struct flat_shape *shape, const double direction[3])
{
    double axes[3][3], normal[3], radius = (double)shape->radius, disc = M_PI * radius * radius;
    vec3_widen(shape->normal, normal);
    for (int i = 0; i < 3; i++)
        vec3_widen(shape->axes[i], axes[i]);
    double half = vec3_length(axes[0]), along = vec3_dot(axes[0], direction);
    double side = 4 * radius * sqrt(fmax(half * half - along * along, 0));
    switch (shape->kind) {
    case SHAPE_SPHERE:
        return disc;
    case SHAPE_DISC:
        return disc * fabs(vec3_dot(normal, direction));
    case SHAPE_QUAD:
        return seen_area(axes[0], axes[1], direction);
    case SHAPE_CYLINDER:
        return side + disc * fabs(along) / half;
    case SHAPE_TUBE:
        return side;
    default:
        return seen_area(axes[0], axes[1], direction) + seen_area(axes[1], axes[2], direction) +
               seen_area(axes[2], axes[0], direction);
    }
}

double emitter_area(const struct renderer *r, struct emitter_part part, const double direction[3])
{
    const struct environment *environment = &r->scene->environment;
    double corner[3], edges[2][3], normal[3];
    switch ((enum emitter_kind)part.kind) {
    case EMITTER_TRIANGLE:
        find_triangle(r, part.index, corner, edges);
        vec3_cross(edges[0], edges[1], normal);
        return 0.5 * fabs(vec3_dot(normal, direction));
    case EMITTER_SHAPE:
        return shape_area_across(shape_of(r, part), direction);
    case EMITTER_SUN:
        return 2 * M_PI * versine(r->scene->lights[part.index].angular_radius);
    default:
        return environment_texel_solid_angle(environment, part.index / environment->width);
    }
}

// --- points --------------------------------------------------------------------------------------

// Places points evenly in [0, 1)^3: Roberts 2018, "The unreasonable effectiveness of quasirandom
// sequences".
static void place_in_cube(uint32_t number, uint32_t count, double out[3])
{
    out[0] = (number + 0.5) / count;
    out[1] = fmod(0.5 + number * 0.7548776662466927, 1);
    out[2] = fmod(0.5 + number * 0.5698402909980532, 1);
}

// Places points evenly in the unit disc: Vogel 1979, "A better way to construct the sunflower
// head".
static void place_in_disc(uint32_t number, uint32_t count, double out[2])
{
    double radius = sqrt((number + 0.5) / count), angle = number * 2.399963229728653;
    out[0] = radius * cos(angle);
    out[1] = radius * sin(angle);
}

static void place_in_disc_of(const double center[3], const double normal[3], double radius,
                             uint32_t number, uint32_t count, double out[3])
{
    double u[3], v[3], at[2];
    find_basis(normal, u, v);
    place_in_disc(number, count, at);
    combine(center, radius * at[0], u, radius * at[1], v, out);
}

// Places points over the outline of a shape, as seen along a direction. The caps of a cylinder are
// left out.
static void place_in_shape(const struct flat_shape *shape, const double direction[3],
                           uint32_t number, uint32_t count, double out[3])
{
    double center[3], axes[3][3], normal[3], at[3], across[3];
    vec3_widen(shape->center, center);
    vec3_widen(shape->normal, normal);
    for (int i = 0; i < 3; i++)
        vec3_widen(shape->axes[i], axes[i]);
    place_in_cube(number, count, at);
    switch (shape->kind) {
    case SHAPE_SPHERE:
        place_in_disc_of(center, direction, (double)shape->radius, number, count, out);
        break;
    case SHAPE_DISC:
        place_in_disc_of(center, normal, (double)shape->radius, number, count, out);
        break;
    case SHAPE_CYLINDER:
    case SHAPE_TUBE:
        vec3_cross(axes[0], direction, across);
        if (!vec3_normalize(across))
            for (int c = 0; c < 3; c++)
                across[c] = axes[1][c];
        combine(center, 2 * at[0] - 1, axes[0], (2 * at[1] - 1) * (double)shape->radius, across,
                out);
        break;
    default: // points in the whole volume of a box
        combine(center, 2 * at[0] - 1, axes[0], 2 * at[1] - 1, axes[1], out);
        combine(out, shape->kind == SHAPE_QUAD ? 0 : 2 * at[2] - 1, axes[2], 0, axes[2], out);
    }
}

void emitter_place(const struct renderer *r, struct emitter_part part, const double direction[3],
                   uint32_t number, uint32_t count, double out[3])
{
    double corner[3], edges[2][3], at[3];
    place_in_cube(number, count, at);
    switch ((enum emitter_kind)part.kind) {
    case EMITTER_TRIANGLE: {
        double root = sqrt(at[0]);
        find_triangle(r, part.index, corner, edges);
        combine(corner, root * (1 - at[1]), edges[0], root * at[1], edges[1], out);
        break;
    }
    case EMITTER_SHAPE:
        place_in_shape(shape_of(r, part), direction, number, count, out);
        break;
    case EMITTER_SUN:
        emitter_center(r, part, corner);
        place_in_disc_of(corner, corner, emitter_radius(r, part), number, count, out);
        vec3_normalize(out);
        break;
    case EMITTER_TEXEL:
        find_texel(&r->scene->environment, part.index, at[0], at[1], out);
        break;
    }
}

static const struct material *material_of(const struct renderer *r, struct emitter_part part)
{
    if (emitter_is_far(part))
        return NULL;
    return &r->scene
                ->materials[part.kind == EMITTER_TRIANGLE ? r->flat.triangles[part.index].material
                                                          : shape_of(r, part)->material];
}

double emitter_opacity(const struct renderer *r, struct emitter_part part)
{
    const struct material *material = material_of(r, part);
    return material && material->flags & MATERIAL_ALPHA_BLEND ? (double)material->opacity : 1;
}

void emitter_radiance(const struct renderer *r, struct emitter_part part, double out[3])
{
    const struct scene *scene = r->scene;
    const struct material *material = material_of(r, part);
    double limit = (double)scene->settings.clamp_limit;
    float emission[3] = {0};
    if (material)
        greatest_radiance(scene, material, emission);
    for (int c = 0; c < 3; c++) {
        if (material)
            out[c] = (double)emission[c];
        else if (part.kind == EMITTER_SUN)
            out[c] = environment_sun_radiance((double)scene->lights[part.index].radiant[c],
                                              scene->lights[part.index].angular_radius);
        else
            out[c] = (double)scene->environment.radiance[c] *
                     (double)scene->environment.texels[part.index][c];
        if (limit > 0)
            out[c] = fmin(out[c], limit);
    }
}
