// Reads geometry: the point that a hit record stands for.
#ifndef SURFACE_GLSL
#define SURFACE_GLSL

#include "lib/attributes.glsl"
#include "lib/constants.glsl"

struct surface {
    vec3 position;
    vec3 error;            // bound of the position's rounding, per component
    vec3 normal_geometric; // unit, towards the ray's origin
    vec3 normal_shading;   // unit, on the same side
    uint material;         // word
    float radius; // of a sphere; 0 otherwise
    vec3 center;  // of a sphere
    bool front;   // seen from where corners run counter-clockwise, or from outside
};

// Octahedral decoding (Cigolle et al. 2014, "A Survey of Efficient Representations for Independent
// Unit Vectors", listing 2).
vec3 decode_normal(uint encoded)
{
    vec2 e = unpackSnorm2x16(encoded);
    vec3 v = vec3(e, 1.0 - abs(e.x) - abs(e.y));
    if (v.z < 0.0)
        v.xy = (1.0 - abs(v.yx)) * mix(vec2(-1.0), vec2(1.0), greaterThanEqual(v.xy, vec2(0.0)));
    return normalize(v);
}

surface load_triangle_surface(uint index, vec2 uv)
{
    vec3 v0 = load_triangles_float(index * 3u).xyz;
    uvec4 w1 = load_triangles(index * 3u + 1u);
    vec3 v1 = uintBitsToFloat(w1.xyz);
    vec3 v2 = load_triangles_float(index * 3u + 2u).xyz;
    vec3 b = vec3(1.0 - uv.x - uv.y, uv);

    surface s;
    s.position = b.x * v0 + b.y * v1 + b.z * v2;
    // Pharr, Jakob, Humphreys 2023, section 6.8.5.
    s.error = GAMMA(7) * (abs(b.x * v0) + abs(b.y * v1) + abs(b.z * v2));
    s.normal_geometric = normalize(cross(v1 - v0, v2 - v0));
    s.normal_shading = s.normal_geometric;
    if (HAS(FEATURE_NORMALS)) {
        uvec4 encoded = load_attributes(index * ATTRIBUTE_WORDS);
        vec3 n = b.x * decode_normal(encoded.x) + b.y * decode_normal(encoded.y) +
                 b.z * decode_normal(encoded.z);
        // Opposite normals may cancel (stiff case C26).
        if (encoded.x != NORMAL_FLAT && dot(n, n) > 0.0)
            s.normal_shading = normalize(n);
    }
    s.material = w1.w;
    s.radius = 0.0;
    s.center = vec3(0.0);
    return s;
}

surface load_shape_surface(uint index, vec3 point)
{
    vec4 w0 = load_shapes_float(index * 2u);
    uvec4 w1 = load_shapes(index * 2u + 1u);
    uint kind = w1.w >> SHAPE_KIND_SHIFT;
    vec3 center = w0.xyz;
    float radius = w0.w;

    surface s;
    s.material = w1.w;
    s.center = center;
    if (HAS(FEATURE_SPHERES) && kind == SHAPE_KIND_SPHERE) {
        // Projected back onto the sphere: what is left is the rounding of normalize (4), scaling
        // and addition.
        s.normal_geometric = normalize(point - center);
        s.position = center + radius * s.normal_geometric;
        s.error = GAMMA(7) * (abs(center) + radius * abs(s.normal_geometric));
        s.radius = radius;
    }
    if (HAS(FEATURE_DISCS) && kind == SHAPE_KIND_DISC) {
        s.normal_geometric = uintBitsToFloat(w1.xyz);
        vec3 height = dot(point - center, s.normal_geometric) * s.normal_geometric;
        s.position = point - height;
        s.error = GAMMA(7) * (abs(point) + abs(center) + abs(height));
        s.radius = 0.0;
    }
    s.normal_shading = s.normal_geometric;
    return s;
}

surface load_surface(vec3 origin, vec3 direction, vec4 hit)
{
    uint primitive = floatBitsToUint(hit.w);
    bool is_shape = (HAS(FEATURE_SPHERES) || HAS(FEATURE_DISCS)) &&
                    (HAS(FEATURE_TRIANGLES) ? (primitive & PRIMITIVE_SHAPE) != 0u : true);
    surface s;
    if (HAS(FEATURE_TRIANGLES) && !is_shape)
        s = load_triangle_surface(primitive, hit.yz);
    if (is_shape)
        s = load_shape_surface(primitive & ~PRIMITIVE_SHAPE, origin + hit.x * direction);
    // Both sides of a surface reflect and emit: face the viewer.
    s.front = dot(s.normal_geometric, direction) <= 0.0;
    if (!s.front)
        s.normal_geometric = -s.normal_geometric;
    if (dot(s.normal_shading, s.normal_geometric) < 0.0)
        s.normal_shading = -s.normal_shading;
    return s;
}

#endif
