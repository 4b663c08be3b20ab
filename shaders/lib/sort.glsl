// Sorts rays before they are traced: by the octant of the direction, then by the cell of the origin
// along Morton's curve (Morton 1966), so that neighbouring rays visit the same nodes. Three kernels
// sort a queue by counting (Knuth 1973, section 5.2, algorithm D): sort_count, sort_scan and
// sort_scatter. They write the sorted queue to the other queue of rays, which is empty until
// shading fills it. Declares the binding of the counts and places.
#ifndef SORT_GLSL
#define SORT_GLSL

#include "lib/queue.glsl"

layout(std430, set = 0, binding = BINDING_SORT) buffer sort_block {
    gpu_sort sort;
};

const uint SORT_CELLS = 1u << SORT_CELL_BITS;

// Returns the queue that receives the rays of `queue` in sorted order.
uint sorted_queue(uint queue)
{
    return 2u * QUEUE_RAYS + 1u - queue;
}

// Inserts two zeros between neighbouring bits of a cell's coordinate.
uint spread_bits(uint number)
{
    uint spread = 0u;
    for (uint bit = 0u; bit < SORT_CELL_BITS; bit++)
        spread |= (number >> bit & 1u) << 3u * bit;
    return spread;
}

// Rays from outside the scene's bounds count to the nearest cells. For any float, including NaN,
// and on any device, the key is below SORT_KEYS.
uint sort_key(vec3 origin, vec3 direction)
{
    uint key = 0u;
    for (uint c = 0u; c < 3u; c++) {
        float place = (origin[c] - frame.cells_begin[c]) * frame.cells_a_length[c];
        uint cell = min(uint(clamp(place, 0.0, float(SORT_CELLS - 1u))), SORT_CELLS - 1u);
        uint octant = direction[c] < 0.0 ? 1u : 0u;
        key |= spread_bits(cell) << c | octant << (3u * SORT_CELL_BITS + c);
    }
    return key;
}

// Stores a ray's key where its hit will be stored later. If the key were computed twice, the
// results might differ.
void store_key(uint slot, uint key)
{
    store_path(slot, PATH_HIT, uvec4(key, 0u, 0u, NO_PRIMITIVE));
}

// Returns a valid key whatever was stored, because the test `render order of kernels` leaves out
// the barrier that prevents hits from being written first.
uint load_key(uint slot)
{
    return load_path(slot, PATH_HIT).x & (SORT_KEYS - 1u);
}

#endif
