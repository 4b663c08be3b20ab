// Executes loops, atomics, barriers and subgroup operations as the driver compiles them, for
// lampyris check: each thread reads four words of Input and writes four of Output. A specialization
// constant selects the routine.
#version 460
#extension GL_GOOGLE_include_directive : require
#ifdef BALLOT
#extension GL_KHR_shader_subgroup_ballot : require
#endif

#include "shared/bindings.h"
#include "shared/check.h"

layout(local_size_x_id = CONSTANT_WORKGROUP) in;
layout(constant_id = CONSTANT_CHECK_ROUTINE) const uint ROUTINE = 0u;
layout(constant_id = CONSTANT_CHECK_COUNT) const uint COUNT = 1u;

layout(std430, set = 0, binding = 0) readonly buffer Input { uvec4 inputs[]; };
layout(std430, set = 0, binding = 1) buffer Output { uvec4 outputs[]; };
layout(std430, set = 0, binding = 2) buffer Counter { uint counter; };
layout(set = 0, binding = TEXEL_BINDING(0)) uniform usamplerBuffer texels;
layout(push_constant) uniform Push { uint items, turn; };

shared uint round_about[128];

#ifdef PLANTED_RACE
#define ADD_ONE(memory) memory++
#else
#define ADD_ONE(memory) atomicAdd(memory, 1u)
#endif

// The number of iterations comes from memory, so that no compiler knows it.
uint turns(uint end)
{
    uint done = 0u;
    for (uint i = 0u; i < end; i++)
        done += 1u + (i & done & 0u);
    return done;
}

// Passes values to the next thread of the workgroup, COUNT times.
uint go_round(uint value)
{
    uint self = gl_LocalInvocationID.x, size = gl_WorkGroupSize.x;
    for (uint i = 0u; i < COUNT; i++) {
        round_about[self] = value;
        barrier();
        value = round_about[(self + 1u) % size];
        barrier();
    }
    return value;
}

uint sum_over_array(uint first)
{
    uint stack[COUNT + 2u];
    for (uint i = 0u; i < COUNT + 2u; i++)
        stack[i] = first * i;
    uint sum = 0u;
    for (uint i = 0u; i < COUNT + 2u; i++)
        sum += stack[(i * 7u + first) % (COUNT + 2u)];
    return sum;
}

#ifdef BALLOT
uvec4 ranks(uint value)
{
    uvec4 odd = subgroupBallot((value & 1u) != 0u);
    uint base = 0u;
    if (subgroupElect())
        base = atomicAdd(counter, subgroupBallotBitCount(odd));
    base = subgroupBroadcastFirst(base);
    return uvec4(gl_SubgroupSize, base + subgroupBallotExclusiveBitCount(odd),
                 subgroupBallotBitCount(odd), value);
}

// Both branches are long, so that no compiler executes both and selects a result.
uvec4 after_branch(uint value)
{
    uint before = subgroupBallotBitCount(subgroupBallot(true));
    uint sum = value;
    if ((value & 1u) != 0u)
        sum += turns(value & 63u);
    else
        sum ^= 5u;
    return uvec4(subgroupBallotBitCount(subgroupBallot(true)), before, sum, 0u);
}
#endif

void main()
{
    uint item = gl_GlobalInvocationID.x;
    uvec4 words = inputs[item];
    if (ROUTINE == CHECK_LOOP)
        outputs[item].x = turns(words.x);
    if (ROUTINE == CHECK_ATOMICS)
        outputs[item].x = ADD_ONE(counter);
    if (ROUTINE == CHECK_BARRIERS)
        outputs[item].x = go_round(words.x);
    if (ROUTINE == CHECK_ARRAY)
        outputs[item].x = sum_over_array(words.x);
    // Each dispatch reads one component and writes another.
    if (ROUTINE == CHECK_DISPATCHES)
        outputs[item][turn & 1u] = 3u * outputs[(item + 1u) % items][~turn & 1u] + 1u;
    if (ROUTINE == CHECK_TEXELS)
        outputs[item] = texelFetch(texels, int(item));
#ifdef BALLOT
    if (ROUTINE == CHECK_SUBGROUPS)
        outputs[item] = ranks(words.x);
    if (ROUTINE == CHECK_RECONVERGENCE)
        outputs[item] = after_branch(words.x);
#endif
}
