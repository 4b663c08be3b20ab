#include "viewer/core/camera_rig.h"

#include "scene/core/affine.h"
#include <math.h>
#include <string.h>

// The least angle between the view and the vertical, where no sideways direction exists: a
// twentieth of a degree, which is two pixels of an image with 1080 lines and a field of view of 30
// degrees.
#define POLE_RADIANS (0.05 * DEGREE)
// The factor by which one notch of the mouse wheel scales the distance to the target. Seven notches
// halve it.
#define DOLLY_FACTOR 0.9
#define SLOW_FACTOR 0.1
// Fractions of the scene's diagonal: the distance flown per second, and the distance of the target
// if the camera looks past all objects.
#define SPEED_PART 0.2
#define TARGET_PART 0.5
// If the camera's right vector has a smaller vertical component than this, its roll is a rounding
// error.
#define ROLL_MIN 1e-6

const char *const camera_rig_mode_names[CAMERA_RIG_MODE_COUNT + 1] = {
    [CAMERA_RIG_FLY] = "fly",
    [CAMERA_RIG_ORBIT] = "orbit",
};

static void add_scaled(double to[3], const double v[3], double factor)
{
    for (int c = 0; c < 3; c++)
        to[c] += factor * v[c];
}

static void rotate(const double axis[3], double angle, double v[3])
{
    double m[3][4], out[3];
    if (angle == 0.0 || !affine_rotation(axis, angle, m))
        return;
    affine_vector(m, v, out);
    memcpy(v, out, sizeof out);
}

// Computes the camera's direction to the right. Returns false if the camera looks along `up`.
static bool sideways(const struct camera *camera, const double up[3], double out[3])
{
    vec3_cross(camera->direction, up, out);
    return vec3_normalize(out);
}

static void target_ahead(struct camera_rig *rig, const struct camera *camera, double distance)
{
    memcpy(rig->target, camera->position, sizeof rig->target);
    add_scaled(rig->target, camera->direction, distance);
}

static double distance_to_target(const struct camera_rig *rig, const struct camera *camera)
{
    double way[3];
    vec3_subtract(rig->target, camera->position, way);
    return vec3_length(way);
}

void camera_rig_init(struct camera_rig *rig, const struct camera *camera, const double min[3],
                     const double max[3])
{
    double size[3], to_middle[3];
    bool is_empty = !(max[0] >= min[0] && max[1] >= min[1] && max[2] >= min[2]);
    int axis = 0;
    for (int c = 0; c < 3; c++) {
        size[c] = is_empty ? 0.0 : max[c] - min[c];
        to_middle[c] = is_empty ? 0.0 : min[c] + 0.5 * size[c] - camera->position[c];
        if (fabs(camera->up[c]) > fabs(camera->up[axis]))
            axis = c;
    }
    double diagonal = vec3_length(size);
    if (!(diagonal > 0.0) || !isfinite(diagonal))
        diagonal = 1.0;
    *rig = (struct camera_rig){
        .mode = CAMERA_RIG_FLY,
        .speed = SPEED_PART * diagonal,
        .revolve_speed = 20.0,
        .look_degrees = 0.2,
    };
    rig->up[axis] = copysign(1.0, camera->up[axis]);
    double ahead = vec3_dot(to_middle, camera->direction);
    target_ahead(rig, camera, ahead > 0.0 ? ahead : TARGET_PART * diagonal);
}

// --- turning -------------------------------------------------------------------------------------

// Returns whether the camera is rolled. Roll is kept; a camera without roll uses the axis itself as
// `up`.
static bool has_roll(const struct camera_rig *rig, const struct camera *camera)
{
    double right[3];
    return sideways(camera, camera->up, right) && fabs(vec3_dot(right, rig->up)) > ROLL_MIN;
}

