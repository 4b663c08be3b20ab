// What makes estimates of the distance to fractals lower bounds of it. Nothing proves them; of
// three million probes that reach as far as an estimate, in all directions, so few find the surface
// nearer than the factor says as docs/distance-fields.md has in a table.
#include "scene/sdf/sdf.h"

double sdf_fractal_factor(const struct sdf_node *node)
{
    return node->op == SDF_MANDELBULB ? 0.5 : 0.2;
}
