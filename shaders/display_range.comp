// One thread reads some values of an image in false colours, finds the smallest and the greatest of
// them, and counts all of them in a histogram.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "lib/display.glsl"

PICTURE(from, DISPLAY_BINDING_FROM)
layout(std430, set = 0, binding = DISPLAY_BINDING_RANGE) buffer range_block {
    gpu_display_range range;
};

void main()
{
    uint threads = (push.items + DISPLAY_RANGE_ITEMS - 1u) / DISPLAY_RANGE_ITEMS;
    uint thread = item_index();
    if (thread >= threads)
        return;
    uint least = 0xffffffffu;
    uint greatest = 0u;
    uint count = 0u;
    for (uint i = 0u; i < DISPLAY_RANGE_ITEMS; i++) {
        uint item = i * threads + thread;
        if (item >= push.items)
            break;
        vec4 value = load_from(item);
        if (!(value.y > 0.0))
            continue;
        uint bits = floatBitsToUint(value.x / value.y) & 0x7fffffffu;
        if (SHOWS(SHOWN_LOGARITHMIC) && bits < 0x00800000u)
            continue; // 0 has no logarithm; denormals count as 0
        least = min(least, bits);
        greatest = max(greatest, bits);
        count++;
        atomicAdd(range.bin[bits >> DISPLAY_BIN_SHIFT], 1u);
    }
    if (count > 0u) {
        atomicMin(range.least, least);
        atomicMax(range.greatest, greatest);
        atomicAdd(range.count, count);
    }
}
