#include "scene/core/light.h"

#include "scene/core/affine.h"
#include "shared/types.h"
#include <math.h>
#include <string.h>

#define SPOT_WIDTH_MIN 1e-3

const char *const light_kind_names[] = {
    [LIGHT_POINT] = "point",
    [LIGHT_SPOT] = "spot",
    [LIGHT_DIRECTIONAL] = "directional",
    NULL,
};

void light_init(struct light *light)
{
    memset(light, 0, sizeof *light); // clears padding: editors compare lights byte by byte
    light->name = "";
    light->kind = LIGHT_POINT;
    light->direction[1] = -1;
    light->range = INFINITY;
    light->outer_angle = (float)(M_PI / 4);
}

bool light_is_sun(const struct light *light)
{
    return !light->hidden && light->kind == LIGHT_DIRECTIONAL && light->angular_radius > 0.0;
}

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

// Over the cosines from the outer one to `width` above it, the falloff integrates to a third of
// `width`; above that range it is 1.
double spot_solid_angle(const struct light *light)
{
    double width = spot_width(light), cone = versine((double)light->outer_angle);
    double sloped = cone < width ? cone : width;
    return 2.0 * M_PI * (sloped * sloped * sloped / (3.0 * width * width) + cone - sloped);
}

void light_aim(struct light *light, const double direction[3])
{
    double d[3], x[3], former[3];
    memcpy(d, direction, sizeof d);
    memcpy(former, light->direction, sizeof former);
    if (!vec3_make_unit(d))
        return;
    memcpy(light->direction, d, sizeof d);
    if (!light->profile)
        return;
    // If profile_x is nearly parallel to the new axis, the old axis is nearly perpendicular to it.
    memcpy(x, light->profile_x, sizeof x);
    if (fabs(vec3_dot(x, d)) > 0.999)
        memcpy(x, former, sizeof x);
    double along = vec3_dot(x, d);
    for (int c = 0; c < 3; c++)
        x[c] -= along * d[c];
    if (vec3_normalize(x))
        memcpy(light->profile_x, x, sizeof x);
}
