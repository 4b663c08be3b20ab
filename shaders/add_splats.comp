// One thread adds the contribution of a light path to a pixel in the bound range of the film. Reads
// the queue of shadow rays. The kernel is dispatched twice: with push.light_ray = 0 it claims the
// digits, with 1 it adds the values.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "lib/queue.glsl"

layout(std430, set = 0, binding = BINDING_FILM) buffer film_block {
    uvec4 film_words[];
};

#include "lib/splat.glsl"

void main()
{
    uint item = item_index();
    if (item >= item_count())
        return;
    uint slot = queue_slot(push.queue, item);
    uvec4 words = load_shadow_ray(slot, 0u, 2u);
    uint number = load_path(slot, PATH_WEIGHTS).w;
    uint pixel = words.w - push.film_first_pixel; // for pixels of earlier ranges, wraps around to a
                                                  // huge number
    uint pixels = uint(film_words.length()) / AOV_FILM_WORDS(AOVS);
    if (words.rgb == uvec3(0u) || pixel >= pixels)
        return;
    uint at = pixel * AOV_FILM_WORDS(AOVS);
    if (push.light_ray == 0u)
        splat_claim(at, number, uintBitsToFloat(words.rgb));
    else
        splat(at, number, uintBitsToFloat(words.rgb));
}
