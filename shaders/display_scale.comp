// One thread makes one pixel of a linear picture of another size: a mean over the area where that
// is smaller, interpolated between pixels where it is larger.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "lib/display.glsl"

PICTURE(from, DISPLAY_BINDING_FROM)
layout(std430, set = 0, binding = DISPLAY_BINDING_TO) buffer to_block {
    vec4 to_pixels[];
};

// Along one side: the pixels that one is made of, and how much of each.
struct taps {
    uint first;
    uint count;
    uint step;  // from one to the next
    float head; // weights of the first one, of those in between, and of the last one
    float body;
    float tail;
};

// Pixel `at` of `to` covers [at, at + 1] * from / to: in whole numbers, which are exact.
taps taps_of_area(uint at, uint from, uint to)
{
    uint quotient = from / to;
    uint remainder = from % to;
    uint first = at * quotient + at * remainder / to;
    float skipped = float(at * remainder % to) / float(to);
    uint end = at + 1u;
    uint last = end * quotient + end * remainder / to;
    float taken = float(end * remainder % to) / float(to);
    if (taken == 0.0) {
        last -= 1u;
        taken = 1.0;
    }
    uint step = (last - first) / DISPLAY_TAPS_MAX + 1u;
    return taps(first, (last - first) / step + 1u, step, 1.0 - skipped, 1.0, taken);
}

taps taps_between(uint at, uint from, uint to)
{
    // Its centre, in pixels of `from` from the centre of the first one, times 2 to.
    int twice = int((2u * at + 1u) * from) - int(to);
    if (HAS_FLAG(DISPLAY_NEAREST))
        return taps(uint(twice + int(to)) / (2u * to), 1u, 1u, 1.0, 1.0, 1.0);
    if (twice <= 0)
        return taps(0u, 1u, 1u, 1.0, 1.0, 1.0);
    uint first = uint(twice) / (2u * to);
    if (first + 1u >= from)
        return taps(from - 1u, 1u, 1u, 1.0, 1.0, 1.0);
    float share = float(uint(twice) % (2u * to)) / float(2u * to);
    return taps(first, 2u, 1u, 1.0 - share, 1.0, share);
}

taps taps_along(uint at, uint from, uint to)
{
    return from > to ? taps_of_area(at, from, to) : taps_between(at, from, to);
}

float weight(taps t, uint i)
{
    return i == 0u ? t.head : i + 1u == t.count ? t.tail : t.body;
}

void main()
{
    uint item = item_index();
    if (item >= push.items)
        return;
    item += push.first_row * push.to_width;
    taps x = taps_along(item % push.to_width, push.from_width, push.to_width);
    taps y = taps_along(item / push.to_width, push.from_height, push.to_height);
    vec4 sum = vec4(0.0);
    float weights = 0.0;
    for (uint j = 0u; j < y.count; j++)
        for (uint i = 0u; i < x.count; i++) {
            uint pixel = (y.first + j * y.step) * push.from_width + x.first + i * x.step;
            uint there = pixel - push.from_first;
            float w = weight(x, i) * weight(y, j);
            weights += w;
            if (there < push.from_count)
                sum += w * load_from(there);
        }
    sum /= weights;
    to_pixels[item] = push.is_added != 0u ? to_pixels[item] + sum : sum;
}
