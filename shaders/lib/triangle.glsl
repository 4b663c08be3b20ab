// Reads triangles' records.
#ifndef TRIANGLE_GLSL
#define TRIANGLE_GLSL

#include "lib/buffers.glsl"

// A struct gpu_triangle, unpacked.
struct triangle_record {
    vec3 v0, v1, v2;
    vec3 edge1, edge2; // from v0 to v1 and v2
    uint id;
    uint word; // material word
    uint emitter; // emitter index; if IS_SMALL, its index among the small triangles
};

// True if a triangle with this material word has exact edges, while its corners are rounded. It is
// a macro, so that constant arguments give constant results.
#define IS_SMALL(word)                                                                             \
    (HAS_GEOMETRY(GEOMETRY_SMALL_TRIANGLES) && ((word)&MATERIAL_WORD_EDGES) != 0u)

triangle_record load_triangle(uint index)
{
    uvec4 w0 = load_triangles(index * 3u);
    uvec4 w1 = load_triangles(index * 3u + 1u);
    uvec4 w2 = load_triangles(index * 3u + 2u);
    triangle_record t;
    t.v0 = uintBitsToFloat(w0.xyz);
    t.v1 = uintBitsToFloat(w1.xyz);
    t.v2 = uintBitsToFloat(w2.xyz);
    t.id = w0.w;
    t.word = w1.w;
    t.emitter = w2.w;
    t.edge1 = t.v1 - t.v0;
    t.edge2 = t.v2 - t.v0;
    if (IS_SMALL(t.word)) {
        t.edge1 = t.v1;
        t.edge2 = t.v2;
        t.v1 = t.v0 + t.edge1;
        t.v2 = t.v0 + t.edge2;
    }
    return t;
}

// Returns the largest component of the edges, because products of smaller ones may underflow.
float triangle_size(triangle_record t)
{
    vec3 a = max(abs(t.edge1), abs(t.edge2));
    return max(a.x, max(a.y, a.z));
}

vec3 triangle_normal(triangle_record t)
{
    if (!IS_SMALL(t.word))
        return normalize(cross(t.edge1, t.edge2));
    float size = triangle_size(t);
    return normalize(cross(t.edge1 / size, t.edge2 / size));
}

float triangle_area(triangle_record t)
{
    if (!IS_SMALL(t.word))
        return 0.5 * length(cross(t.edge1, t.edge2));
    float size = triangle_size(t);
    return 0.5 * (size * size) * length(cross(t.edge1 / size, t.edge2 / size));
}

#endif
