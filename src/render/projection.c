#include "render/projection.h"

#include "base/maths.h"
#include "render/far_camera.h"
#include "shared/methods.h"
#include <math.h>

static void scale_to(double v[3], double length)
{
    double factor = length / vec3_norm(v);
    for (int i = 0; i < 3; i++)
        v[i] *= factor;
}

void projection_make(const struct camera *camera, const struct flat_scene *flat, uint32_t width,
                     uint32_t height, struct projection *out)
{
    double half_height = camera->kind == CAMERA_ORTHOGRAPHIC ? 0.5 * camera->height * flat->scale
                                                             : tan(0.5 * camera->fov_y);
    bool is_panoramic = camera->kind == CAMERA_PANORAMIC;
    *out = (struct projection){
        .kind = camera->kind,
        .width = width,
        .height = height,
        .lens_radius = camera->lens_radius * flat->scale,
        .focus_distance = camera->focus_distance * flat->scale,
    };
    for (int i = 0; i < 3; i++)
        out->forward[i] = camera->direction[i];
    vec3_cross(camera->direction, camera->up, out->right);
    vec3_cross(out->right, camera->direction, out->up);
    scale_to(out->right, is_panoramic ? 1.0 : half_height * width / height);
    scale_to(out->up, is_panoramic ? 1.0 : half_height);
    flat_from_world(flat, camera->position, out->position);
    out->start = far_camera_start(flat, camera, out->right, out->up);
}

void projection_ray(const struct projection *p, double x, double y, double origin[3],
                    double direction[3])
{
    double across = 2.0 * x / p->width - 1.0, upwards = 1.0 - 2.0 * y / p->height;
    double longitude = across * M_PI, latitude = upwards * 0.5 * M_PI;
    for (int i = 0; i < 3; i++) {
        double in_picture = across * p->right[i] + upwards * p->up[i], forward = p->forward[i];
        double level = cos(longitude) * forward + sin(longitude) * p->right[i];
        bool is_parallel = p->kind == CAMERA_ORTHOGRAPHIC;
        direction[i] = p->kind == CAMERA_PANORAMIC
                           ? cos(latitude) * level + sin(latitude) * p->up[i]
                           : forward + (is_parallel ? 0.0 : in_picture);
        origin[i] = p->position[i] +
                    (is_parallel ? p->start * forward + in_picture : p->start * direction[i]);
    }
    vec3_normalize(direction);
}

// Places a projected point in the image; `across` and `upwards` are its coordinates, from -1 to 1.
static void place(const struct projection *p, double across, double upwards, struct projected *out)
{
    out->x = 0.5 * (across + 1.0) * p->width;
    out->y = 0.5 * (1.0 - upwards) * p->height;
}

// Sets the origin, the direction and the length of the ray to a point.
static void aim(const struct projection *p, const double to[3], const double start[3],
                struct projected *out)
{
    double ray[3];
    vec3_subtract(to, start, ray);
    out->distance = vec3_length(ray);
    for (int i = 0; i < 3; i++) {
        out->origin[i] = p->position[i] + start[i];
        out->direction[i] = out->distance > 0.0 ? ray[i] / out->distance : p->forward[i];
    }
}

// Projects a point for a panoramic camera, whose pixels cover solid angles.
static bool find_panoramic(const struct projection *p, const double to[3], struct projected *out)
{
    aim(p, to, (const double[3]){0.0, 0.0, 0.0}, out);
    double sine = fmin(fmax(vec3_dot(out->direction, p->up), -1.0), 1.0);
    double cosine = sqrt((1.0 - sine) * (1.0 + sine)), distance = out->distance;
    place(p, atan2(vec3_dot(to, p->right), vec3_dot(to, p->forward)) / M_PI,
          asin(sine) / (0.5 * M_PI), out);
    double height = M_PI / p->height * distance;
    // Pixels at a pole are triangles; their mean width is the width at half a row from the pole.
    double width = 2.0 * M_PI / p->width * fmax(cosine, 0.5 * M_PI / p->height) * distance;
    out->depth = distance;
    out->pixel_area = width * height;
    out->pixel_size = fmin(width, height);
    return distance > 0.0;
}

static bool find_orthographic(const struct projection *p, const double to[3], struct projected *out)
{
    double start[3];
    out->depth = vec3_dot(to, p->forward);
    for (int i = 0; i < 3; i++)
        start[i] = to[i] - (out->depth - p->start) * p->forward[i];
    aim(p, to, start, out);
    double right = vec3_dot(p->right, p->right), up = vec3_dot(p->up, p->up);
    double width = 2.0 * sqrt(right) / p->width, height = 2.0 * sqrt(up) / p->height;
    place(p, vec3_dot(to, p->right) / right, vec3_dot(to, p->up) / up, out);
    out->pixel_area = width * height;
    out->pixel_size = fmin(width, height);
    return out->depth > 0.0;
}

// Projects a point for a perspective camera. is_far: `to` is the direction of an infinitely far
// point.
static bool find_perspective(const struct projection *p, const double to[3], bool is_far,
                             struct projected *out)
{
    double start[3], depth = vec3_dot(to, p->forward);
    double right = vec3_dot(p->right, p->right), up = vec3_dot(p->up, p->up);
    double width = 2.0 * sqrt(right) / p->width, height = 2.0 * sqrt(up) / p->height; // at depth 1
    if (!(depth > 0.0))
        return false;
    for (int i = 0; i < 3; i++)
        start[i] = is_far ? 0.0 : p->start / depth * to[i];
    aim(p, to, start, out);
    place(p, vec3_dot(to, p->right) / (right * depth), vec3_dot(to, p->up) / (up * depth), out);
    out->depth = depth;
    out->pixel_area = width * height * depth * depth * depth / vec3_length(to);
    out->pixel_size = fmin(width, height) * depth;
    if (p->lens_radius > 0.0)
        out->blur = p->lens_radius * fabs((is_far ? 0.0 : 1.0 / depth) - 1.0 / p->focus_distance) /
                    fmin(width, height);
    return true;
}

static bool find(const struct projection *p, const double to[3], bool is_far, struct projected *out)
{
    *out = (struct projected){0};
    if (p->kind == CAMERA_PANORAMIC)
        return find_panoramic(p, to, out);
    return p->kind == CAMERA_ORTHOGRAPHIC ? find_orthographic(p, to, out)
                                          : find_perspective(p, to, is_far, out);
}

bool projection_find(const struct projection *p, const double point[3], struct projected *out)
{
    double to[3];
    vec3_subtract(point, p->position, to);
    return find(p, to, false, out);
}

bool projection_find_far(const struct projection *p, const double direction[3],
                         struct projected *out)
{
    // An orthographic camera sees a single direction, so a point at infinity has no position in its
    // image.
    return p->kind != CAMERA_ORTHOGRAPHIC && find(p, direction, true, out);
}
