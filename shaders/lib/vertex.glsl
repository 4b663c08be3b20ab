// A point on a path where a surface is met, and what may be asked of it.
#ifndef VERTEX_GLSL
#define VERTEX_GLSL

#include "lib/bsdf.glsl"
#include "lib/media.glsl"
#include "lib/surface.glsl"

// The vertex of a path: everything that it is shaded from.
struct vertex {
    uint slot;
    uint primitive;
    uint instance; // its instance, or NO_INSTANCE
    surface s;
    material m;
    mat3 frame; // tangent, bitangent, shading normal
    vec3 wo;    // local
    vec3 throughput;
    media_interface media; // with FEATURE_MEDIA
    float eta;             // see lib/bsdf_types.glsl
    // With INTEGRATOR_BIDIR only:
    vec3 view;   // wo in the world
    float ratio; // Q of lib/bidir.glsl
};

// The medium on the side that `direction` points to.
uint medium_towards(vertex v, vec3 direction)
{
    return dot(direction, v.s.normal_geometric) > 0.0 ? v.media.here : v.media.beyond;
}

// A direction in the local frame, of which the shading normal and the real surface say the same: on
// which side it is. Otherwise light would leak through.
bool sides_agree(vertex v, vec3 direction, vec3 local)
{
    float side = dot(direction, v.s.normal_geometric);
    bool reflects = local.z > 0.0 && side > 0.0;
    bool transmits = local.z < 0.0 && side < 0.0;
    return reflects || (HAS_LOBE(LOBES_THROUGH) && transmits);
}

#endif
