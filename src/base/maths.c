#include "base/maths.h"

#include <float.h>

bool vec3_normalize(double v[3])
{
    double largest = fmax(fmax(fabs(v[0]), fabs(v[1])), fabs(v[2]));
    if (!(largest > 0) || !isfinite(v[0]) || !isfinite(v[1]) || !isfinite(v[2]))
        return false;
    double scaled[3] = {v[0] / largest, v[1] / largest, v[2] / largest};
    double length = vec3_norm(scaled);
    for (int i = 0; i < 3; i++)
        v[i] = scaled[i] / length;
    return true;
}

// Dividing by a computed length leaves the squared length within about 4 DBL_EPSILON of 1; a column
// of a product of rotations stays within twice that.
bool vec3_make_unit(double v[3])
{
    return fabs(vec3_dot(v, v) - 1) <= 16 * DBL_EPSILON || vec3_normalize(v);
}
