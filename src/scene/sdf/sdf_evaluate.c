#include "scene/sdf/sdf_evaluate.h"

#include "base/maths.h"
#include "shared/sdf.h"
#include <assert.h>
#include <math.h>
#include <string.h>

// --- vectors -------------------------------------------------------------------------------------

static double length2(double x, double y)
{
    return sqrt(x * x + y * y);
}

static double largest(const double v[3])
{
    return fmax(v[0], fmax(v[1], v[2]));
}

static double clamp(double x, double low, double high)
{
    return fmin(fmax(x, low), high);
}

// Returns the signed distance from q to the octant of points without positive coordinates.
static double outside_corner(const double q[3])
{
    const double out[3] = {fmax(q[0], 0), fmax(q[1], 0), fmax(q[2], 0)};
    return vec3_norm(out) + fmin(largest(q), 0);
}

static double corner2(double x, double y)
{
    return length2(fmax(x, 0), fmax(y, 0)) + fmin(fmax(x, y), 0);
}

// --- shapes: distances in units of the current point's space -------------------------------------

struct operands {
    double a[3], b[4], c[4], d[4];
};

static double box(const double p[3], const double half[3], double round)
{
    double q[3];
    for (int i = 0; i < 3; i++)
        q[i] = fabs(p[i]) - half[i] + round;
    return outside_corner(q) - round;
}

static double frame(const double p[3], const double half[3], double bar)
{
    double q[3], r[3], nearest = INFINITY;
    for (int i = 0; i < 3; i++) {
        q[i] = fabs(p[i]) - half[i];
        r[i] = fabs(q[i] + bar) - bar;
    }
    for (int i = 0; i < 3; i++) { // bars of the frame along axis i
        double bars[3] = {r[0], r[1], r[2]};
        bars[i] = q[i];
        nearest = fmin(nearest, outside_corner(bars));
    }
    return nearest;
}

static double capsule(const double p[3], const double a[3], const double b[4])
{
    double along[3], from[3];
    for (int i = 0; i < 3; i++) {
        along[i] = b[i] - a[i];
        from[i] = p[i] - a[i];
    }
    double squared = vec3_dot(along, along);
    double h = squared > 0 ? clamp(vec3_dot(from, along) / squared, 0, 1) : 0;
    for (int i = 0; i < 3; i++)
        from[i] -= h * along[i];
    return vec3_norm(from) - b[3];
}

static double cone(const double p[3], const double a[3])
{
    double x = length2(p[0], p[2]), y = p[1];
    double side[2] = {a[1] - a[0], 2 * a[2]};
    double to_end[2] = {x - fmin(x, y < 0 ? a[0] : a[1]), fabs(y) - a[2]};
    double squared = side[0] * side[0] + side[1] * side[1];
    double h = ((a[1] - x) * side[0] + (a[2] - y) * side[1]) / squared;
    h = squared > 0 ? clamp(h, 0, 1) : 0;
    double to_side[2] = {x - a[1] + side[0] * h, y - a[2] + side[1] * h};
    double sign = to_side[0] < 0 && to_end[1] < 0 ? -1 : 1;
    return sign * fmin(length2(to_end[0], to_end[1]), length2(to_side[0], to_side[1]));
}

static double solid_angle(const double p[3], double radius, const double b[4])
{
    double x = length2(p[0], p[2]), y = p[1];
    double h = clamp(x * b[0] + y * b[1], 0, radius);
    double to_side = length2(x - h * b[0], y - h * b[1]);
    return fmax(length2(x, y) - radius, b[1] * x > b[0] * y ? to_side : -to_side);
}

static double gyroid(const double p[3], double k, double half, double bound)
{
    double sum = 0;
    for (int i = 0; i < 3; i++)
        sum += sin(k * p[i]) * cos(k * p[(i + 1) % 3]);
    return fabs(sum) / (k * bound) - half;
}

// Evaluates metaballs. Their centres and radii follow the instruction, at `words`.
static double metaballs(const double p[3], const struct operands *o,
                        const struct gpu_sdf_instruction *words, uint32_t count)
{
    double sum = 0, nearest = INFINITY;
    for (uint32_t i = 0; i < count; i++) {
        float ball[4];
        memcpy(ball, (const char *)words + i * sizeof ball, sizeof ball);
        double v[3], radius = (double)ball[3];
        for (int c = 0; c < 3; c++)
            v[c] = p[c] - (double)ball[c];
        double inside = fmax(0, 1 - vec3_dot(v, v) / (radius * radius));
        sum += inside * inside * inside;
        nearest = fmin(nearest, vec3_norm(v) - radius);
    }
    return (o->a[0] - sum) * o->a[1] + fmax(nearest, 0);
}

