#include "base/maths.h"

#include "solid_angle_reference.h"

#include <math.h>
#include <string.h>

struct spherical_triangle {
    double corner[3][3]; // unit vectors
    double angle[3];     // angles at the corners
};

static struct spherical_triangle spherical_triangle(double corners[3][3])
{
    struct spherical_triangle out;
    double normal[3][3]; // normal of the plane through a side and the point; number i is opposite
                         // corner i
    memcpy(out.corner, corners, sizeof out.corner);
    for (int i = 0; i < 3; i++)
        vec3_normalize(out.corner[i]);
    for (int i = 0; i < 3; i++)
        vec3_cross(out.corner[(i + 1) % 3], out.corner[(i + 2) % 3], normal[i]);
    for (int i = 0; i < 3; i++) {
        double across[3];
        vec3_cross(normal[(i + 1) % 3], normal[(i + 2) % 3], across);
        out.angle[i] =
            atan2(vec3_norm(across), -vec3_dot(normal[(i + 1) % 3], normal[(i + 2) % 3]));
    }
    return out;
}

// Girard's theorem.
double exact_solid_angle(double corners[3][3])
{
    struct spherical_triangle t = spherical_triangle(corners);
    return t.angle[0] + t.angle[1] + t.angle[2] - M_PI;
}

bool is_chosen_by_solid_angle(double solid_angle)
{
    return solid_angle >= 3e-4 && solid_angle <= 6.22;
}

// Removes from v its component along the unit vector `axis`, and normalises the rest.
static void across_axis(const double v[3], const double axis[3], double out[3])
{
    for (int c = 0; c < 3; c++)
        out[c] = v[c] - vec3_dot(v, axis) * axis[c];
    vec3_normalize(out);
}

// Arvo 1995, "Stratified sampling of spherical triangles", section 3, with A, B, C for the corners
// 0, 1, 2.
void exact_seen_point(double corners[3][3], const double u[2], double out[3])
{
    struct spherical_triangle t = spherical_triangle(corners);
    const double *a = t.corner[0], *b = t.corner[1], *c = t.corner[2];
    double alpha = t.angle[0], cos_c = vec3_dot(a, b);
    double area = u[0] * (t.angle[0] + t.angle[1] + t.angle[2] - M_PI);
    double sine = sin(area - alpha), cosine = cos(area - alpha);
    double p = cosine - cos(alpha), q = sine + sin(alpha) * cos_c;
    double cos_side =
        ((q * cosine - p * sine) * cos(alpha) - q) / ((q * sine + p * cosine) * sin(alpha));
    cos_side = fmin(fmax(cos_side, -1), 1);
    double along[3], end[3], direction[3];
    across_axis(c, a, along);
    for (int i = 0; i < 3; i++)
        end[i] = cos_side * a[i] + sqrt(1 - cos_side * cos_side) * along[i];
    double z = 1 - u[1] * (1 - vec3_dot(end, b));
    across_axis(end, b, along);
    for (int i = 0; i < 3; i++)
        direction[i] = z * b[i] + sqrt(fmax(0, 1 - z * z)) * along[i];

    double edge[2][3], normal[3];
    vec3_subtract(corners[1], corners[0], edge[0]);
    vec3_subtract(corners[2], corners[0], edge[1]);
    vec3_cross(edge[0], edge[1], normal);
    double distance = vec3_dot(corners[0], normal) / vec3_dot(direction, normal);
    for (int i = 0; i < 3; i++)
        out[i] = distance * direction[i];
}