// Returns the part of a pitch (positive upwards) that keeps the view away from the poles. A view
// that is already too close to a pole can only move away from it.
static double allowed_pitch(const struct camera_rig *rig, const struct camera *camera, double pitch)
{
    double cosine = vec3_dot(camera->direction, rig->up);
    double from_up = acos(fmax(-1.0, fmin(cosine, 1.0)));
    double most = fmax(from_up - POLE_RADIANS, 0.0);
    double least = fmin(from_up - (M_PI - POLE_RADIANS), 0.0);
    return fmax(least, fmin(pitch, most));
}

// Rotates the camera's direction, its up vector and, unless it is NULL, a further vector: first
// about the up axis, then about the new sideways direction.
static void turn(const struct camera_rig *rig, double yaw, double pitch, struct camera *camera,
                 double offset[3])
{
    double right[3];
    bool rolled = has_roll(rig, camera);
    double *vectors[] = {camera->direction, camera->up, offset};
    for (int i = 0; i < 3 && vectors[i]; i++)
        rotate(rig->up, yaw, vectors[i]);
    pitch = allowed_pitch(rig, camera, pitch);
    if (sideways(camera, rig->up, right))
        for (int i = 0; i < 3 && vectors[i]; i++)
            rotate(right, pitch, vectors[i]);
    vec3_normalize(camera->direction);
    if (!rolled)
        memcpy(camera->up, rig->up, sizeof camera->up);
    vec3_normalize(camera->up);
}

// Rotates the camera about its target, which keeps its place in the image.
static void orbit(const struct camera_rig *rig, double yaw, double pitch, struct camera *camera)
{
    double offset[3], length;
    vec3_subtract(camera->position, rig->target, offset);
    length = vec3_length(offset);
    turn(rig, yaw, pitch, camera, offset);
    if (!vec3_normalize(offset))
        return;
    memcpy(camera->position, rig->target, sizeof camera->position);
    add_scaled(camera->position, offset, length);
}

// --- moving --------------------------------------------------------------------------------------

static bool fly(const struct camera_rig *rig, const struct camera_rig_input *input,
                struct camera *camera)
{
    double right[3], way[3] = {0};
    if (!sideways(camera, camera->up, right))
        return false;
    add_scaled(way, camera->direction, input->forward);
    add_scaled(way, right, input->right);
    add_scaled(way, rig->up, input->up);
    if (!vec3_normalize(way))
        return false;
    add_scaled(camera->position, way,
               rig->speed * (input->slow ? SLOW_FACTOR : 1.0) * input->seconds);
    return true;
}

// Returns the width of a pixel at the target, in metres.
static double pixel_size(const struct camera_rig *rig, const struct camera_rig_input *input,
                         const struct camera *camera)
{
    double height = input->picture_height > 0 ? input->picture_height : 1;
    double distance = distance_to_target(rig, camera);
    if (camera->kind == CAMERA_ORTHOGRAPHIC)
        return camera->height / height;
    if (camera->kind == CAMERA_PANORAMIC)
        return distance * M_PI / height;
    return 2.0 * distance * tan(0.5 * camera->fov_y) / height;
}

// Moves camera and target so that the point under the mouse stays under the mouse.
static void pan(struct camera_rig *rig, const struct camera_rig_input *input, struct camera *camera)
{
    double right[3], up[3], size = pixel_size(rig, input, camera);
    if (!sideways(camera, camera->up, right))
        return;
    vec3_cross(right, camera->direction, up);
    double *points[] = {camera->position, rig->target};
    for (int i = 0; i < 2; i++) {
        add_scaled(points[i], right, -input->pan[0] * size);
        add_scaled(points[i], up, input->pan[1] * size);
    }
}

// Moves the camera to the target or away from it. The image of an orthographic camera does not
// depend on its distance, so its height is scaled instead.
static void dolly(const struct camera_rig *rig, double notches, struct camera *camera)
{
    double factor = pow(DOLLY_FACTOR, notches), way[3];
    if (camera->kind == CAMERA_ORTHOGRAPHIC) {
        camera->height *= factor;
        return;
    }
    vec3_subtract(rig->target, camera->position, way);
    add_scaled(camera->position, way, 1.0 - factor);
}

