#include "render/far_camera.h"

#include "base/log.h"
#include "render/tables/emitter_power.h"
#include "scene/core/affine.h"
#include "shared/methods.h"
#include <math.h>

// The ratio of distance to bounding radius above which a direction in single precision has an error
// of more than 2^-24 * 2^12 radii at the scene: a tenth of a pixel if the scene fills an image of
// 800 pixels.
#define FAR_RATIO 4096.0

// A camera and the bounding sphere of everything that has bounds, in the flat scene's unit.
struct sight {
    double position[3];
    double radius;   // 0: nothing has bounds
    double distance; // from the camera to the sphere's centre
    double depth;    // distance along the line of sight; negative: behind the camera
};

static struct sight find_sight(const struct flat_scene *flat, const struct camera *camera)
{
    struct sight sight = {0};
    double to_center[3];
    flat_from_world(flat, camera->position, sight.position);
    if (!(flat->bounds_min[0] <= flat->bounds_max[0]))
        return sight;
    for (int c = 0; c < 3; c++)
        to_center[c] =
            ((double)flat->bounds_min[c] + (double)flat->bounds_max[c]) / 2.0 - sight.position[c];
    sight.radius = bounding_radius(flat);
    sight.distance = sqrt(vec3_dot(to_center, to_center));
    sight.depth = vec3_dot(to_center, camera->direction);
    return sight;
}

static bool is_far(const struct sight *sight, const struct camera *camera)
{
    return camera->kind != CAMERA_PANORAMIC && sight->radius > 0.0 &&
           sight->distance > FAR_RATIO * sight->radius && sight->depth > 2.0 * sight->radius;
}

bool camera_is_far(const struct flat_scene *flat, const struct camera *camera)
{
    const struct sight sight = find_sight(flat, camera);
    return is_far(&sight, camera);
}

// Returns the distance along the line of sight at which a ray through one of the image's corners
// meets a plane, or `farthest` if that is less.
static double depth_of_plane(const struct flat_shape *plane, const struct camera *camera,
                             const double position[3], const double corner[3], double farthest)
{
    bool is_orthographic = camera->kind == CAMERA_ORTHOGRAPHIC;
    double normal[3], from[3], direction[3];
    for (int c = 0; c < 3; c++) {
        normal[c] = (double)plane->normal[c];
        from[c] = position[c] - (double)plane->center[c] + (is_orthographic ? corner[c] : 0.0);
        direction[c] = camera->direction[c] + (is_orthographic ? 0.0 : corner[c]);
    }
    double depth = -vec3_dot(from, normal) / vec3_dot(direction, normal);
    return depth >= 0.0 && depth < farthest ? depth : farthest;
}

// Within the image a plane is never nearer than at the nearest corner. This factor accounts for
// filters and lenses, whose rays reach a little beyond the image.
#define CORNER_MARGIN 1.125

double far_camera_start(const struct flat_scene *flat, const struct camera *camera,
                        const double right[3], const double up[3])
{
    const struct sight sight = find_sight(flat, camera);
    if (!is_far(&sight, camera))
        return 0.0;
    double all = sight.depth - 1.0625 * sight.radius, start = all;
    for (uint32_t i = 0; i < flat->shape_count; i++)
        for (int k = 0; k < 4 && flat->shapes[i].kind == SHAPE_PLANE; k++) {
            double corner[3];
            for (int c = 0; c < 3; c++)
                corner[c] =
                    CORNER_MARGIN * ((k & 1 ? right[c] : -right[c]) + (k & 2 ? up[c] : -up[c]));
            start = depth_of_plane(&flat->shapes[i], camera, sight.position, corner, start);
        }
    // Rays begin before the nearest plane by more than the rounding error of its position.
    return start < all ? start * (1.0 - 0x1p-16) : start;
}

// A scene whose diameter in the image is below this fraction of a pixel is hit by too few samples.
#define LEAST_PART 0x1p-8

struct far_fault far_camera_judge(const struct flat_scene *flat, const struct camera *camera,
                                  uint32_t height)
{
    const struct sight sight = find_sight(flat, camera);
    bool is_panoramic = camera->kind == CAMERA_PANORAMIC;
    if (!(sight.radius > 0.0) || camera->kind == CAMERA_ORTHOGRAPHIC)
        return (struct far_fault){0};
    double seen = is_panoramic ? M_PI : 2.0 * tan(0.5 * camera->fov_y); // height seen at a distance
                                                                        // of 1; for panoramas, the
                                                                        // angle
    double pixel = seen / height, farthest = sight.distance + sight.radius;
    double begin = is_far(&sight, camera) ? sight.depth - sight.radius : 0.0;
    struct far_fault fault = {
        .extent = 2.0 * sight.radius / flat->scale,
        .distance = sight.distance / flat->scale,
        .pixels = 2.0 * sight.radius / (pixel * sight.distance),
        .pixel = pixel,
        .direction = 0x1p-24,
    };
    if (2.0 * sight.radius < LEAST_PART * pixel * sight.distance)
        fault.kind = FAR_FAULT_SCENE;
    else if (0x1p-24 * (farthest - begin) > 0.5 * pixel * farthest)
        fault.kind = FAR_FAULT_PIXEL;
    return fault;
}

void far_camera_warn(const struct flat_scene *flat, const struct camera *camera, uint32_t height)
{
    const struct far_fault fault = far_camera_judge(flat, camera, height);
    if (fault.kind == FAR_FAULT_SCENE)
        log_warn("the scene is %g m across and %g m away, and covers %.2g pixels: samples rarely "
                 "hit it; expected a camera nearer to it, or a narrower field of view",
                 fault.extent, fault.distance, fault.pixels);
    else if (fault.kind == FAR_FAULT_PIXEL)
        log_warn("a pixel is %.2g radians wide, but from within a scene single precision resolves "
                 "directions only to %.2g radians; expected a wider field of view, or a camera "
                 "farther away from the whole scene",
                 fault.pixel, fault.direction);
}
