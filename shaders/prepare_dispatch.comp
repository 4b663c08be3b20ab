// One thread a queue whose bit is set in push.queue: turns its count into indirect dispatches of
// its consumer, in parts of push.part_items, and empties it for its producers.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "lib/buffers.glsl"

void add_64(inout uint words[2], uint value)
{
    uint carry;
    words[0] = uaddCarry(words[0], value, carry);
    words[1] += carry;
}

void main()
{
    uint queue = gl_GlobalInvocationID.x;
    if (queue >= QUEUE_COUNT || (push.queue >> queue & 1u) == 0u)
        return;
    uint count = counters.queue[queue];
    counters.queue[queue] = 0u;

    uint parts = (push.wave_slots + push.part_items - 1u) / push.part_items;
    for (uint part = 0u; part < parts; part++) {
        uint first = part * push.part_items;
        uint items = min(count - min(count, first), push.part_items);
        uint groups = (items + gl_WorkGroupSize.x - 1u) / gl_WorkGroupSize.x;
        counters.dispatch[queue * DISPATCH_PARTS + part] = gpu_dispatch(groups, 1u, 1u, count);
    }

    if (queue == QUEUE_RAYS || queue == QUEUE_RAYS + 1u)
        add_64(counters.closest_rays, count);
    else if (queue == QUEUE_SHADOW)
        add_64(counters.shadow_rays, count);
    else if (queue == QUEUE_SUSPENDED || queue == QUEUE_SUSPENDED + 1u)
        counters.suspended += count;
}
