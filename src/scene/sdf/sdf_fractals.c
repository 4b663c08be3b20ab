// Factors that make estimates of the distance to fractals lower bounds. There is no proof:
// docs/distance-fields.md has a table of how few of three million probes, which go as far as an
// estimate in all directions, find the surface nearer than the factor allows.
#include "scene/sdf/sdf.h"

double sdf_fractal_factor(const struct sdf_node *node)
{
    return node->op == SDF_MANDELBULB ? 0.5 : 0.2;
}
