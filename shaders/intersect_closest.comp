// One thread finds the nearest hit of one ray. Reads a queue of rays, writes the path's hit and
// pushes its slot to the queue of surface hits or of misses.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "lib/queue.glsl"
#include "lib/suspend.glsl"

void main()
{
    uint item = item_index();
    bool valid = item < item_count();
    uint slot = valid ? queue_slot(push.queue, item) : 0u;

    uvec4 origin = load_path(slot, PATH_ORIGIN);
    vec3 direction = uintBitsToFloat(load_path(slot, PATH_DIRECTION).xyz);
    const float infinity = uintBitsToFloat(0x7f800000u);
    trace_ray ray = trace_ray(uintBitsToFloat(origin.xyz), direction, origin.w, NO_PRIMITIVE);
    trace_hit hit = trace_hit(infinity, vec2(0.0), NO_PRIMITIVE, NO_PRIMITIVE);
    bool done = trace_or_suspend(slot, valid, ray, hit);

    bool found = done && hit.primitive != NO_PRIMITIVE;
    if (found)
        store_path(slot, PATH_HIT, uvec4(floatBitsToUint(vec3(hit.t, hit.uv)), hit.primitive));
    queue_push(QUEUE_SURFACE, slot, found);
    if (HAS(FEATURE_ENVIRONMENT))
        queue_push(QUEUE_MISS, slot, done && !found);
}
