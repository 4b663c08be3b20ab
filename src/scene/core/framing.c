#include "scene/core/framing.h"

#include "scene/core/affine.h"
#include "scene/core/bounds.h"
#include <math.h>
#include <string.h>

// A three-quarter view: from the front right, which shows depth, and from above, which shows the
// ground. The field of view is that of a 45 mm lens and film 24 mm high, which hardly distorts.
#define FRAMED_AZIMUTH (35 * DEGREE)
#define FRAMED_ELEVATION (20 * DEGREE)
#define FRAMED_FOV_Y (30 * DEGREE)
// The fraction of the image's width or height, whichever is the tighter, that the model fills. The
// rest is a margin and shows the model's shadow.
#define FRAMED_PART 0.8

struct scene_axes scene_axes(enum scene_up up)
{
    static const struct scene_axes axes[] = {
        [SCENE_UP_Y] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
        [SCENE_UP_X] = {{0, -1, 0}, {1, 0, 0}, {0, 0, 1}},
        [SCENE_UP_Z] = {{1, 0, 0}, {0, 0, 1}, {0, -1, 0}},
    };
    return axes[up];
}

static void combine(const struct scene_axes *axes, double right, double up, double front,
                    double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = right * axes->right[i] + up * axes->up[i] + front * axes->front[i];
}

void framing_towards_camera(enum scene_up up, double out[3])
{
    const struct scene_axes axes = scene_axes(up);
    combine(&axes, cos(FRAMED_ELEVATION) * sin(FRAMED_AZIMUTH), sin(FRAMED_ELEVATION),
            cos(FRAMED_ELEVATION) * cos(FRAMED_AZIMUTH), out);
}

// The model to frame, in camera axes: x to the right, y up, z towards the camera.
struct subject {
    const struct scene *scene;
    double axes[3][3];
    double center[3]; // centre of the model's bounding box
    bool is_a_point;  // true for an empty model, too; both are framed like a ball of radius 1
};

// Computes for out[0] the largest (s + t z).v over the model's points v relative to its centre.
// Here s is the camera's x or y axis (0 or 1), z is its z axis, and t is `tangent`. For out[1], s
// is negated.
static void support_pair(const struct subject *subject, int axis, double tangent, double out[2])
{
    double normals[2][3];
    for (int i = 0; i < 3; i++) {
        normals[0][i] = subject->axes[axis][i] + tangent * subject->axes[2][i];
        normals[1][i] = -subject->axes[axis][i] + tangent * subject->axes[2][i];
    }
    const struct scene_part whole = scene_whole(subject->scene);
    if (!subject->is_a_point)
        bounds_support(subject->scene, &whole, 2, (const double(*)[3])normals, out);
    for (int i = 0; i < 2; i++)
        out[i] = subject->is_a_point ? vec3_length(normals[i])
                                     : out[i] - vec3_dot(normals[i], subject->center);
}

// Computes the nearest camera position that sees the whole model along one axis of the image. The
// model lies between two planes through the camera, at slope `tangent` on either side of the
// camera's z axis, and touches both. With a and b the supports (see support_pair), a camera at (p,
// d) along x and z needs t d >= a - p and t d >= b + p. The nearest position has p = (a - b) / 2
// and d = (a + b) / 2t.
static double fit_pair(const struct subject *subject, int axis, double tangent, double *position)
{
    double support[2];
    support_pair(subject, axis, tangent, support);
    *position = (support[0] - support[1]) / 2;
    return (support[0] + support[1]) / (2 * tangent);
}

// Finds the position that centres the model at a given distance d: both planes are equally tight at
// the tangent t = (a(t) + b(t)) / 2d. The derivative of a and b with respect to t is the depth of a
// point, which is less than a quarter of the distance. So each step of this iteration reduces the
// error to a quarter, and five steps reduce it to 4^-5.
static double center_pair(const struct subject *subject, int axis, double tangent, double distance)
{
    double position;
    for (int i = 0; i < 5; i++)
        tangent *= fit_pair(subject, axis, tangent, &position) / distance;
    return position;
}

void scene_frame_camera(struct scene *scene)
{
    if (!scene->camera_is_framed || scene->camera_count == 0)
        return;
    const double aspect = (double)scene->settings.width / scene->settings.height;
    const double up = FRAMED_PART * tan(FRAMED_FOV_Y / 2);
    const double tangent[2] = {aspect * up, up};
    const struct scene_axes axes = scene_axes(scene->up);
    const struct scene_part whole = scene_whole(scene);
    const struct bounds bounds = bounds_of_part(scene, &whole);
    struct subject subject = {.scene = scene, .is_a_point = bounds_are_a_point(&bounds)};
    for (int i = 0; i < 3 && !bounds_is_empty(&bounds); i++)
        subject.center[i] = (bounds.min[i] + bounds.max[i]) / 2;
    framing_towards_camera(scene->up, subject.axes[2]);
    vec3_cross(axes.up, subject.axes[2], subject.axes[0]);
    vec3_normalize(subject.axes[0]);
    vec3_cross(subject.axes[2], subject.axes[0], subject.axes[1]);

    double position[2], distance[2];
    for (int i = 0; i < 2; i++)
        distance[i] = fit_pair(&subject, i, tangent[i], &position[i]);
    int tight = distance[0] > distance[1] ? 0 : 1, loose = 1 - tight;
    position[loose] = center_pair(&subject, loose, tangent[loose], distance[tight]);
    struct camera *camera = &scene->cameras[0];
    for (int i = 0; i < 3; i++) {
        camera->position[i] = subject.center[i] + position[0] * subject.axes[0][i] +
                              position[1] * subject.axes[1][i] +
                              distance[tight] * subject.axes[2][i];
        camera->direction[i] = -subject.axes[2][i];
        camera->up[i] = axes.up[i];
    }
    camera->fov_y = FRAMED_FOV_Y;
}

bool scene_provide_camera(struct scene *scene, struct err *err)
{
    if (scene->camera_count > 0)
        return true;
    struct camera *camera = scene_add_camera(scene, NULL);
    if (!camera)
        return err_memory(err, "a camera", sizeof *camera);
    camera->name = "framed";
    scene->camera_is_framed = true;
    scene_frame_camera(scene);
    return true;
}
