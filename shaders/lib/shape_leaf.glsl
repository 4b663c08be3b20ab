// Where a ray meets the shape of a leaf.
#ifndef SHAPE_LEAF_GLSL
#define SHAPE_LEAF_GLSL

#include "lib/alpha.glsl"
#include "lib/intersect_shape.glsl"
#include "lib/sdf_march.glsl"
#include "lib/trace_types.glsl"

// The distance at which a shape that is not everywhere there is met: where a ray passes a sphere's
// near side it may meet the far one, another place of decision. Negative: nowhere.
float shape_hit_there(trace_ray ray, vec3 center, uint kind, uint primitive, uint word, float t)
{
    const uint far_side = 0x80000000u;
    vec3 point = ray.origin + t * ray.direction;
    if (!(t > 0.0) || alpha_passes(primitive, vec2(0.0), point, word, primitive, ray.alpha))
        return t;
    if (!IS_KIND(kind, SHAPE_KIND_SPHERE) || primitive == ray.ignore_a)
        return -1.0;
    // The roots' sum is twice the distance of the point nearest to the centre.
    float length2 = dot(ray.direction, ray.direction);
    float far = 2.0 * dot(center - ray.origin, ray.direction) / length2 - t;
    point = ray.origin + far * ray.direction;
    bool there = far > t && alpha_passes(primitive, vec2(0.0), point, word, primitive | far_side,
                                         ray.alpha);
    return there ? far : -1.0;
}

// False when the budget of iterations ended on the way through a distance field: `march` says where.
bool intersect_shape_leaf(trace_ray ray, uint index, inout float march, inout uint iterations,
                          inout trace_hit best)
{
    vec4 w0 = load_shapes_float(index * SHAPE_WORDS);
    uvec4 w1 = load_shapes(index * SHAPE_WORDS + 1u);
    uint kind = w1.w >> SHAPE_KIND_SHIFT;
    uint primitive = PRIMITIVE_SHAPE | index;
    float t = -1.0;
    bool done = true;
    if (IS_KIND(kind, SHAPE_KIND_SPHERE) && primitive != ray.ignore_b)
        t = intersect_sphere(ray.origin, ray.direction, w0.xyz, w0.w, primitive == ray.ignore_a);
    if (IS_KIND(kind, SHAPE_KIND_DISC) && primitive != ray.ignore_a && primitive != ray.ignore_b)
        t = intersect_disc(ray.origin, ray.direction, w0.xyz, uintBitsToFloat(w1.xyz), w0.w);
    if (IS_KIND(kind, SHAPE_KIND_SDF))
        done = march_sdf(ray, index, best.t, march, iterations, t);
    if (HAS(FEATURE_ALPHA) && (w1.w & MATERIAL_WORD_ALPHA) != 0u)
        t = shape_hit_there(ray, w0.xyz, kind, primitive, w1.w, t);
    accept_hit(best, done, t, vec2(0.0), primitive, primitive);
    return done;
}

#endif
