// One thread tests whether a surface is between a vertex of a light path and the camera. If so, the
// contribution becomes 0. Reads the queue of shadow rays.
#version 460
#extension GL_GOOGLE_include_directive : require

#define ANY_HIT
#include "lib/queue.glsl"
#include "lib/suspend.glsl"

void main()
{
    uint item = item_index();
    bool valid = item < item_count();
    uint slot = valid ? queue_slot(push.queue, item) : 0u;

    trace_ray ray = no_ray();
    if (valid) {
        uvec4 origin = load_shadow_ray(slot, 0u, 0u);
        uvec4 direction = load_shadow_ray(slot, 0u, 1u);
        ray = trace_ray(uintBitsToFloat(origin.xyz), uintBitsToFloat(direction.xyz), origin.w,
                        direction.w, shadow_start_instance(slot, 0u), ray_alpha(slot, true));
    }
    trace_hit hit = trace_hit(1.0, vec2(0.0), NO_PRIMITIVE, 0u, NO_INSTANCE);
    bool done = trace_or_suspend(slot, valid, ray, hit);
    if (done && hit.primitive != NO_PRIMITIVE)
        store_shadow_ray(slot, 0u, 2u, uvec4(0u));
}
