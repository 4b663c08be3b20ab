// One thread starts the light path that belongs to one sample of a pixel, at a point of an emitter
// and in a random direction. Fills the queue of rays with the first slot of each sample whose light
// path has begun.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "lib/emit.glsl"
#include "lib/film_sums.glsl"
#include "lib/queue.glsl"
#include "lib/sampler.glsl"

layout(std430, set = 0, binding = BINDING_FILM) readonly buffer film_block {
    uvec4 film_words[];
};

// Returns the half-buffer to which the contributions of a slot's light path are added. It depends
// on the number of samples of the slot's pixel, which is the same for all pixels.
uint half_of_slot(uint slot)
{
    uint item = sample_of_slot(slot);
    uint at = (slot_pixel(slot) - push.film_first_pixel) * AOV_FILM_WORDS(AOVS);
    return half_of_sample(film_words[at].x + (item & ((1u << push.sample_shift) - 1u)));
}

void main()
{
    uint item = item_index();
    uint count = push.pixel_count << push.sample_shift;
    bool valid = item < min(count, push.first_item + push.part_items);
    uint slot = valid ? first_slot(item) : 0u;
    if (valid) {
        light_start l = start_light_path(uniforms(slot, DIMENSION_LIGHT_PATH),
                                         uniforms(slot, DIMENSION_LIGHT_PATH + 1u));
        // The throughput is divided by its largest component, because Russian roulette expects a
        // throughput that begins at 1.
        float scale = max(l.power.r, max(l.power.g, l.power.b));
        valid = l.valid && scale > 0.0 && is_finite(l.power);
        store_path(slot, PATH_ORIGIN, uvec4(floatBitsToUint(l.origin), l.primitive));
        store_path(slot, PATH_DIRECTION, uvec4(floatBitsToUint(l.direction), 0u));
        store_path(slot, PATH_THROUGHPUT, uvec4(floatBitsToUint(l.power / scale), 0u));
        store_path_start_instance(slot, NO_INSTANCE);
        uvec3 words = floatBitsToUint(vec3(l.first, l.second, scale));
        store_path(slot, PATH_WEIGHTS, uvec4(words, half_of_slot(slot)));
    }
    queue_push(QUEUE_RAYS, slot, valid);
}
