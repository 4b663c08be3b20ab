// Reads geometry: the point that a hit record stands for.
#ifndef SURFACE_GLSL
#define SURFACE_GLSL

#include "lib/attributes.glsl"
#include "lib/constants.glsl"
#include "lib/sampling.glsl"

// Whether shading asks for tangents.
#define HAS_TANGENT (HAS(FEATURE_NORMAL_MAPS) || HAS_LOBE(LOBE_ANISOTROPIC))

struct surface {
    vec3 position;
    vec3 error;            // bound of the position's rounding, per component
    vec3 normal_geometric; // unit, towards the ray's origin
    vec3 normal_shading;   // unit, on the same side
    uint material;         // word
    float radius; // of a sphere; 0 otherwise
    vec3 center;  // of a sphere
    bool front;   // seen from where corners run counter-clockwise, or from outside
    // With HAS_TANGENT: unit, not always orthogonal to the shading normal, and the sign of the
    // bitangent sign * cross(normal_shading, tangent). Turned round together with that normal, so
    // that what a normal map says of the one side holds for the other.
    vec4 tangent;
    vec2 uv0, uv1; // with FEATURE_TEXTURES
    vec4 color;    // with FEATURE_COLORS
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

// The tangents' word of a triangle at barycentric coordinates b.
vec4 decode_tangent(uvec4 word, vec3 b)
{
    vec3 t = b.x * decode_normal(word.x) + b.y * decode_normal(word.y) +
             b.z * decode_normal(word.z);
    vec3 signs = 1.0 - 2.0 * vec3(uvec3(word.w) >> uvec3(0u, 1u, 2u) & 1u);
    vec3 unit = dot(t, t) > 0.0 ? normalize(t) : decode_normal(word.x);
    return vec4(unit, dot(b, signs) < 0.0 ? -1.0 : 1.0);
}

// From differences, so that large coordinates that differ little keep their digits.
vec2 load_uv(uint at, vec2 b)
{
    vec4 low = load_attributes_float(at);
    vec2 last = load_attributes_float(at + 1u).xy;
    return low.xy + b.x * (low.zw - low.xy) + b.y * (last - low.xy);
}

vec4 decode_color(uint rg, uint ba)
{
    return vec4(unpackHalf2x16(rg), unpackHalf2x16(ba));
}

vec4 load_color(uint at, vec2 b)
{
    uvec4 low = load_attributes(at);
    uvec4 last = load_attributes(at + 1u);
    return (1.0 - b.x - b.y) * decode_color(low.x, low.y) + b.x * decode_color(low.z, low.w) +
           b.y * decode_color(last.x, last.y);
}

// What the corners carry but normals, at barycentric coordinates b of corners 1 and 2.
void load_corner_attributes(uint index, vec2 b, inout surface s)
{
    uint at = index * ATTRIBUTE_WORDS;
    s.uv0 = s.uv1 = vec2(0.0);
    s.color = vec4(1.0);
    s.tangent = vec4(0.0);
    if (HAS(FEATURE_UV0))
        s.uv0 = load_uv(at + ATTRIBUTE_UV0, b);
    if (HAS(FEATURE_UV1))
        s.uv1 = load_uv(at + ATTRIBUTE_UV1, b);
    if (HAS(FEATURE_COLORS))
        s.color = load_color(at + ATTRIBUTE_COLORS, b);
    if (HAS_TANGENT)
        s.tangent = HAS(FEATURE_TANGENTS) ? decode_tangent(load_attributes(at + ATTRIBUTE_TANGENTS),
                                                           vec3(1.0 - b.x - b.y, b))
                                          : vec4(basis_around(s.normal_shading)[0], 1.0);
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
    load_corner_attributes(index, uv, s);
    return s;
}

// Texture coordinates of a sphere, of the direction from its centre: the picture goes round it once
// and reads from outside; its middle faces +z of the world, its top +y.
vec2 sphere_uv(vec3 n)
{
    float u = 0.5 + atan(n.x, n.z) * (0.5 * INV_PI);
    return vec2(n.x == 0.0 && n.z == 0.0 ? 0.5 : u, atan(length(n.xz), n.y) * INV_PI);
}

// Towards growing u; any direction at the poles, where that is none.
vec3 sphere_tangent(vec3 n)
{
    float across = length(n.xz);
    return across > 0.0 ? vec3(n.z, 0.0, -n.x) / across : vec3(1.0, 0.0, 0.0);
}

// Texture coordinates of a disc: the picture's largest circle, its axes those of basis_around().
vec2 disc_uv(mat3 basis, vec3 from_center, float radius)
{
    return 0.5 + 0.5 / radius * vec2(dot(from_center, basis[0]), -dot(from_center, basis[1]));
}

// Shapes have one set of texture coordinates, and no colours.
void load_shape_attributes(inout surface s, uint kind, float radius)
{
    s.uv0 = vec2(0.0);
    s.color = vec4(1.0);
    s.tangent = vec4(0.0);
    if (HAS(FEATURE_SPHERES) && kind == SHAPE_KIND_SPHERE) {
        if (HAS(FEATURE_TEXTURES))
            s.uv0 = sphere_uv(s.normal_geometric);
        if (HAS_TANGENT)
            s.tangent = vec4(sphere_tangent(s.normal_geometric), 1.0);
    }
    if (HAS(FEATURE_DISCS) && kind == SHAPE_KIND_DISC) {
        mat3 basis = basis_around(s.normal_geometric);
        if (HAS(FEATURE_TEXTURES))
            s.uv0 = disc_uv(basis, s.position - s.center, radius);
        if (HAS_TANGENT)
            s.tangent = vec4(basis[0], 1.0);
    }
    s.uv1 = s.uv0;
}

surface load_shape_surface(uint index, vec3 point)
{
    vec4 w0 = load_shapes_float(index * SHAPE_WORDS);
    uvec4 w1 = load_shapes(index * SHAPE_WORDS + 1u);
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
    load_shape_attributes(s, kind, radius);
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
    if (dot(s.normal_shading, s.normal_geometric) < 0.0) {
        s.normal_shading = -s.normal_shading;
        if (HAS_TANGENT)
            s.tangent = -s.tangent;
    }
    return s;
}

#endif
