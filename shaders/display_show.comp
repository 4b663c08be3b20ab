// One thread computes one pixel of the displayed image from one or two linear images of its size,
// or one pixel of a linear image that is kept.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "lib/display.glsl"
#include "lib/tone.glsl"

PICTURE(left, DISPLAY_BINDING_LEFT)
PICTURE(right, DISPLAY_BINDING_RIGHT)
PICTURE(kept_left, DISPLAY_BINDING_KEPT_LEFT)
PICTURE(kept_right, DISPLAY_BINDING_KEPT_RIGHT)
PICTURE(palette, DISPLAY_BINDING_PALETTE)
layout(std430, set = 0, binding = DISPLAY_BINDING_PIXELS) writeonly buffer pixels_block {
    uint pixels[];
};
layout(std430, set = 0, binding = DISPLAY_BINDING_TO) writeonly buffer to_block {
    vec4 to_pixels[];
};

const float PALETTE_LAST = 256.0;

// Returns a pixel of a linear image: the value times its weight, and the weight.
vec4 picture_value(uint pixel, bool second)
{
    vec4 value = load_left(pixel);
    if (HAS_FLAG(DISPLAY_TWO))
        value = second ? load_right(pixel) : value;
    if (HAS_FLAG(DISPLAY_KEPT)) {
        vec4 kept = load_kept_left(pixel);
        if (HAS_FLAG(DISPLAY_TWO))
            kept = second ? load_kept_right(pixel) : kept;
        value += (1.0 - value.w) * kept;
    }
    return value;
}

vec3 false_color(float value, float share)
{
    if (!(share > 0.0))
        return vec3(0.0);
    float mean = value / share;
    if (SHOWS(SHOWN_LOGARITHMIC))
        mean = log2(max(mean, 1.17549435e-38)); // the least float that is not denormal
    float level = (mean - push.range_low) * push.range_scale;
    level = level > 0.0 ? min(level, 1.0) : 0.0; // NaN becomes 0
    return share * srgb_from_linear(load_palette(uint(level * PALETTE_LAST + 0.5)).rgb);
}

// Returns the displayed colour of a pixel of a linear image.
vec3 color_of(vec4 value)
{
    if (!(value.w > 0.0))
        return vec3(0.0);
    vec3 mean = value.rgb / value.w;
    if (SHOWS(SHOWN_FALSE))
        return false_color(mean.x, min(mean.y, 1.0));
    if (SHOWS(SHOWN_TONED))
        return srgb_from_linear(min(tone_map(TONE, clean(push.gain * mean)), vec3(1.0)));
    mean = min(clean(mean), vec3(1.0));
    return SHOWN == SHOWN_ALBEDO ? srgb_from_linear(mean) : mean;
}

// Draws the line between both sides: a white and a black column, which are visible on any image.
vec3 with_line(vec3 color, uint x)
{
    if (x + 1u == push.split)
        return vec3(0.0);
    return x == push.split ? vec3(1.0) : color;
}

void main()
{
    uint item = item_index();
    if (item >= push.items)
        return;
    if (HAS_FLAG(DISPLAY_KEEP)) {
        to_pixels[item] = picture_value(item, false);
        return;
    }
    uvec2 place = place_of(item, push.width);
    uint x = place.x - push.left;
    uint y = place.y - push.top;
    vec3 color = vec3(0.0);
    if (x < push.picture_width && y < push.picture_height) {
        color = color_of(picture_value(y * push.picture_width + x, x >= push.split));
        if (HAS_FLAG(DISPLAY_TWO))
            color = with_line(color, x);
    }
    uvec3 codes = uvec3(color * 255.0 + 0.5);
    pixels[item] = codes.r | codes.g << 8u | codes.b << 16u | 0xff000000u;
}
