// Counts what traversals do, where FEATURE_STEPS asks for it.
#ifndef STEPS_GLSL
#define STEPS_GLSL

#include "lib/buffers.glsl"

#ifdef BALLOT
#extension GL_KHR_shader_subgroup_arithmetic : require
#endif

// Of this thread's ray.
struct trace_steps {
    uint nodes, primitives;
};

trace_steps steps;

// 64 bits, of which the atomics have halves.
void add_steps(uint which, uint amount)
{
    uint before = atomicAdd(counters.steps[which][0], amount);
    if (before + amount < before)
        atomicAdd(counters.steps[which][1], 1u);
}

// Adds the steps of all threads of the subgroup, which call it together: those without a ray have
// none. `which`: STEPS_CLOSEST or STEPS_SHADOW.
void count_steps(const uint which)
{
#ifdef BALLOT
    uint nodes = subgroupAdd(steps.nodes);
    uint primitives = subgroupAdd(steps.primitives);
    if (!subgroupElect())
        return;
#else
    uint nodes = steps.nodes;
    uint primitives = steps.primitives;
#endif
    add_steps(which, nodes);
    add_steps(which + 1u, primitives);
}

#endif
