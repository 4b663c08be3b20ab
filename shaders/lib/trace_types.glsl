// Defines the types of a ray to trace and of its nearest hit so far.
#ifndef TRACE_TYPES_GLSL
#define TRACE_TYPES_GLSL

#include "lib/primitive.glsl"

struct trace_ray {
    vec3 origin;
    vec3 direction;
    uint ignore_a, ignore_b; // primitive words of the ray's start and of its target
    uint start_instance;     // instance of ignore_a; ignore_b is always in world space
    uvec4 alpha; // key of the random decisions at blended surfaces: see lib/alpha.glsl
};

// Returns the ray for threads that have none: their slot's records may be unused, or another
// thread's.
trace_ray no_ray()
{
    return trace_ray(vec3(0.0), vec3(0.0, 0.0, 1.0), NO_PRIMITIVE, NO_PRIMITIVE, NO_INSTANCE,
                     uvec4(0u));
}

struct trace_hit {
    float t;        // distance so far, in units of the direction's length
    vec2 uv;
    uint primitive; // NO_PRIMITIVE: none
    uint id;        // decides between hits at equal distance, so that the BVH does not matter
    uint instance;  // decides before `id` between hits at equal distance; world space precedes all
                    // instances
};

void accept_hit(inout trace_hit best, bool hit, float t, vec2 uv, uint primitive, uint id,
                uint instance)
{
    bool lower = id < best.id;
    if (HAS_GEOMETRY(GEOMETRY_INSTANCES) && instance != best.instance)
        lower = instance + 1u < best.instance + 1u;
    bool nearer = hit && t > 0.0 && (t < best.t || (t == best.t && lower));
    best.t = nearer ? t : best.t;
    best.uv = nearer ? uv : best.uv;
    best.primitive = nearer ? primitive : best.primitive;
    best.id = nearer ? id : best.id;
    if (HAS_GEOMETRY(GEOMETRY_INSTANCES))
        best.instance = nearer ? instance : best.instance;
}

// Accepts a hit of a primitive that belongs to the world, not to an instance.
void accept_hit(inout trace_hit best, bool hit, float t, vec2 uv, uint primitive, uint id)
{
    accept_hit(best, hit, t, uv, primitive, id, NO_INSTANCE);
}

#endif
