// Declares the buffer of suspended traversals, which has the state with which trace() continues in
// a later dispatch.
#ifndef SUSPEND_GLSL
#define SUSPEND_GLSL

#include "lib/traverse.glsl"

layout(std430, set = 0, binding = BINDING_SUSPENDED) buffer suspended_block {
    uint suspended_words[];
};

const uint SUSPENDED_HEADER = SUSPENDED_WORDS_OF(GEOMETRY);
const uint SUSPENDED_STRIDE = SUSPENDED_HEADER + STACK_LENGTH;

void suspend(uint slot, trace_state state, trace_hit hit)
{
    uint base = slot * SUSPENDED_STRIDE;
    suspended_words[base + 0u] = state.current;
    suspended_words[base + 1u] = state.depth;
    suspended_words[base + 2u] = floatBitsToUint(hit.t);
    suspended_words[base + 3u] = floatBitsToUint(hit.uv.x);
    suspended_words[base + 4u] = floatBitsToUint(hit.uv.y);
    suspended_words[base + 5u] = hit.primitive;
    suspended_words[base + 6u] = hit.id;
    suspended_words[base + 7u] = floatBitsToUint(state.march);
    if (HAS_GEOMETRY(GEOMETRY_INSTANCES)) {
        suspended_words[base + 8u] = state.instance;
        suspended_words[base + 9u] = hit.instance;
    }
    for (uint i = 0u; i < state.depth; i++)
        suspended_words[base + SUSPENDED_HEADER + i] = stack_load(i);
}

void resume(uint slot, out trace_state state, out trace_hit hit)
{
    uint base = slot * SUSPENDED_STRIDE;
    uint instance = NO_INSTANCE;
    uint hit_instance = NO_INSTANCE;
    if (HAS_GEOMETRY(GEOMETRY_INSTANCES)) {
        instance = suspended_words[base + 8u];
        hit_instance = suspended_words[base + 9u];
    }
    state = trace_state(suspended_words[base + 0u], suspended_words[base + 1u],
                        uintBitsToFloat(suspended_words[base + 7u]), instance);
    hit = trace_hit(uintBitsToFloat(suspended_words[base + 2u]),
                    vec2(uintBitsToFloat(suspended_words[base + 3u]),
                         uintBitsToFloat(suspended_words[base + 4u])),
                    suspended_words[base + 5u], suspended_words[base + 6u], hit_instance);
    for (uint i = 0u; i < state.depth; i++)
        stack_store(i, suspended_words[base + SUSPENDED_HEADER + i]);
}

// Returns the key of alpha's decisions for the ray of a slot.
uvec4 ray_alpha(uint slot, bool is_shadow)
{
    if (!HAS(FEATURE_ALPHA))
        return uvec4(0u);
    return alpha_key(frame.seed + slot_stream(slot), slot_pixel(slot), slot_sample(slot),
                     push.bounce, is_shadow);
}

// Traces a ray from its start, or continues a suspended one; returns true when it is complete. An
// incomplete traversal is saved and queued (FEATURE_SUSPEND); without that feature it is counted,
// and the results of the wave are void.
bool trace_or_suspend(uint slot, bool valid, trace_ray ray, inout trace_hit hit)
{
    trace_state state;
    trace_begin(state);
    if (HAS(FEATURE_SUSPEND)) {
        if (valid && push.queue >= QUEUE_SUSPENDED)
            resume(slot, state, hit);
    }
    if (!valid)
        state.current = BVH_EMPTY;

    uint iterations = 0u;
    if (COUNTS_STEPS)
        steps = trace_steps(0u, 0u);
    trace(ray, state, hit, iterations);
    if (HAS(FEATURE_STEPS)) {
#ifdef ANY_HIT
        count_steps(STEPS_SHADOW);
#else
        count_steps(STEPS_CLOSEST);
#endif
    }
#ifndef ANY_HIT
    if (HAS_AOV(AOV_STEPS))
        store_steps(slot, valid);
#endif
    bool done = state.current == BVH_EMPTY;

    if (HAS(FEATURE_SUSPEND)) {
        if (!done)
            suspend(slot, state, hit);
        uint next = push.queue == QUEUE_SUSPENDED ? QUEUE_SUSPENDED + 1u : QUEUE_SUSPENDED;
        queue_push(next, slot, !done);
    } else if (!done) {
        atomicAdd(counters.unfinished, 1u);
    }
    return done && valid;
}

#endif
