// Factors that make distance estimates of fractals lower bounds. There is no proof. Three million
// probes went as far as an estimate in all directions; docs/distance-fields.md has a table of how
// few of these found the surface nearer than the factor permits.
#include "scene/sdf/sdf.h"

double sdf_fractal_factor(const struct sdf_node *node)
{
    return node->op == SDF_MANDELBULB ? 0.5 : 0.2;
}
