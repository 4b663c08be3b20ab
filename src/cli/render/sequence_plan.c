#include "cli/render/sequence_plan.h"

#include "base/maths.h"
#include "scene/core/bounds.h"
#include "scene/core/framing.h"
#include <float.h>
#include <math.h>
#include <string.h>

uint32_t sequence_count(const struct sequence_options *options)
{
    if (options->views > 0)
        return options->views;
    double count = round((options->end - options->start) * options->frames_per_s);
    return count > 1.0 ? (uint32_t)count : 1;
}

double sequence_seconds(const struct sequence_options *options, uint32_t index)
{
    return options->start + index / options->frames_per_s;
}

double sequence_angle(const struct sequence_options *options, uint32_t index)
{
    return 2.0 * M_PI * index / options->views;
}

static void find_point(const struct scene *scene, struct turntable *t)
{
    const struct camera *camera = &t->camera;
    const struct scene_part whole = scene_whole(scene);
    const struct bounds bounds = bounds_of_part(scene, &whole);
    double to_middle[3], along = 0.0;
    for (int i = 0; i < 3; i++)
        to_middle[i] = (bounds.min[i] + bounds.max[i]) / 2 - camera->position[i];
    if (!bounds_is_empty(&bounds))
        along = fmax(vec3_dot(to_middle, camera->direction), 0.0);
    for (int i = 0; i < 3; i++)
        t->point[i] = camera->position[i] + along * camera->direction[i];
}

// Returns whether a direction is parallel to the axis. The same threshold applies to `up` in scene
// files.
static bool looks_along(const double direction[3], const double axis[3])
{
    double right[3];
    vec3_cross(direction, axis, right);
    return vec3_length(right) <= (double)FLT_EPSILON;
}

void turntable_init(const struct scene *scene, const struct camera *camera, bool has_up,
                    struct turntable *out)
{
    const struct scene_axes axes = scene_axes(scene->up);
    const bool is_own = !scene->is_model && !has_up && !scene->camera_is_framed;
    *out = (struct turntable){.camera = *camera};
    memcpy(out->axis, is_own ? camera->up : axes.up, sizeof out->axis);
    vec3_normalize(out->axis);
    find_point(scene, out);
    if (!looks_along(camera->direction, out->axis))
        memcpy(out->camera.up, out->axis, sizeof out->axis);
}

// Rotates v about a unit axis (Rodrigues' formula).
static void turn(const double axis[3], double angle, const double v[3], double out[3])
{
    double across[3], along = vec3_dot(axis, v) * (1.0 - cos(angle));
    vec3_cross(axis, v, across);
    for (int i = 0; i < 3; i++)
        out[i] = v[i] * cos(angle) + across[i] * sin(angle) + axis[i] * along;
}

void turntable_camera(const struct turntable *t, double angle, struct camera *out)
{
    double arm[3];
    *out = t->camera;
    if (angle == 0.0)
        return;
    vec3_subtract(t->camera.position, t->point, arm);
    turn(t->axis, angle, arm, arm);
    for (int i = 0; i < 3; i++)
        out->position[i] = t->point[i] + arm[i];
    turn(t->axis, angle, t->camera.direction, out->direction);
    vec3_normalize(out->direction);
    if (looks_along(t->camera.direction, t->axis))
        turn(t->axis, angle, t->camera.up, out->up);
}
