// One workgroup converts the counts of keys to the places at which their rays begin, and zeroes the
// counts for the next sort. The sorted queue gets the dispatches of the unsorted one.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "lib/sort.glsl"

layout(constant_id = CONSTANT_WORKGROUP) const uint THREADS = 1u;
shared uint totals[THREADS]; // number of rays in the keys of each thread

void main()
{
    // SORT_KEYS and THREADS are powers of two.
    uint thread = gl_LocalInvocationID.x, keys = max(SORT_KEYS / THREADS, 1u);
    uint first = min(thread * keys, SORT_KEYS), end = min(first + keys, SORT_KEYS);
    uint total = 0u;
    for (uint key = first; key < end; key++)
        total += sort.count[key];
    totals[thread] = total;
    barrier();
    uint place = 0u;
    for (uint before = 0u; before < thread; before++)
        place += totals[before];
    for (uint key = first; key < end; key++) {
        uint count = sort.count[key];
        sort.place[key] = place;
        sort.count[key] = 0u;
        place += count;
    }
    for (uint part = thread; part < DISPATCH_PARTS; part += THREADS)
        counters.dispatch[sorted_queue(push.queue) * DISPATCH_PARTS + part] =
            counters.dispatch[push.queue * DISPATCH_PARTS + part];
}
