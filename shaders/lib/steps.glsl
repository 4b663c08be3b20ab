// Counts the steps of traversals: of all rays with FEATURE_STEPS, of camera rays with AOV_STEPS.
#ifndef STEPS_GLSL
#define STEPS_GLSL

#include "lib/buffers.glsl"

#ifdef BALLOT
#extension GL_KHR_shader_subgroup_arithmetic : require
#endif

#ifdef ANY_HIT
#define COUNTS_STEPS HAS(FEATURE_STEPS)
#else
#define COUNTS_STEPS (HAS(FEATURE_STEPS) || HAS_AOV(AOV_STEPS))
#endif

// The steps of this thread's ray.
struct trace_steps {
    uint nodes, primitives;
};

trace_steps steps;

// Adds to a counter of 64 bits by atomic operations on its halves.
void add_steps(uint which, uint amount)
{
    uint before = atomicAdd(counters.steps[which][0], amount);
    if (before + amount < before)
        atomicAdd(counters.steps[which][1], 1u);
}

// Adds the steps of all threads of the subgroup, which must call it together; threads without a ray
// have none. which: STEPS_CLOSEST or STEPS_SHADOW.
void count_steps(const uint which)
{
#ifdef BALLOT
    uint nodes = subgroupAdd(steps.nodes);
    uint primitives = subgroupAdd(steps.primitives);
    bool adds = subgroupElect();
#else
    uint nodes = steps.nodes;
    uint primitives = steps.primitives;
    const bool adds = true;
#endif
    if (adds) {
        add_steps(which, nodes);
        add_steps(which + 1u, primitives);
    }
}

// Adds this thread's steps to AOV_STEPS if it has traced a camera ray. If the traversal was
// suspended before, the AOV has its earlier steps already.
void store_steps(uint slot, bool valid)
{
    if (valid && push.bounce == 0u)
        add_aov_scalar(slot, AOV_STEPS, float(steps.nodes + steps.primitives));
}

#endif
