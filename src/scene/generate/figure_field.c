// The field of a figure's parts: distances joined by smooth minima (Quilez 2013, "smooth minimum",
// the quadratic polynomial).
#include "scene/generate/figure_field.h"

#include "base/maths.h"
#include <math.h>
#include <string.h>

static double clamp_unit(double x)
{
    return x < 0 ? 0 : x > 1 ? 1 : x;
}

static double cone_distance(const struct part *part, const double p[3])
{
    double ap[3], ab[3], off[3];
    vec3_subtract(p, part->a, ap);
    vec3_subtract(part->b, part->a, ab);
    double t = clamp_unit(vec3_dot(ap, ab) / vec3_dot(ab, ab));
    for (int i = 0; i < 3; i++)
        off[i] = ap[i] - t * ab[i];
    return sqrt(vec3_dot(off, off)) - (part->radii[0] + t * (part->radii[1] - part->radii[0]));
}

// Returns the distance to first order: the value of |q| - 1 with q = p / radii, divided by the
// length of its gradient.
static double ellipsoid_distance(const struct part *part, const double p[3])
{
    double k = 0, g = 0;
    for (int i = 0; i < 3; i++) {
        double q = (p[i] - part->a[i]) / part->b[i];
        k += q * q;
        g += q * q / (part->b[i] * part->b[i]);
    }
    k = sqrt(k);
    double least = fmin(part->b[0], fmin(part->b[1], part->b[2]));
    return k < 1e-3 ? -least : k * (k - 1) / sqrt(g);
}

static double segment_square(const double a[3], const double b[3], const double p[3])
{
    double ap[3], ab[3], off[3];
    vec3_subtract(p, a, ap);
    vec3_subtract(b, a, ab);
    double t = clamp_unit(vec3_dot(ap, ab) / vec3_dot(ab, ab));
    for (int i = 0; i < 3; i++)
        off[i] = ap[i] - t * ab[i];
    return vec3_dot(off, off);
}

static double web_distance(const struct part *part, const double p[3])
{
    double u[3], v[3], w[3], n[3];
    vec3_subtract(part->b, part->a, u);
    vec3_subtract(part->c, part->a, v);
    vec3_subtract(p, part->a, w);
    vec3_cross(u, v, n);
    // The barycentric coordinates of the projection onto the triangle's plane.
    double uu = vec3_dot(u, u), uv = vec3_dot(u, v), vv = vec3_dot(v, v), wu = vec3_dot(w, u),
           wv = vec3_dot(w, v);
    double scale = uu * vv - uv * uv, s = (vv * wu - uv * wv) / scale,
           t = (uu * wv - uv * wu) / scale;
    double square = vec3_dot(w, n) * vec3_dot(w, n) / vec3_dot(n, n);
    if (s < 0 || t < 0 || s + t > 1)
        square =
            fmin(segment_square(part->a, part->b, p),
                 fmin(segment_square(part->b, part->c, p), segment_square(part->c, part->a, p)));
    return sqrt(square) - part->radii[0];
}

static double part_distance(const struct part *part, const double p[3])
{
    switch (part->kind) {
    case PART_CONE:
        return cone_distance(part, p);
    case PART_ELLIPSOID:
        return ellipsoid_distance(part, p);
    case PART_WEB:
        return web_distance(part, p);
    }
    return INFINITY;
}

static double smooth_min(double a, double b, double k)
{
    double h = k > 0 ? fmax(k - fabs(a - b), 0) / k : 0;
    return fmin(a, b) - 0.25 * k * h * h;
}

static void mirror(const struct part *part, const double p[3], double out[3])
{
    memcpy(out, p, 3 * sizeof *out);
    if (part->mirror == MIRROR_X)
        out[0] = fabs(p[0]);
    if (part->mirror == MIRROR_Z)
        out[2] = part->mirror_at + fabs(p[2] - part->mirror_at);
}

double figure_field_value(const struct figure_field *field, const double p[3], enum part_skin *skin)
{
    double value = INFINITY, nearest = INFINITY;
    for (uint32_t i = 0; i < field->count; i++) {
        const struct part *part = &field->parts[i];
        double q[3], off[3];
        mirror(part, p, q);
        vec3_subtract(q, field->centers[i], off);
        // A part that is farther away than its blend distance has no influence.
        double known = part->carves ? -value : value;
        double square = vec3_dot(off, off), least = known + part->blend + field->reach[i];
        if (isfinite(known) && (least < 0 || square > least * least))
            continue;
        double distance = part_distance(part, q);
        if (part->carves)
            value = -smooth_min(-value, distance, part->blend);
        else
            value = isfinite(value) ? smooth_min(value, distance, part->blend) : distance;
        if (!part->carves && distance < nearest) {
            nearest = distance;
            if (skin)
                *skin = part->skin;
        }
    }
    return value;
}

// Computes the gradient by differences over the corners of a tetrahedron.
void figure_field_normal(const struct figure_field *field, const double p[3], double step,
                         double out[3])
{
    static const double corners[4][3] = {{1, -1, -1}, {-1, -1, 1}, {-1, 1, -1}, {1, 1, 1}};
    double n[3] = {0, 0, 0};
    for (int k = 0; k < 4; k++) {
        double q[3];
        for (int i = 0; i < 3; i++)
            q[i] = p[i] + step * corners[k][i];
        double value = figure_field_value(field, q, NULL);
        for (int i = 0; i < 3; i++)
            n[i] += corners[k][i] * value;
    }
    double length = sqrt(vec3_dot(n, n));
    for (int i = 0; i < 3; i++)
        out[i] = length > 0 ? n[i] / length : 0;
}
