// Defines the type of a point on a surface.
#ifndef SURFACE_TYPES_GLSL
#define SURFACE_TYPES_GLSL

#include "lib/constants.glsl"

// True if shading needs tangents.
#define HAS_TANGENT (HAS(FEATURE_NORMAL_MAPS) || HAS_LOBE(LOBE_ANISOTROPIC))

struct surface {
    vec3 position;
    vec3 error;            // bound on the position's rounding error, per component
    vec3 normal_geometric; // unit, towards the ray's origin
    vec3 normal_shading;   // unit, on the side of normal_geometric
    uint material;         // material word
    float radius; // radius of a sphere; 0 otherwise
    vec3 center;  // centre of a sphere
    bool front;   // seen from the side from which corners run counter-clockwise, or from outside
    // With HAS_TANGENT: unit tangent, not always orthogonal to the shading normal, and the sign of
    // the bitangent sign * cross(normal_shading, tangent). If the normal is turned to the viewer,
    // so is the frame, so that a normal map applies to the other side, too.
    vec4 tangent;
    vec2 uv0, uv1; // with FEATURE_TEXTURES
    vec4 color;    // with FEATURE_COLORS
};

#endif
