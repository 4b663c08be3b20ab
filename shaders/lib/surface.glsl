// Reads geometry: the point that a hit record stands for.
#ifndef SURFACE_GLSL
#define SURFACE_GLSL

#include "lib/attributes.glsl"
#include "lib/constants.glsl"
#include "lib/instance.glsl"
#include "lib/sampling.glsl"
#include "lib/shape_surface.glsl"
#include "lib/surface_types.glsl"

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

// Unit, whatever the scale.
vec3 normalize_any(vec3 v)
{
    vec3 a = abs(v);
    return normalize(v / max(max(a.x, a.y), max(a.z, 1e-30)));
}

// From the mesh's space to the world's. What is exact is the way to the mesh's space, on which rays
// are tested; so the position's error is that of a ray that starts there and is taken back: both
// transforms' rounding counts, as far as it moves the point off the surface (after Pharr, Jakob,
// Humphreys 2023, section 6.8.4).
void place_surface(uint instance, inout surface s)
{
    uint at = instance_at(instance);
    instance_inverse inverse = load_instance_inverse(instance);
    mat3 rows; // as columns
    for (int i = 0; i < 3; i++)
        rows[i] = load_shapes_float(at + 3u + uint(i)).xyz;
    uvec4 words = load_instance_words(instance);

    vec3 normal = s.normal_geometric;
    bool is_flat = all(equal(s.normal_shading, normal));
    vec3 along = s.position * rows;
    vec3 position = along + inverse.place;
    mat3 absolute = mat3(abs(rows[0]), abs(rows[1]), abs(rows[2]));
    vec3 error = GAMMA(4) * (abs(s.position) * absolute) + GAMMA(2) * abs(position);
    mat3 back = mat3(abs(inverse.rows[0]), abs(inverse.rows[1]), abs(inverse.rows[2]));
    vec3 error_back = s.error + GAMMA(6) * ((abs(along) + error) * back);

    vec3 turned = inverse.rows * normal;
    float height = dot(abs(normal), error_back) / length(turned);
    s.position = position;
    s.normal_geometric = normalize_any(turned);
    if ((words.w & INSTANCE_MIRRORED) != 0u)
        s.normal_geometric = -s.normal_geometric;
    s.error = error + height * abs(s.normal_geometric);
    s.normal_shading =
        is_flat ? s.normal_geometric : normalize_any(inverse.rows * s.normal_shading);
    if (HAS_TANGENT) {
        float sign = (words.w & INSTANCE_MIRRORED) != 0u ? -s.tangent.w : s.tangent.w;
        s.tangent = HAS(FEATURE_TANGENTS) ? vec4(normalize_any(s.tangent.xyz * rows), sign)
                                          : vec4(basis_around(s.normal_shading)[0], 1.0);
    }
    if (words.y != NO_MATERIAL)
        s.material = words.y;
}

// `instance` is that of the primitive, or NO_INSTANCE.
surface load_surface(vec3 origin, vec3 direction, vec4 hit, uint instance)
{
    uint primitive = floatBitsToUint(hit.w);
    bool is_shape = IS_SHAPE(primitive);
    surface s;
    if (HAS(FEATURE_TRIANGLES) && !is_shape)
        s = load_triangle_surface(primitive, hit.yz);
    if (is_shape)
        s = load_shape_surface(primitive & ~PRIMITIVE_SHAPE, origin + hit.x * direction, hit.yz);
    if (HAS_GEOMETRY(GEOMETRY_INSTANCES) && instance != NO_INSTANCE)
        place_surface(instance, s);
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
