// One thread computes the key of one ray, stores it, and counts the rays with this key.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "lib/sort.glsl"

void main()
{
    uint item = item_index();
    if (item >= item_count())
        return;
    uint slot = queue_slot(push.queue, item);
    vec3 origin = uintBitsToFloat(load_path(slot, PATH_ORIGIN).xyz);
    vec3 direction = uintBitsToFloat(load_path(slot, PATH_DIRECTION).xyz);
    uint key = sort_key(origin, direction);
    store_key(slot, key);
    atomicAdd(sort.count[key], 1u);
}
