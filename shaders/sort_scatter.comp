// One thread stores one ray at its place in the sorted queue. The order of rays with equal keys
// depends on scheduling.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "lib/sort.glsl"

void main()
{
    uint item = item_index();
    if (item >= item_count())
        return;
    uint slot = queue_slot(push.queue, item);
    uint place = atomicAdd(sort.place[load_key(slot)], 1u);
    queue_slots[queue_index(sorted_queue(push.queue), place)] = slot;
}
