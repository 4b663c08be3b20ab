// Generates the ray of a sample for the scene's camera. Reads the uniform block.
#ifndef CAMERA_GLSL
#define CAMERA_GLSL

#include "lib/angle.glsl"
#include "lib/buffers.glsl"
#include "lib/lens.glsl"

struct camera_ray {
    vec3 origin;
    vec3 direction; // unit
};

// Returns the direction that a panorama shows at a point of the image, whose upper left corner is
// (-1, 1). The convention is that of scene/core/environment.h in the camera's frame, with forward
// in place of +X and up in place of +Y.
vec3 panorama_direction(vec2 at)
{
    vec2 longitude = cos_sin_turns(0.5 * at.x);
    vec2 latitude = cos_sin_turns(-0.25 * at.y);
    vec3 level = longitude.x * frame.camera_forward + longitude.y * frame.camera_right;
    return latitude.x * level + latitude.y * frame.camera_up;
}

// Returns the origin of the pinhole's ray: the camera's position, or for a far camera a point near
// the scene, which is more precise.
vec3 start_of_ray(vec2 at)
{
    if (!HAS(FEATURE_FAR_CAMERA))
        return frame.camera_position;
    return frame.camera_position +
           frame.camera_start * (at.x * frame.camera_right - at.y * frame.camera_up);
}

// With FEATURE_FAR_CAMERA, returns the distance from the camera of the point at distance t along
// its ray.
float distance_from_camera(vec3 direction, float t)
{
    return t + frame.camera_start / dot(direction, frame.camera_forward);
}

// Returns the ray from a point of the aperture to the point at which the pinhole's ray meets the
// plane in focus (Cook, Porter, Carpenter 1984, "Distributed Ray Tracing", section 4.2). `from` is
// the origin of the pinhole's ray; `direction` has a component of 1 along the line of sight.
camera_ray ray_through_lens(vec3 from, vec3 direction, vec2 u)
{
    vec2 on_lens = frame.lens_radius * sample_aperture(u, frame.lens_blades, frame.lens_rotation);
    vec3 offset =
        on_lens.x * normalize(frame.camera_right) + on_lens.y * normalize(frame.camera_up);
    vec3 at_start = HAS(FEATURE_FAR_CAMERA) ? frame.lens_at_start * offset : offset;
    return camera_ray(from + at_start,
                      normalize(direction - offset / frame.focus_distance));
}

// Returns the camera ray through `at`, a position in the image from (-1, -1), the upper left
// corner, to (1, 1). u_lens: is used only with a lens.
camera_ray make_camera_ray(vec2 at, vec2 u_lens)
{
    if (CAMERA == CAMERA_PANORAMIC)
        return camera_ray(frame.camera_position, normalize(panorama_direction(at)));
    if (CAMERA == CAMERA_ORTHOGRAPHIC)
        return camera_ray(frame.camera_position + at.x * frame.camera_right -
                              at.y * frame.camera_up,
                          frame.camera_forward);
    vec3 direction = frame.camera_forward + at.x * frame.camera_right - at.y * frame.camera_up;
    if (HAS(FEATURE_LENS))
        return ray_through_lens(start_of_ray(at), direction, u_lens);
    return camera_ray(start_of_ray(at), normalize(direction));
}

#endif
