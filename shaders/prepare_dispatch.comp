// One thread processes one queue whose bit is set in push.queue: converts the queue's count into
// indirect dispatches of its consumer, in parts of push.part_items, and empties the queue for its
// producers.
//
// A queue of rays has at most as many hits as rays. The same thread therefore sets the dispatches
// of the shading kernels to the number of rays, so that one pass per bounce suffices. If surfaces
// are sorted by class, or rays may miss, a second pass over the queues of hits gives each kernel
// the count of its own queue. These counts remain, because the consumers read them.
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
    uint count = counters.queue[queue].count;
    bool hits_of_class = queue >= QUEUE_SURFACE && queue <= QUEUE_MISS;
    if (!hits_of_class)
        counters.queue[queue].count = 0u;

    bool rays = queue == QUEUE_RAYS || queue == QUEUE_RAYS + 1u;
    // A wave that uses few slots may have smaller dispatches than one that uses all.
    uint parts = min((frame.wave_slots + push.part_items - 1u) / push.part_items,
                     uint(DISPATCH_PARTS));
    for (uint part = 0u; part < parts; part++) {
        uint first = part * push.part_items;
        uint items = min(count - min(count, first), push.part_items);
        uint groups = (items + gl_WorkGroupSize.x - 1u) / gl_WorkGroupSize.x;
        gpu_dispatch dispatch = gpu_dispatch(groups, 1u, 1u, count);
        counters.dispatch[queue * DISPATCH_PARTS + part] = dispatch;
        if (rays) {
            for (uint hits = QUEUE_SURFACE; hits <= QUEUE_MISS; hits++)
                counters.dispatch[hits * DISPATCH_PARTS + part] = dispatch;
        }
    }
    for (uint hits = QUEUE_SURFACE; rays && hits <= QUEUE_MISS; hits++) {
        // Counts the hits of the preceding bounce.
        if (hits < QUEUE_MISS)
            add_64(counters.surface_hits[hits - QUEUE_SURFACE], counters.queue[hits].count);
        counters.queue[hits].count = 0u;
    }

    if (rays)
        add_64(counters.closest_rays, count);
    else if (queue == QUEUE_SHADOW)
        add_64(counters.shadow_rays, count);
    else if (queue == QUEUE_SUSPENDED || queue == QUEUE_SUSPENDED + 1u)
        counters.suspended += count;
}