static double mandelbulb(const double p[3], const struct operands *o)
{
    double z[3] = {p[0], p[1], p[2]}, power = o->a[0], slope = 1;
    double r = vec3_norm(z);
    for (int i = 0; i < (int)o->a[1] && r <= o->a[2]; i++) {
        double polar = power * atan2(length2(z[0], z[2]), z[1]);
        double around = power * atan2(z[0], z[2]);
        // Around the polar axis the map stretches by sin(n theta) / sin(theta), which is at most n,
        // while it stretches by 1 along the radius. Near the axis the quotient consists of rounding
        // errors, so n is used there.
        double across = length2(z[0], z[2]), stretch = power;
        if (64 * across > r)
            stretch = fmin(fmax(r * fabs(sin(polar)) / across, 1), power);
        slope = power * pow(r, power - 1) * stretch * slope + 1;
        double scale = pow(r, power);
        z[0] = p[0] + scale * sin(polar) * sin(around);
        z[1] = p[1] + scale * cos(polar);
        z[2] = p[2] + scale * sin(polar) * cos(around);
        r = vec3_norm(z);
    }
    return r > 0 ? o->b[0] * 0.5 * log(r) * r / slope : 0;
}

static double menger(const double p[3], double half, int iterations)
{
    double q[3] = {p[0] / half, p[1] / half, p[2] / half}, scale = 1;
    double out[3] = {fabs(q[0]) - 1, fabs(q[1]) - 1, fabs(q[2]) - 1};
    double d = outside_corner(out);
    for (int i = 0; i < iterations; i++) {
        double r[3];
        for (int c = 0; c < 3; c++) {
            double folded = q[c] * scale - 2 * floor(0.5 * q[c] * scale + 0.5);
            r[c] = fabs(1 - 3 * fabs(folded));
        }
        scale *= 3;
        double cross = fmin(fmax(r[0], r[1]), fmin(fmax(r[1], r[2]), fmax(r[2], r[0])));
        d = fmax(d, (cross - 1) / scale);
    }
    return d * half;
}

static double apollonian(const double p[3], double inversion, int iterations, double factor)
{
    double q[3] = {p[0], p[1], p[2]}, scale = 1;
    for (int i = 0; i < iterations; i++) {
        for (int c = 0; c < 3; c++)
            q[c] -= 2 * floor(0.5 * q[c] + 0.5);
        double k = inversion / fmax(vec3_dot(q, q), 1e-12);
        for (int c = 0; c < 3; c++)
            q[c] *= k;
        scale *= k;
    }
    return factor * fabs(q[1]) / scale;
}

static double pyramid(const double p[3], double half, int iterations)
{
    double q[3] = {p[0] / half, p[1] / half, p[2] / half}, scale = 1;
    for (int i = 0; i < iterations; i++) {
        for (int c = 0; c < 3; c++) { // pairs of axes xy, xz, yz
            double *u = &q[c == 2], *v = &q[c == 0 ? 1 : 2];
            if (*u + *v < 0) {
                double old = *u;
                *u = -*v;
                *v = -old;
            }
        }
        for (int c = 0; c < 3; c++)
            q[c] = 2 * q[c] - 1;
        scale *= 0.5;
    }
    double out = fmax(fmax(-q[0] - q[1] - q[2], q[0] + q[1] - q[2]),
                      fmax(q[1] + q[2] - q[0], q[0] + q[2] - q[1]));
    return (out - 1) / sqrt(3) * scale * half;
}

static double shape(uint32_t op, const struct operands *o, const double p[3],
                    const struct gpu_sdf_instruction *next)
{
    switch (op & 0xffu) {
    case SDF_SPHERE:
        return vec3_norm(p) - o->a[0];
    case SDF_BOX:
        return box(p, o->a, o->b[0]);
    case SDF_FRAME:
        return frame(p, o->a, o->b[0]);
    case SDF_TORUS:
        return length2(length2(p[0], p[2]) - o->a[0], p[1]) - o->a[1];
    case SDF_CAPSULE:
        return capsule(p, o->a, o->b);
    case SDF_CONE:
        return cone(p, o->a);
    case SDF_SOLID_ANGLE:
        return solid_angle(p, o->a[0], o->b);
    case SDF_CYLINDER:
        return corner2(length2(p[0], p[2]) - o->a[0] + o->a[2], fabs(p[1]) - o->a[1] + o->a[2]) -
               o->a[2];
    case SDF_PLANE:
        return vec3_dot(p, o->a) - o->b[0];
    case SDF_GYROID:
        return gyroid(p, o->a[0], o->a[1], o->b[0]);
    case SDF_METABALLS:
        return metaballs(p, o, next, op >> 8);
    case SDF_MANDELBULB:
        return mandelbulb(p, o);
    case SDF_MENGER:
        return menger(p, o->a[0], (int)o->a[1]);
    case SDF_APOLLONIAN:
        return apollonian(p, o->a[0], (int)o->a[1], o->b[0]);
    default:
        return pyramid(p, o->a[0], (int)o->a[1]);
    }
}

