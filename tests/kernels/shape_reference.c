#include "shape_reference.h"

// --- the shape -----------------------------------------------------------------------------------

static double unit(const float from[3], double out[3])
{
    for (int c = 0; c < 3; c++)
        out[c] = (double)from[c];
    double norm = vec3_norm(out);
    for (int c = 0; c < 3; c++)
        out[c] /= norm;
    return norm;
}

static void normalized_cross(const double a[3], const double b[3], double out[3])
{
    vec3_cross(a, b, out);
    double norm = vec3_norm(out);
    for (int c = 0; c < 3; c++)
        out[c] /= norm;
}

struct exact_shape exact_shape(const struct flat_shape *flat, double grown, double longer)
{
    struct exact_shape s = {.kind = flat->kind, .radius = (double)flat->radius + grown};
    for (int c = 0; c < 3; c++)
        s.center[c] = (double)flat->center[c];
    switch (flat->kind) {
    case SHAPE_DISC:
    case SHAPE_PLANE:
        unit(flat->normal, s.axis[2]);
        break;
    case SHAPE_QUAD:
    case SHAPE_BOX:
        for (int k = 0; k < 2; k++)
            s.half[k] = unit(flat->axes[k], s.axis[k]) + grown;
        normalized_cross(s.axis[0], s.axis[1], s.axis[2]);
        if (flat->kind == SHAPE_BOX)
            s.half[2] =
                (double)hypotf(hypotf(flat->axes[2][0], flat->axes[2][1]), flat->axes[2][2]) +
                grown;
        break;
    case SHAPE_CYLINDER:
    case SHAPE_TUBE:
        s.half[0] = unit(flat->axes[0], s.axis[0]) + longer;
        break;
    default:
        break;
    }
    return s;
}

double exact_size(const struct exact_shape *s)
{
    return fmax(fmax(s->half[0], s->half[1]), fmax(s->half[2], s->radius));
}

// --- crossings -----------------------------------------------------------------------------------

// Restricts the interval t[0] to t[1] to |along + rise t| <= half. Returns false if nothing is
// left.
static bool cut(double along, double rise, double half, double t[2])
{
    if (rise == 0 || half < 0)
        return fabs(along) <= half;
    double a = (-half - along) / rise, b = (half - along) / rise;
    t[0] = fmax(t[0], fmin(a, b));
    t[1] = fmin(t[1], fmax(a, b));
    return t[0] <= t[1];
}

// Intersects f + t d with the points at distance r from the origin.
static bool cross_round(const double f[3], const double d[3], double r, double t[2])
{
    double a = vec3_dot(d, d), b = -vec3_dot(f, d), c = vec3_dot(f, f) - r * r;
    double closest[3];
    if (a == 0)
        return c <= 0;
    for (int i = 0; i < 3; i++)
        closest[i] = f[i] + b / a * d[i];
    double rest = r * r - vec3_dot(closest, closest);
    if (rest < 0 || r < 0)
        return false;
    double q = b + (b < 0 ? -1 : 1) * sqrt(a * rest);
    t[0] = fmin(c / q, q / a);
    t[1] = fmax(c / q, q / a);
    return q != 0;
}

static void across(const double v[3], const double axis[3], double out[3])
{
    double along = vec3_dot(v, axis);
    for (int c = 0; c < 3; c++)
        out[c] = v[c] - along * axis[c];
}

static int cross_flat(const struct exact_shape *s, const double f[3], const double d[3],
                      double t[2])
{
    double p[3], edge[3], slope = vec3_dot(d, s->axis[2]);
    if (slope == 0)
        return 0;
    t[0] = -vec3_dot(f, s->axis[2]) / slope;
    for (int c = 0; c < 3; c++)
        p[c] = f[c] + t[0] * d[c];
    if (s->kind == SHAPE_DISC)
        return vec3_norm(p) <= s->radius;
    // For each edge, by the height over the other one.
    for (int k = 0; k < 2 && s->kind == SHAPE_QUAD; k++) {
        vec3_cross(s->axis[2], s->axis[1 - k], edge);
        if (fabs(vec3_dot(p, edge) / vec3_dot(s->axis[k], edge)) > s->half[k])
            return 0;
    }
    return 1;
}

static int cross_cylinder(const struct exact_shape *s, const double f[3], const double d[3],
                          double t[2])
{
    double f_across[3], d_across[3], round[2] = {-INFINITY, INFINITY};
    const double *n = s->axis[0];
    across(f, n, f_across);
    across(d, n, d_across);
    if (!cross_round(f_across, d_across, s->radius, round))
        return 0;
    if (s->kind == SHAPE_CYLINDER) {
        memcpy(t, round, sizeof round);
        return cut(vec3_dot(f, n), vec3_dot(d, n), s->half[0], t) ? 2 : 0;
    }
    int count = 0;
    for (int i = 0; i < 2; i++)
        if (fabs(vec3_dot(f, n) + round[i] * vec3_dot(d, n)) <= s->half[0])
            t[count++] = round[i];
    return count;
}

int exact_crossings(const struct exact_shape *s, const double origin[3], const double d[3],
                    double t[2])
{
    double f[3];
    for (int c = 0; c < 3; c++)
        f[c] = origin[c] - s->center[c];
    t[0] = -INFINITY;
    t[1] = INFINITY;
    switch (s->kind) {
    case SHAPE_SPHERE:
        return cross_round(f, d, s->radius, t) ? 2 : 0;
    case SHAPE_BOX:
        for (int k = 0; k < 3; k++)
            if (!cut(vec3_dot(f, s->axis[k]), vec3_dot(d, s->axis[k]), s->half[k], t))
                return 0;
        return 2;
    case SHAPE_CYLINDER:
    case SHAPE_TUBE:
        return cross_cylinder(s, f, d, t);
    default:
        return cross_flat(s, f, d, t);
    }
}

