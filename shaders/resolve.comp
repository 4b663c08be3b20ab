// One thread turns one pixel of the film into the means of its two half-buffers.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "lib/queue.glsl"

layout(std430, set = 0, binding = BINDING_FILM) readonly buffer film_block {
    gpu_film_pixel film[];
};
layout(std430, set = 0, binding = BINDING_RESOLVED) writeonly buffer resolved_block {
    gpu_resolved_pixel resolved[];
};

float mean(float sum, float lost, uint samples)
{
    return samples > 0u ? (sum - lost) / float(samples) : 0.0;
}

void main()
{
    uint item = item_index();
    if (item >= min(push.pixel_count, push.first_item + push.part_items))
        return;
    gpu_film_pixel pixel = film[push.first_pixel - push.film_first_pixel + item];
    // Sample 0 belongs to half A.
    uint samples_b = pixel.samples / 2u;
    uint samples_a = pixel.samples - samples_b;
    for (uint c = 0u; c < 3u; c++) {
        resolved[item].mean_a[c] = mean(pixel.sum_a[c], pixel.lost_a[c], samples_a);
        resolved[item].mean_b[c] = mean(pixel.sum_b[c], pixel.lost_b[c], samples_b);
    }
    resolved[item].samples = pixel.samples;
    resolved[item].dropped = pixel.dropped;
}