// --- operations ----------------------------------------------------------------------------------

// Returns the smaller of the two values, or less than that if they differ by less than the width.
static double smooth_min(double x, double y, double width)
{
    double h = width > 0 ? fmax(width - fabs(x - y), 0) / width : 0;
    return fmin(x, y) - 0.25 * width * h * h;
}

static double combine(uint32_t op, double x, double y, double width)
{
    if (op == SDF_UNION)
        return smooth_min(x, y, width);
    return -smooth_min(-x, op == SDF_INTERSECTION ? -y : y, width);
}

// A point, and the scale of distances in its space.
struct place {
    double p[3], s;
};

static void move(uint32_t op, const struct operands *o, struct place *place)
{
    double p[3];
    memcpy(p, place->p, sizeof p);
    switch (op) {
    case SDF_TRANSFORM:
        place->p[0] = vec3_dot(o->b, p) + o->b[3];
        place->p[1] = vec3_dot(o->c, p) + o->c[3];
        place->p[2] = vec3_dot(o->d, p) + o->d[3];
        place->s *= o->a[0];
        return;
    case SDF_REPEAT:
        for (int i = 0; i < 3; i++)
            if (o->a[i] != 0)
                place->p[i] -= o->a[i] * clamp(floor(p[i] / o->a[i] + 0.5), -o->b[i], o->b[i]);
        return;
    case SDF_TWIST:
        place->p[0] = cos(o->a[0] * p[1]) * p[0] - sin(o->a[0] * p[1]) * p[2];
        place->p[2] = sin(o->a[0] * p[1]) * p[0] + cos(o->a[0] * p[1]) * p[2];
        place->s *= o->a[1];
        return;
    default: // SDF_MIRROR
        for (int i = 0; i < 3; i++)
            if (o->a[i] != 0)
                place->p[i] = fabs(p[i]);
        return;
    }
}

static void widen(const float *from, int count, double *to)
{
    for (int i = 0; i < count; i++)
        to[i] = (double)from[i];
}

double sdf_evaluate(const struct sdf *sdf, const double point[3])
{
    struct place places[SDF_POINTS_MAX + 1] = {{.s = 1}};
    double distances[SDF_DISTANCES_MAX] = {0};
    uint32_t depth = 0, count = 0;
    memcpy(places[0].p, point, sizeof places[0].p);
    for (uint32_t i = 0; i < sdf->count; i++) {
        const struct gpu_sdf_instruction *code = &sdf->code[i];
        uint32_t op = code->op & 0xffu;
        struct operands o;
        widen(code->a, 3, o.a);
        widen(code->b, 4, o.b);
        widen(code->c, 4, o.c);
        widen(code->d, 4, o.d);
        double length = o.a[0] * places[depth].s; // for operators whose operand is a length
        if (op <= SDF_PYRAMID) {
            assert(count < SDF_DISTANCES_MAX);
            distances[count++] = places[depth].s * shape(code->op, &o, places[depth].p, code + 1);
            i += op == SDF_METABALLS ? SDF_BALL_INSTRUCTIONS(code->op >> 8) : 0;
        } else if (op <= SDF_DIFFERENCE) {
            assert(count >= 2);
            count--;
            distances[count - 1] = combine(op, distances[count - 1], distances[count], length);
        } else if (op <= SDF_FACTOR) {
            assert(count >= 1);
            double *d = &distances[count - 1];
            *d = op == SDF_FACTOR ? *d * o.a[0] : (op == SDF_SHELL ? fabs(*d) : *d) - length;
        } else if (op == SDF_RESTORE) {
            assert(depth > 0);
            depth--;
        } else {
            assert(depth < SDF_POINTS_MAX);
            places[depth + 1] = places[depth];
            move(op, &o, &places[++depth]);
        }
    }
    return distances[0];
}
