// The attributes of a point on a surface.
#ifndef SURFACE_TYPES_GLSL
#define SURFACE_TYPES_GLSL

#include "lib/constants.glsl"

// True where shading asks for tangents.
#define HAS_TANGENT (HAS(FEATURE_NORMAL_MAPS) || HAS_LOBE(LOBE_ANISOTROPIC))

struct surface {
    vec3 position;
    vec3 error;            // bound of the position's rounding, per component
    vec3 normal_geometric; // unit, towards the ray's origin
    vec3 normal_shading;   // unit, on the same side
    uint material;         // word
    float radius; // radius of a sphere; 0 otherwise
    vec3 center;  // centre of a sphere
    bool front;   // seen from where corners run counter-clockwise, or from outside
    // With HAS_TANGENT: unit, not always orthogonal to the shading normal, and the sign of the
    // bitangent sign * cross(normal_shading, tangent). Turned round together with that normal, so
    // that what a normal map says of the one side holds for the other.
    vec4 tangent;
    vec2 uv0, uv1; // with FEATURE_TEXTURES
    vec4 color;    // with FEATURE_COLORS
};

#endif
