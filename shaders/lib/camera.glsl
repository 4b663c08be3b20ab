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

// The direction that a panorama shows at a point of the picture, (-1, 1) its upper left corner: the
// convention of scene/core/environment.h with the camera's axes, forward for +X, up for +Y.
vec3 panorama_direction(vec2 at)
{
    vec2 longitude = cos_sin_turns(0.5 * at.x);
    vec2 latitude = cos_sin_turns(-0.25 * at.y);
    vec3 level = longitude.x * frame.camera_forward + longitude.y * frame.camera_right;
    return latitude.x * level + latitude.y * frame.camera_up;
}

// Returns the origin of the pinhole's ray: the camera, or a nearer point that is precise.
vec3 start_of_ray(vec2 at)
{
    if (!HAS(FEATURE_FAR_CAMERA))
        return frame.camera_position;
    return frame.camera_position +
           frame.camera_start * (at.x * frame.camera_right - at.y * frame.camera_up);
}

// With FEATURE_FAR_CAMERA, returns the distance from the camera of the point at distance t on its
// ray.
float distance_from_camera(vec3 direction, float t)
{
    return t + frame.camera_start / dot(direction, frame.camera_forward);
}

// The ray from a point of the aperture to where the pinhole's ray of this point of the image meets
// the plane in focus (Cook, Porter, Carpenter 1984, "Distributed Ray Tracing", section 4.2). `from`
// is the origin of the pinhole's ray; `direction` has a component of 1 along the line of sight.
camera_ray ray_through_lens(vec3 from, vec3 direction, vec2 u)
{
    vec2 on_lens = frame.lens_radius * sample_aperture(u, frame.lens_blades, frame.lens_rotation);
    vec3 offset =
        on_lens.x * normalize(frame.camera_right) + on_lens.y * normalize(frame.camera_up);
    vec3 at_start = HAS(FEATURE_FAR_CAMERA) ? frame.lens_at_start * offset : offset;
    return camera_ray(from + at_start,
                      normalize(direction - offset / frame.focus_distance));
}

// `at`: from (-1, -1), the picture's upper left corner, to (1, 1). `u_lens`: used with a lens only.
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
