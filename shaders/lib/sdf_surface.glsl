// Reads signed distance fields: the point of one that a hit stands for.
#ifndef SDF_SURFACE_GLSL
#define SDF_SURFACE_GLSL

#include "lib/sdf.glsl"
#include "lib/surface_types.glsl"

// Position, its error, and the geometric normal, outwards, of shape `index` near `point`.
void load_sdf_surface(uint index, vec3 point, inout surface s)
{
    s.position = point;
    s.error = vec3(0.0);
    s.normal_geometric = vec3(0.0, 1.0, 0.0);
    s.radius = 0.0;
}

#endif
