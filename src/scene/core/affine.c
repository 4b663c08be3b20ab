#include "scene/core/affine.h"

#include <float.h>
#include <math.h>
#include <string.h>

const double AFFINE_IDENTITY[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};

void affine_multiply(const double a[3][4], const double b[3][4], double out[3][4])
{
    double product[3][4];
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 4; column++)
            product[row][column] = a[row][0] * b[0][column] + a[row][1] * b[1][column] +
                                   a[row][2] * b[2][column] + (column == 3 ? a[row][3] : 0.0);
    memcpy(out, product, sizeof product);
}

void affine_point(const double m[3][4], const double p[3], double out[3])
{
    affine_vector(m, p, out);
    for (int i = 0; i < 3; i++)
        out[i] += m[i][3];
}

void affine_vector(const double m[3][4], const double v[3], double out[3])
{
    double x = v[0], y = v[1], z = v[2];
    for (int i = 0; i < 3; i++)
        out[i] = m[i][0] * x + m[i][1] * y + m[i][2] * z;
}

// Rodrigues' rotation formula: R = cos I + sin [a]x + (1 - cos) a a^T for a unit axis a.
bool affine_rotation(const double axis[3], double angle, double out[3][4])
{
    double a[3] = {axis[0], axis[1], axis[2]};
    if (!vec3_normalize(a))
        return false;
    double cosine = cos(angle), sine = sin(angle);
    const double cross[3][3] = {{0, -a[2], a[1]}, {a[2], 0, -a[0]}, {-a[1], a[0], 0}};
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            out[i][j] = (i == j ? cosine : 0.0) + sine * cross[i][j] + (1 - cosine) * a[i] * a[j];
        out[i][3] = 0;
    }
    return true;
}

void affine_cofactors(const double m[3][4], double out[3][3])
{
    for (int i = 0; i < 3; i++)
        vec3_cross(m[(i + 1) % 3], m[(i + 2) % 3], out[i]);
}

double affine_determinant(const double m[3][4])
{
    double cofactors[3][3];
    affine_cofactors(m, cofactors);
    double determinant = vec3_dot(m[0], cofactors[0]);
    // Returns 0 for a determinant within its own rounding error. |det| is at most the product of
    // the rows' lengths (Hadamard). Each of the 9 multiplications and 5 additions errs by at most
    // DBL_EPSILON / 2 times that bound.
    double bound = vec3_length(m[0]) * vec3_length(m[1]) * vec3_length(m[2]);
    return fabs(determinant) > 16 * DBL_EPSILON * bound ? determinant : 0.0;
}

bool affine_inverse(const double m[3][4], double out[3][4])
{
    double cofactors[3][3], inverse[3][4], determinant = affine_determinant(m);
    if (determinant == 0 || !isfinite(determinant))
        return false;
    affine_cofactors(m, cofactors);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            inverse[i][j] = cofactors[j][i] / determinant;
        inverse[i][3] = 0;
        for (int j = 0; j < 3; j++)
            inverse[i][3] -= inverse[i][j] * m[j][3];
    }
    memcpy(out, inverse, sizeof inverse);
    return true;
}

void affine_box(const double m[3][4], const double min[3], const double max[3], double out_min[3],
                double out_max[3])
{
    double low[3], high[3];
    for (int i = 0; i < 3; i++) {
        low[i] = high[i] = m[i][3];
        for (int j = 0; j < 3; j++) {
            double a = m[i][j] * min[j], b = m[i][j] * max[j];
            low[i] += a < b ? a : b;
            high[i] += a < b ? b : a;
        }
    }
    memcpy(out_min, low, sizeof low);
    memcpy(out_max, high, sizeof high);
}

bool affine_uniform_scale(const double m[3][4], double *scale)
{
    // Matrices are often written with only six or seven digits, so the columns of a uniform scale
    // may have this relative error.
    const double tolerance = 1e-5;
    double columns[3][3], lengths[3];
    for (int j = 0; j < 3; j++) {
        for (int i = 0; i < 3; i++)
            columns[j][i] = m[i][j];
        lengths[j] = vec3_length(columns[j]);
    }
    *scale = cbrt(lengths[0] * lengths[1] * lengths[2]);
    double square = *scale * *scale;
    for (int j = 0; j < 3; j++) {
        if (!(fabs(lengths[j] - *scale) <= tolerance * *scale) ||
            !(fabs(vec3_dot(columns[j], columns[(j + 1) % 3])) <= tolerance * square))
            return false;
    }
    return true;
}
