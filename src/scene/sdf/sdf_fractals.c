// Factors that make distance estimates of fractals lower bounds. They are not proven but measured,
// with three million probes that moved by the estimate in all directions. docs/distance-fields.md
// lists the few probes that found the surface nearer than the factor permits.
#include "scene/sdf/sdf.h"

double sdf_fractal_factor(const struct sdf_node *node)
{
    return node->op == SDF_MANDELBULB ? 0.5 : 0.2;
}
