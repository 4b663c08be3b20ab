// Reads queues and appends to them. A queue is a compact array of slot indices with a count
// (counters.queue).
#ifndef QUEUE_GLSL
#define QUEUE_GLSL

#include "lib/buffers.glsl"

#ifdef BALLOT
#extension GL_KHR_shader_subgroup_ballot : require
#else
shared uint queue_reserved;
shared uint queue_base;
#endif

// Returns the item of the consumed queue that this thread processes; at least item_count() for
// threads beyond the end. Items are interleaved, so that neighbouring workgroups are spread over
// the queue: drivers that give each CPU thread a contiguous range of workgroups then balance their
// threads.
uint item_index()
{
    uint group = gl_WorkGroupID.x;
    if (INTERLEAVE > 1u) {
        uint rows = gl_NumWorkGroups.x / INTERLEAVE;
        if (group < rows * INTERLEAVE)
            group = group % INTERLEAVE * rows + group / INTERLEAVE;
    }
    return push.first_item + group * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
}

// Returns the number of items of the consumed queue in this part of the dispatch. The counts of the
// queues of hits are final when they are consumed; prepare_dispatch has saved the counts of the
// other queues.
uint item_count()
{
    bool hits = push.queue >= QUEUE_SURFACE && push.queue <= QUEUE_MISS;
    uint items = hits ? counters.queue[push.queue].count
                      : counters.dispatch[push.queue * DISPATCH_PARTS].items;
    return min(items, push.first_item + push.part_items);
}

// Queues that the scene does not need have no memory, so queues with higher numbers move down.
uint queue_index(uint queue, uint item)
{
    uint row = uint(bitCount(QUEUES & ((1u << queue) - 1u)));
    return row * frame.wave_slots + item;
}

uint queue_slot(uint queue, uint item)
{
    return queue_slots[queue_index(queue, item)];
}

// Appends `slot` if `wanted`. All threads of the workgroup must call it in uniform control flow, so
// that the result for the elected thread of a subgroup can be broadcast. By SPIR-V's rules (2.11,
// "Uniform Control Flow") a workgroup is in uniform control flow at the merge block of an `if` or a
// loop, unless some thread has left it by a return. Hence functions from main() down to this one
// have no early returns, which tests/kernels/portable.py checks. The order of a queue is not
// deterministic; nothing may depend on it.
void queue_push(uint queue, uint slot, bool wanted)
{
#ifdef BALLOT
    uvec4 votes = subgroupBallot(wanted);
    uint base = 0u;
    if (subgroupElect())
        base = atomicAdd(counters.queue[queue].count, subgroupBallotBitCount(votes));
    uint item = subgroupBroadcastFirst(base) + subgroupBallotExclusiveBitCount(votes);
#else
    barrier();
    if (gl_LocalInvocationIndex == 0u)
        queue_reserved = 0u;
    barrier();
    uint offset = wanted ? atomicAdd(queue_reserved, 1u) : 0u;
    barrier();
    if (gl_LocalInvocationIndex == 0u)
        queue_base = atomicAdd(counters.queue[queue].count, queue_reserved);
    barrier();
    uint item = queue_base + offset;
#endif
    if (wanted)
        queue_slots[queue_index(queue, item)] = slot;
}

#endif
