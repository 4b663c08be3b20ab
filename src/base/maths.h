// Vectors in double precision, angles, and the luminance of colours.
#ifndef LAMPYRIS_BASE_MATHS_H
#define LAMPYRIS_BASE_MATHS_H

#include <math.h>
#include <stdbool.h>

#define DEGREE (M_PI / 180)

static inline void vec3_widen(const float v[3], double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = (double)v[i];
}

static inline void vec3_subtract(const double a[3], const double b[3], double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = a[i] - b[i];
}

static inline double vec3_dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// `out` may be `a` or `b`.
static inline void vec3_cross(const double a[3], const double b[3], double out[3])
{
    double x = a[1] * b[2] - a[2] * b[1];
    double y = a[2] * b[0] - a[0] * b[2];
    double z = a[0] * b[1] - a[1] * b[0];
    out[0] = x;
    out[1] = y;
    out[2] = z;
}

// Returns the length, without intermediate overflow or underflow.
static inline double vec3_length(const double v[3])
{
    return hypot(hypot(v[0], v[1]), v[2]);
}

// Returns the length, faster than vec3_length(); squares of the components must neither overflow
// nor underflow.
static inline double vec3_norm(const double v[3])
{
    return sqrt(vec3_dot(v, v));
}

// Scales v to unit length without intermediate overflow or underflow. Returns false, with v
// unchanged, when it is zero or not finite.
bool vec3_normalize(double v[3]);
// As vec3_normalize(), but leaves a vector unchanged whose length is 1 up to a few roundings, so
// that a normalized vector that was written to a file reads back the same.
bool vec3_make_unit(double v[3]);

// Returns the luminance of a linear Rec. 709 colour (ITU-R BT.709-6, 3.2).
static inline double vec3_luminance(const double rgb[3])
{
    return 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
}

static inline double luminance(const float rgb[3])
{
    return vec3_luminance((const double[3]){(double)rgb[0], (double)rgb[1], (double)rgb[2]});
}

#endif
