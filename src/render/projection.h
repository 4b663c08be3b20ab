// Projects points of the scene into the image. The opposite direction, from image to rays, is the
// work of lib/camera.glsl; projection_ray() does it on the host, for probes.
#ifndef LAMPYRIS_RENDER_PROJECTION_H
#define LAMPYRIS_RENDER_PROJECTION_H

#include "flatten/flatten.h"

// A camera in the flat scene's space and unit, in double precision.
struct projection {
    uint32_t kind, width, height; // CAMERA_*; pixels
    double position[3], forward[3];
    double right[3], up[3]; // vectors from the image's centre to its edges, as in struct gpu_frame
    double start;           // result of far_camera_start()
    double lens_radius, focus_distance;
};

// A projected point.
struct projected {
    double x, y;         // pixels from the upper left corner of the image; may be outside
    double depth;        // distance along the line of sight; for panoramas along the ray
    double origin[3];    // origin of the ray to the point
    double direction[3]; // direction of that ray; a unit vector
    double distance;     // distance from `origin` to the point
    double pixel_area;   // area of a pixel at this distance, perpendicular to the ray
    double pixel_size;   // shorter side of a pixel at this distance
    double blur;         // radius of the circle of confusion, pixels
};

void projection_make(const struct camera *camera, const struct flat_scene *flat, uint32_t width,
                     uint32_t height, struct projection *out);

// Finds the ray through a point of the image, in pixels from its upper left corner, and through the
// centre of the lens. `direction` becomes a unit vector.
void projection_ray(const struct projection *p, double x, double y, double origin[3],
                    double direction[3]);

// Projects a point in the flat scene's space. Returns false if it is behind the camera.
bool projection_find(const struct projection *p, const double point[3], struct projected *out);
// Projects a point at infinity in a direction, which is a unit vector. Lengths in *out are angles,
// and areas are solid angles.
bool projection_find_far(const struct projection *p, const double direction[3],
                         struct projected *out);

#endif
