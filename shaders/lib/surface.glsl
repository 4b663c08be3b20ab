// Reads geometry: the surface point of a hit.
#ifndef SURFACE_GLSL
#define SURFACE_GLSL

#include "lib/attributes.glsl"
#include "lib/constants.glsl"
#include "lib/instance.glsl"
#include "lib/sampling.glsl"
#include "lib/shape_surface.glsl"
#include "lib/surface_types.glsl"
#include "lib/triangle.glsl"

// Decodes an octahedral unit vector (Cigolle et al. 2014, "A Survey of Efficient Representations
// for Independent Unit Vectors", listing 2).
vec3 decode_normal(uint encoded)
{
    vec2 e = unpackSnorm2x16(encoded);
    vec3 v = vec3(e, 1.0 - abs(e.x) - abs(e.y));
    if (v.z < 0.0)
        v.xy = (1.0 - abs(v.yx)) * mix(vec2(-1.0), vec2(1.0), greaterThanEqual(v.xy, vec2(0.0)));
    return normalize(v);
}

// Returns a unit vector, even if squares of the components overflow or underflow.
vec3 normalize_any(vec3 v)
{
    vec3 a = abs(v);
    return normalize(v / max(max(a.x, a.y), max(a.z, 1e-30)));
}

// The transform of a triangle. The directions at the corners are transformed before they are
// interpolated. For triangles in world space, this was done when the scene was flattened.
struct placement {
    bool exists;            // false: the triangle is in world space
    instance_inverse inverse;
    mat3 rows;              // rows of the matrix to world space, stored as columns
    uvec4 words;
};

placement load_placement(uint instance)
{
    placement p;
    p.exists = HAS_GEOMETRY(GEOMETRY_INSTANCES) && instance != NO_INSTANCE;
    if (HAS_GEOMETRY(GEOMETRY_INSTANCES) && p.exists) {
        p.inverse = load_instance_inverse(instance);
        for (int i = 0; i < 3; i++)
            p.rows[i] = load_shapes_float(instance_at(instance) + 3u + uint(i)).xyz;
        p.words = load_instance_words(instance);
    }
    return p;
}

vec3 place_normal(placement p, vec3 normal)
{
    if (HAS_GEOMETRY(GEOMETRY_INSTANCES) && p.exists)
        return normalize_any(p.inverse.rows * normal);
    return normal;
}

vec3 place_tangent(placement p, vec3 tangent)
{
    if (HAS_GEOMETRY(GEOMETRY_INSTANCES) && p.exists)
        return normalize_any(tangent * p.rows);
    return tangent;
}

// Transforms a surface point from the mesh's space to world space. The geometric normal faces the
// same side; under reflections, too, the outside stays outside. The transform to the mesh's space,
// in which rays are tested, counts as exact. So the error of the position is that of a ray that
// starts there and is transformed back: the rounding errors of both transforms, as far as they move
// the point off the surface (after Pharr, Jakob, Humphreys 2023, section 6.8.4).
void place_point(placement p, inout surface s)
{
    vec3 along = s.position * p.rows;
    vec3 position = along + p.inverse.place;
    mat3 absolute = mat3(abs(p.rows[0]), abs(p.rows[1]), abs(p.rows[2]));
    vec3 error = GAMMA(4) * (abs(s.position) * absolute) + GAMMA(2) * abs(position);
    mat3 rows = p.inverse.rows;
    mat3 back = mat3(abs(rows[0]), abs(rows[1]), abs(rows[2]));
    vec3 error_back = s.error + GAMMA(6) * ((abs(along) + error) * back);

    vec3 normal = s.normal_geometric;
    float height = dot(abs(normal), error_back) / length(rows * normal);
    s.position = position;
    s.normal_geometric = place_normal(p, normal);
    s.error = error + height * abs(s.normal_geometric);
    if (p.words.y != NO_MATERIAL)
        s.material = p.words.y;
}

// Decodes a triangle's word of tangents, interpolated at barycentric coordinates b.
vec4 decode_tangent(uvec4 word, vec3 b, placement p)
{
    vec3 corners[3];
    for (int i = 0; i < 3; i++)
        corners[i] = place_tangent(p, decode_normal(word[i]));
    vec3 t = b.x * corners[0] + b.y * corners[1] + b.z * corners[2];
    vec3 signs = 1.0 - 2.0 * vec3(uvec3(word.w) >> uvec3(0u, 1u, 2u) & 1u);
    vec3 unit = dot(t, t) > 0.0 ? normalize(t) : corners[0];
    bool is_negative = dot(b, signs) < 0.0;
    if (HAS_GEOMETRY(GEOMETRY_INSTANCES) && p.exists)
        is_negative = is_negative != ((p.words.w & INSTANCE_MIRRORED) != 0u);
    return vec4(unit, is_negative ? -1.0 : 1.0);
}

// Interpolates differences, so that large coordinates with small differences stay accurate.
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

// Loads the attributes of corners except normals, at barycentric coordinates b of corners 1 and 2.
void load_corner_attributes(uint index, vec2 b, placement p, inout surface s)
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
                                                           vec3(1.0 - b.x - b.y, b), p)
                                          : vec4(basis_around(s.normal_shading)[0], 1.0);
}

// This overload is for callers that need no tangents.
void load_corner_attributes(uint index, vec2 b, inout surface s)
{
    load_corner_attributes(index, b, load_placement(NO_INSTANCE), s);
}

surface load_triangle_surface(uint index, vec2 uv, uint instance)
{
    placement p = load_placement(instance);
    triangle_record t = load_triangle(index);
    vec3 v0 = t.v0, v1 = t.v1, v2 = t.v2;
    vec3 b = vec3(1.0 - uv.x - uv.y, uv);

    surface s;
    s.position = b.x * v0 + b.y * v1 + b.z * v2;
    // This bound is from Pharr, Jakob, Humphreys 2023, section 6.8.5.
    s.error = GAMMA(7) * (abs(b.x * v0) + abs(b.y * v1) + abs(b.z * v2));
    s.normal_geometric = triangle_normal(t);
    s.material = t.word;
    if (HAS_GEOMETRY(GEOMETRY_INSTANCES) && p.exists)
        place_point(p, s);
    s.normal_shading = s.normal_geometric;
    if (HAS(FEATURE_NORMALS)) {
        uvec4 encoded = load_attributes(index * ATTRIBUTE_WORDS);
        vec3 n = b.x * place_normal(p, decode_normal(encoded.x)) +
                 b.y * place_normal(p, decode_normal(encoded.y)) +
                 b.z * place_normal(p, decode_normal(encoded.z));
        // Opposite normals may cancel (docs/verification.md, C26).
        if (encoded.x != NORMAL_FLAT && dot(n, n) > 0.0)
            s.normal_shading = normalize(n);
    }
    s.radius = 0.0;
    s.center = vec3(0.0);
    load_corner_attributes(index, uv, p, s);
    return s;
}

// Returns the surface point of a hit. t, uv: distance and barycentrics or other data of the hit;
// instance: that of the primitive, or NO_INSTANCE.
surface load_surface(vec3 origin, vec3 direction, float t, vec2 uv, uint primitive, uint instance)
{
    bool is_shape = IS_SHAPE(primitive);
    surface s;
    if (HAS(FEATURE_TRIANGLES) && !is_shape)
        s = load_triangle_surface(primitive, uv, instance);
    if (is_shape)
        s = load_shape_surface(primitive & ~PRIMITIVE_SHAPE, origin + t * direction, uv);
    // Both sides of a surface reflect and emit, so the normal is turned to the viewer.
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
