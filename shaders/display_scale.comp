// One thread computes one pixel of a linear image of another size: the mean over an area if the
// image becomes smaller, an interpolation between pixels if it becomes larger. A table has the
// weights along each axis.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "lib/display.glsl"

PICTURE(from, DISPLAY_BINDING_FROM)
WORDS(taps, DISPLAY_BINDING_TAPS)
layout(std430, set = 0, binding = DISPLAY_BINDING_TO) buffer to_block {
    vec4 to_pixels[];
};

// struct gpu_display_taps
struct taps {
    uint first;
    uint count;
    uint step;
    float head;
    float body; // weight of each tap between head and tail
    float tail;
};

taps taps_at(uint index)
{
    uvec4 words = taps_word(index);
    vec2 ends = uintBitsToFloat(words.zw);
    uint count = words.y & 255u;
    float body = (1.0 - ends.x - ends.y) / float(max(count, 3u) - 2u);
    return taps(words.x, count, words.y >> 8u, ends.x, body, ends.y);
}

float weight(taps t, uint i)
{
    return i == 0u ? t.head : i + 1u == t.count ? t.tail : t.body;
}

vec4 load_if_there(uint row, uint column)
{
    uint there = row * push.from_width + column - push.from_first;
    bool is_there = there < push.from_count;
    return is_there ? load_from(there) : vec4(0.0);
}

vec4 mean_of_area(taps x, taps y)
{
    vec4 sum = vec4(0.0);
    for (uint j = 0u; j < y.count; j++)
        for (uint i = 0u; i < x.count; i++)
            sum += weight(x, i) * weight(y, j) *
                   load_if_there(y.first + j * y.step, x.first + i * x.step);
    return sum;
}

// Interpolates between two taps along each axis; if there is only one tap, the other has weight 0.
vec4 interpolate(taps x, taps y)
{
    uint right = x.first + x.count - 1u;
    uint below = y.first + y.count - 1u;
    vec4 upper = x.head * load_if_there(y.first, x.first) + x.tail * load_if_there(y.first, right);
    vec4 lower = x.head * load_if_there(below, x.first) + x.tail * load_if_there(below, right);
    return y.head * upper + y.tail * lower;
}

void main()
{
    uint item = item_index();
    if (item >= push.items)
        return;
    item += push.first_row * push.to_width;
    uvec2 place = place_of(item, push.to_width);
    taps x = taps_at(place.x);
    taps y = taps_at(push.to_width + place.y);
    vec4 value;
    if (HAS_FLAG(DISPLAY_NEAREST))
        value = load_if_there(y.first, x.first);
    else if (HAS_FLAG(DISPLAY_LARGER))
        value = interpolate(x, y);
    else
        value = mean_of_area(x, y);
    to_pixels[item] = push.is_added != 0u ? to_pixels[item] + value : value;
}