// --- heights -------------------------------------------------------------------------------------

double exact_height(const struct exact_shape *s, const double point[3], int at)
{
    double f[3], off_axis[3];
    for (int c = 0; c < 3; c++)
        f[c] = point[c] - s->center[c];
    switch (s->kind) {
    case SHAPE_SPHERE:
        return vec3_norm(f) - s->radius;
    case SHAPE_BOX: {
        int k = at < 0 ? -at - 1 : at - 1;
        return (at < 0 ? -1 : 1) * vec3_dot(f, s->axis[k]) - s->half[k];
    }
    case SHAPE_CYLINDER:
    case SHAPE_TUBE:
        if (at != 0)
            return at * vec3_dot(f, s->axis[0]) - s->half[0];
        across(f, s->axis[0], off_axis);
        return vec3_norm(off_axis) - s->radius;
    default:
        return vec3_dot(f, s->axis[2]);
    }
}

// --- points --------------------------------------------------------------------------------------

static double side_of(struct random *random)
{
    return random_u32(random) & 1u ? 1 : -1;
}

static void direction_across(const double axis[3], struct random *random, double out[3])
{
    float other[3];
    double v[3];
    random_direction(random, other);
    for (int c = 0; c < 3; c++)
        v[c] = (double)other[c];
    normalized_cross(axis, v, out);
}

static void point_of_box(const struct exact_shape *s, struct random *random, bool edge,
                         double point[3], double normal[3])
{
    uint32_t face = random_u32(random) % 3;
    double side = side_of(random);
    for (int c = 0; c < 3; c++)
        normal[c] = side * s->axis[face][c];
    for (uint32_t k = 0; k < 3; k++) {
        double along = k == face ? side : random_between(random, -1, 1);
        // On an edge or, if the next one is reached too, at a corner.
        if (edge && (k == (face + 1) % 3 || (random_u32(random) & 1u)))
            along = along < 0 ? -1 : 1;
        for (int c = 0; c < 3; c++)
            point[c] += along * s->half[k] * s->axis[k][c];
    }
}

static void point_of_cylinder(const struct exact_shape *s, struct random *random, bool edge,
                              double point[3], double normal[3])
{
    double out[3], side = side_of(random);
    bool cap = s->kind == SHAPE_CYLINDER && (random_u32(random) & 1u);
    direction_across(s->axis[0], random, out);
    double away = cap && !edge ? sqrt(random_unit(random)) : 1;
    double along = cap || edge ? side : random_between(random, -1, 1);
    for (int c = 0; c < 3; c++) {
        normal[c] = cap ? side * s->axis[0][c] : out[c];
        point[c] += along * s->half[0] * s->axis[0][c] + away * s->radius * out[c];
    }
}

void exact_point(const struct exact_shape *s, struct random *random, bool edge, double point[3],
                 double normal[3])
{
    float direction[3];
    double out[3], away = edge ? 1 : sqrt(random_unit(random));
    double a = random_between(random, -1, 1),
           b = edge ? side_of(random) : random_between(random, -1, 1);
    memcpy(point, s->center, sizeof s->center);
    memcpy(normal, s->axis[2], sizeof s->axis[2]);
    random_direction(random, direction);
    switch (s->kind) {
    case SHAPE_SPHERE:
        for (int c = 0; c < 3; c++) {
            normal[c] = (double)direction[c];
            point[c] += s->radius * normal[c];
        }
        break;
    case SHAPE_BOX:
        point_of_box(s, random, edge, point, normal);
        break;
    case SHAPE_CYLINDER:
    case SHAPE_TUBE:
        point_of_cylinder(s, random, edge, point, normal);
        break;
    case SHAPE_DISC:
    case SHAPE_PLANE:
        direction_across(s->axis[2], random, out);
        for (int c = 0; c < 3; c++)
            point[c] += away * s->radius * out[c];
        break;
    default:
        for (int c = 0; c < 3; c++)
            point[c] += a * s->half[0] * s->axis[0][c] + b * s->half[1] * s->axis[1][c];
        break;
    }
}

// --- scenes --------------------------------------------------------------------------------------

void add_random_shape(struct scene *scene, uint32_t kind, const double center[3], double size,
                      double aspect, bool upright, struct random *random)
{
    struct shape *shape = scene_add_shape(scene, NULL);
    REQUIRE(shape, "out of memory");
    double axes[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    if (!upright) {
        float direction[3];
        random_direction(random, direction);
        unit(direction, axes[0]);
        direction_across(axes[0], random, axes[1]);
        normalized_cross(axes[0], axes[1], axes[2]);
    }
    // The edges of a quad have any angle that is not small.
    for (int c = 0; c < 3 && kind == SHAPE_QUAD; c++)
        axes[1][c] += 0.7 * axes[0][c];
    shape->kind = kind;
    memcpy(shape->center, center, sizeof shape->center);
    memcpy(shape->normal, axes[2], sizeof shape->normal);
    // Cylinders are needles or coins.
    bool is_coin = kind < SHAPE_QUAD || (random_u32(random) & 1u);
    shape->radius = size * (is_coin ? 1 : pow(aspect, -random_unit(random)));
    for (int k = 0; k < 3; k++) {
        bool is_short = k > 0 || (is_coin && kind != SHAPE_QUAD && kind != SHAPE_BOX);
        double half = size * (is_short ? pow(aspect, -random_unit(random)) : 1);
        bool is_long = kind == SHAPE_QUAD || kind == SHAPE_BOX || k == 0;
        for (int c = 0; c < 3; c++)
            shape->axes[k][c] = axes[k][c] * (is_long ? half : 1);
    }
}