// Compares bytes, because the camera counts as changed even if only the sign of a zero differs.
static bool same_bytes(const void *a, const void *b, size_t size)
{
    return memcmp(a, b, size) == 0;
}

// While the camera revolves, the keys for flying left and right change the speed of the revolution.
static bool steer_revolution(struct camera_rig *rig, const struct camera_rig_input *input)
{
    if (rig->mode != CAMERA_RIG_ORBIT || !rig->revolves)
        return false;
    double change = REVOLVE_ACCELERATION * (input->slow ? SLOW_FACTOR : 1.0) * input->seconds;
    double speed = rig->revolve_speed + input->right * change;
    rig->revolve_speed = fmax(-REVOLVE_SPEED_MAX, fmin(speed, REVOLVE_SPEED_MAX));
    return true;
}

// Returns the angle, in radians, by which a pixel of mouse movement turns the camera.
static double pixel_angle(const struct camera_rig *rig, const struct camera_rig_input *input)
{
    if (rig->mode == CAMERA_RIG_ORBIT && input->window_width > 0)
        return M_PI / input->window_width;
    return rig->look_degrees * DEGREE;
}

bool camera_rig_step(struct camera_rig *rig, const struct camera_rig_input *given,
                     struct camera *camera)
{
    struct camera before = *camera;
    struct camera_rig_input steered = *given, *input = &steered;
    if (steer_revolution(rig, input))
        steered.right = 0.0;
    double angle = pixel_angle(rig, input);
    double yaw = -input->look[0] * angle, pitch = -input->look[1] * angle;
    bool orbits = rig->mode == CAMERA_RIG_ORBIT;
    double revolution = orbits && rig->revolves ? rig->revolve_speed * input->seconds * DEGREE : 0;
    if (orbits && (yaw != 0.0 || pitch != 0.0 || revolution != 0.0))
        orbit(rig, yaw + revolution, pitch, camera);
    else if (yaw != 0.0 || pitch != 0.0)
        turn(rig, yaw, pitch, camera, NULL);
    if (input->pan[0] != 0.0 || input->pan[1] != 0.0)
        pan(rig, input, camera);
    if (input->dolly != 0.0)
        dolly(rig, input->dolly, camera);
    double from[3], way[3];
    memcpy(from, camera->position, sizeof from);
    if (fly(rig, input, camera) && orbits) { // the target moves with the camera
        vec3_subtract(camera->position, from, way);
        add_scaled(rig->target, way, 1.0);
    }
    return !same_bytes(&before, camera, sizeof before);
}

void camera_rig_focus(struct camera_rig *rig, const double point[3], struct camera *camera)
{
    double way[3];
    memcpy(rig->target, point, sizeof rig->target);
    vec3_subtract(point, camera->position, way);
    double ahead = vec3_dot(way, camera->direction);
    if (camera->lens_radius > 0.0 && ahead > 0.0)
        camera->focus_distance = ahead;
}

// Returns the distance from a sphere's centre at which the whole sphere is in view.
static double framing_distance(const struct camera *camera, double radius, double aspect)
{
    double half = 0.5 * camera->fov_y;
    if (camera->kind != CAMERA_PERSPECTIVE)
        return 2.0 * radius;
    if (aspect < 1.0)
        half = atan(aspect * tan(half));
    return radius / sin(half);
}

void camera_rig_frame(struct camera_rig *rig, const double min[3], const double max[3],
                      double aspect, struct camera *camera)
{
    double middle[3], half[3];
    for (int c = 0; c < 3; c++) {
        half[c] = 0.5 * (max[c] - min[c]);
        middle[c] = min[c] + half[c];
    }
    double radius = vec3_length(half);
    if (!(radius > 0.0) || !isfinite(radius))
        return;
    memcpy(rig->target, middle, sizeof middle);
    memcpy(camera->position, middle, sizeof middle);
    add_scaled(camera->position, camera->direction, -framing_distance(camera, radius, aspect));
    if (camera->kind == CAMERA_ORTHOGRAPHIC)
        camera->height = 2.0 * radius / fmin(aspect, 1.0);
}
