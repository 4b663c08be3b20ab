#include "light.h"

#include <math.h>

#define SPOT_WIDTH_MIN 1e-3

double versine(double angle)
{
    double sine = sin(0.5 * angle);
    return 2.0 * sine * sine;
}

double spot_width(const struct light *light)
{
    double width = versine((double)light->outer_angle) - versine((double)light->inner_angle);
    return width > SPOT_WIDTH_MIN ? width : SPOT_WIDTH_MIN;
}

// Over the cosines from the outer one to `width` above it a third of the width, and all of what is
// beyond.
double spot_solid_angle(const struct light *light)
{
    double width = spot_width(light), cone = versine((double)light->outer_angle);
    double sloped = cone < width ? cone : width;
    return 2.0 * M_PI * (sloped * sloped * sloped / (3.0 * width * width) + cone - sloped);
}
