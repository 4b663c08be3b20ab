// Connects a point to the camera: finds the camera ray that reaches the point, and a pixel whose
// filter covers the point's position in the image. Reads the uniform block.
#ifndef CONNECT_CAMERA_GLSL
#define CONNECT_CAMERA_GLSL

#include "lib/angle.glsl"
#include "lib/bidir.glsl"
#include "lib/camera.glsl"

struct camera_sight {
    vec3 target;    // origin of the camera ray to the point
    vec3 direction; // unit direction of that ray
    float distance; // from the camera
    vec2 at;        // position in the image, as in make_camera_ray()
    bool valid;     // the point is in front of the camera
};

// Inverts make_camera_ray() for cameras with a lens or a pinhole. `from`: the point relative to
// frame.camera_position.
camera_sight see_in_perspective(vec3 from, vec2 u_lens)
{
    camera_sight c;
    float start = HAS(FEATURE_FAR_CAMERA) ? frame.camera_start : 0.0;
    float beyond = dot(from, frame.camera_forward);
    float along = beyond + start;
    vec3 offset = vec3(0.0);
    if (HAS(FEATURE_LENS)) {
        vec2 on_lens =
            frame.lens_radius * sample_aperture(u_lens, frame.lens_blades, frame.lens_rotation);
        offset = on_lens.x * normalize(frame.camera_right) + on_lens.y * normalize(frame.camera_up);
    }
    vec3 across = from - beyond * frame.camera_forward - offset;
    vec3 direction = frame.camera_forward + across / along;
    vec3 through_pinhole = direction;
    if (HAS(FEATURE_LENS))
        through_pinhole += offset / frame.focus_distance;
    c.at = vec2(dot(through_pinhole, frame.camera_right) /
                    dot(frame.camera_right, frame.camera_right),
                -dot(through_pinhole, frame.camera_up) / dot(frame.camera_up, frame.camera_up));
    vec3 at_start = HAS(FEATURE_FAR_CAMERA) ? frame.lens_at_start * offset : offset;
    c.target = start_of_ray(c.at) + at_start;
    c.distance = along * length(direction);
    c.direction = normalize(direction);
    c.valid = beyond > 0.0;
    return c;
}

// Inverts make_camera_ray() for orthographic cameras.
camera_sight see_in_parallel(vec3 from)
{
    camera_sight c;
    float along = dot(from, frame.camera_forward);
    c.at = vec2(dot(from, frame.camera_right) / dot(frame.camera_right, frame.camera_right),
                -dot(from, frame.camera_up) / dot(frame.camera_up, frame.camera_up));
    c.target = frame.camera_position + from - along * frame.camera_forward;
    c.direction = frame.camera_forward;
    c.distance = along + (HAS(FEATURE_FAR_CAMERA) ? frame.camera_start : 0.0);
    c.valid = along > 0.0;
    return c;
}

// Inverts panorama_direction().
camera_sight see_all_around(vec3 from)
{
    camera_sight c;
    c.distance = length(from);
    c.direction = from / c.distance;
    vec2 level = vec2(dot(from, frame.camera_forward), dot(from, frame.camera_right));
    c.at = vec2(2.0 * atan_turns(level.y, level.x),
                -4.0 * atan_turns(dot(from, frame.camera_up), length(level)));
    c.target = frame.camera_position;
    c.valid = c.distance > 0.0;
    return c;
}

// Returns how the camera sees a point. u_lens: selects the point on the lens.
camera_sight see_from_camera(vec3 point, vec2 u_lens)
{
    vec3 from = point - frame.camera_position;
    if (CAMERA == CAMERA_PANORAMIC)
        return see_all_around(from);
    if (CAMERA == CAMERA_ORTHOGRAPHIC)
        return see_in_parallel(from);
    return see_in_perspective(from, u_lens);
}

// Returns the density of the pixel filter at an offset from the pixel's centre, per area of one
// pixel; filter_position() samples this density.
float filter_density(vec2 offset)
{
    float scale = 1.0 / (frame.filter_radius * frame.filter_radius);
    vec2 x = abs(offset) / frame.filter_radius;
    if (any(greaterThanEqual(x, vec2(1.0))))
        return 0.0;
    if (FILTER == FILTER_TENT)
        return scale * (1.0 - x.x) * (1.0 - x.y);
    if (FILTER == FILTER_GAUSSIAN) {
        float square = dot(x, x);
        return square < 1.0 ? scale * 4.5 * INV_PI / 0.98889100346175773 * exp(-4.5 * square) : 0.0;
    }
    if (FILTER == FILTER_BLACKMAN_HARRIS) {
        const vec4 a = vec4(0.35875, 0.48829, 0.14128, 0.01168) / 0.35875;
        vec2 c = vec2(cos_sin_turns(0.5 * x.x).x, cos_sin_turns(0.5 * x.y).x);
        vec2 w = 1.0 + a.y * c + a.z * (2.0 * c * c - 1.0) + a.w * c * (4.0 * c * c - 3.0);
        return scale * 0.25 * w.x * w.y;
    }
    return scale * 0.25;
}

// Selects one of the pixels whose filters cover a point of the image, in proportion to the filters'
// densities there. Returns the sum of these densities, by which the contribution to the pixel is
// scaled; 0: there is no such pixel.
float choose_pixel(vec2 at, float u, out uint pixel)
{
    vec2 size = vec2(frame.picture_width, frame.picture_height);
    vec2 place = 0.5 * (at + 1.0) * size - 0.5; // pixels' centres are integers
    float radius = frame.filter_radius;
    vec2 low = max(ceil(place - radius), vec2(0.0));
    vec2 high = min(floor(place + radius), size - 1.0);
    // The condition is false if a bound is NaN.
    bool covers = all(lessThanEqual(low, high));
    float columns = high.x - low.x + 1.0;
    float count = covers ? columns * (high.y - low.y + 1.0) : 0.0;
    float sum = 0.0;
    for (float i = 0.0; i < count; i++) {
        float row = floor((i + 0.5) / columns);
        sum += filter_density(place - low - vec2(i - row * columns, row));
    }
    float left = u * sum;
    bool found = false;
    pixel = 0u;
    for (float i = 0.0; i < count; i++) {
        float row = floor((i + 0.5) / columns);
        vec2 chosen = low + vec2(i - row * columns, row);
        float density = filter_density(place - chosen);
        // Because of rounding, `left` may never fall below a density. Then the last pixel with a
        // positive density is selected.
        if (density > 0.0 && !found)
            pixel = uint(chosen.y) * frame.picture_width + uint(chosen.x);
        found = found || left < density;
        left -= density;
    }
    return sum;
}

#endif
