// Defines the type of a path's vertex, and functions of it.
#ifndef VERTEX_GLSL
#define VERTEX_GLSL

#include "lib/bsdf.glsl"
#include "lib/media.glsl"
#include "lib/surface.glsl"

// All data from which a vertex of a path is shaded.
struct vertex {
    uint slot;
    uint primitive;
    uint instance; // instance, or NO_INSTANCE
    surface s;
    material m;
    mat3 frame; // tangent, bitangent, shading normal
    vec3 wo;    // in the local frame
    vec3 throughput;
    media_interface media; // with FEATURE_MEDIA
    float eta;             // see lib/bsdf_types.glsl
    // The following are valid with INTEGRATOR_BIDIR only.
    vec3 view;   // wo in world space
    float ratio; // Q of lib/bidir.glsl
};

// Returns the medium on the side to which `direction` points.
uint medium_towards(vertex v, vec3 direction)
{
    return dot(direction, v.s.normal_geometric) > 0.0 ? v.media.here : v.media.beyond;
}

// Returns whether a direction is on the same side of the shading normal as of the geometric normal.
// Otherwise light would leak through the surface.
bool sides_agree(vertex v, vec3 direction, vec3 local)
{
    float side = dot(direction, v.s.normal_geometric);
    bool reflects = local.z > 0.0 && side > 0.0;
    bool transmits = local.z < 0.0 && side < 0.0;
    return reflects || (HAS_LOBE(LOBES_THROUGH) && transmits);
}

#endif
