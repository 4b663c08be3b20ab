// Reads shapes: the point of one that a hit record stands for.
#ifndef SHAPE_SURFACE_GLSL
#define SHAPE_SURFACE_GLSL

#include "lib/buffers.glsl"
#include "lib/primitive.glsl"
#include "lib/sampling.glsl"
#include "lib/sdf_surface.glsl"
#include "lib/surface_types.glsl"

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
    if (IS_KIND(kind, SHAPE_KIND_SPHERE)) {
        if (HAS(FEATURE_TEXTURES))
            s.uv0 = sphere_uv(s.normal_geometric);
        if (HAS_TANGENT)
            s.tangent = vec4(sphere_tangent(s.normal_geometric), 1.0);
    }
    if (IS_KIND(kind, SHAPE_KIND_DISC)) {
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
    if (IS_KIND(kind, SHAPE_KIND_SPHERE)) {
        // Projected back onto the sphere: what is left is the rounding of normalize (4), scaling
        // and addition.
        s.normal_geometric = normalize(point - center);
        s.position = center + radius * s.normal_geometric;
        s.error = GAMMA(7) * (abs(center) + radius * abs(s.normal_geometric));
        s.radius = radius;
    }
    if (IS_KIND(kind, SHAPE_KIND_DISC)) {
        s.normal_geometric = uintBitsToFloat(w1.xyz);
        vec3 height = dot(point - center, s.normal_geometric) * s.normal_geometric;
        s.position = point - height;
        s.error = GAMMA(7) * (abs(point) + abs(center) + abs(height));
        s.radius = 0.0;
    }
    if (IS_KIND(kind, SHAPE_KIND_SDF))
        load_sdf_surface(index, point, s);
    s.normal_shading = s.normal_geometric;
    load_shape_attributes(s, kind, radius);
    return s;
}

#endif
