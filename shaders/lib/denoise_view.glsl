// Computes rays of the film's camera through pixels, and positions of points in the history's
// image. The functions agree with lib/camera.glsl for a pinhole. All functions are pure.
#ifndef DENOISE_VIEW_GLSL
#define DENOISE_VIEW_GLSL

#include "lib/angle.glsl"

// Returns the position in the image of `at` (in pixels), from (-1, -1), the upper left corner, to
// (1, 1).
vec2 picture_place(gpu_denoise_view view, vec2 at)
{
    return 2.0 * at / vec2(view.width, view.height) - 1.0;
}

vec3 panorama_ray(gpu_denoise_view view, vec2 place)
{
    vec2 longitude = cos_sin_turns(0.5 * place.x);
    vec2 latitude = cos_sin_turns(-0.25 * place.y);
    vec3 level = longitude.x * view.forward + longitude.y * view.right;
    return latitude.x * level + latitude.y * view.up;
}

struct view_ray {
    vec3 origin;
    vec3 direction; // unit
    float cosine;   // cosine of the angle to the line of sight
};

view_ray ray_through(gpu_denoise_view view, vec2 at)
{
    vec2 place = picture_place(view, at);
    vec3 across = place.x * view.right - place.y * view.up;
    if (view.kind == CAMERA_PANORAMIC)
        return view_ray(view.position, normalize(panorama_ray(view, place)), 1.0);
    if (view.kind == CAMERA_ORTHOGRAPHIC)
        return view_ray(view.position + across, view.forward, 1.0);
    float length_squared = 1.0 + dot(across, across);
    return view_ray(view.position, (view.forward + across) * inversesqrt(length_squared),
                    inversesqrt(length_squared));
}

// Returns a function of the distance t along a ray of ray_through() that is linear over the image
// of a plane. It is the inverse of the depth along the line of sight or, without perspective, the
// depth itself.
float guide_depth(gpu_denoise_view view, float t, float cosine)
{
    return view.kind == CAMERA_ORTHOGRAPHIC ? t : 1.0 / (t * cosine);
}

float ray_depth(gpu_denoise_view view, float guide, float cosine)
{
    return view.kind == CAMERA_ORTHOGRAPHIC ? guide : 1.0 / (guide * cosine);
}

// Returns the relative change, within one pixel, of the length of rays to a plane that faces the
// camera. For a plane at distance 1 and a point (x, y) in it the length is (1 + x^2 + y^2)^(1/2),
// whose relative derivative is (x dx + y dy) / (1 + x^2 + y^2).
float ray_length_change(gpu_denoise_view view, vec2 at)
{
    if (view.kind != CAMERA_PERSPECTIVE)
        return 0.0;
    vec2 half_size = vec2(length(view.right), length(view.up));
    vec2 here = abs(picture_place(view, at)) * half_size;
    return dot(here, 2.0 * half_size / vec2(view.width, view.height)) / (1.0 + dot(here, here));
}

// Projects a point into the image, or a direction from the camera as an infinitely distant point.
// `at` is the position in pixels, and `guide` the depth as the guides store it. Returns false if
// the point is behind the camera or has no projection.
bool project(gpu_denoise_view view, vec3 point, bool is_direction, out vec2 at, out float guide)
{
    vec3 to = is_direction ? point : point - view.position;
    vec2 across = vec2(dot(to, view.to_right), -dot(to, view.to_up));
    float ahead = dot(to, view.forward);
    vec2 place;
    if (view.kind == CAMERA_PANORAMIC) {
        float far = length(to);
        float level = length(vec2(across.x, ahead));
        place = vec2(2.0 * atan_turns(across.x, ahead), 4.0 * atan_turns(across.y, level));
        guide = 1.0 / far;
    } else if (view.kind == CAMERA_ORTHOGRAPHIC) {
        place = across;
        guide = ahead;
    } else {
        place = across / ahead;
        guide = 1.0 / ahead;
    }
    at = (place + 1.0) * 0.5 * vec2(view.width, view.height);
    if (is_direction)
        guide = 0.0;
    bool parallel = view.kind == CAMERA_ORTHOGRAPHIC;
    return view.kind == CAMERA_PANORAMIC || (parallel ? !is_direction : ahead > 0.0);
}

#endif
