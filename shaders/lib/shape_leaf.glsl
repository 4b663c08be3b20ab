// Intersects a ray with the shape of a leaf.
#ifndef SHAPE_LEAF_GLSL
#define SHAPE_LEAF_GLSL

#include "lib/alpha.glsl"
#include "lib/sdf_march.glsl"
#include "lib/shape_record.glsl"
#include "lib/trace_types.glsl"

// For shapes with alpha, moves to the first crossing at which the surface exists. If the ray passes
// through the near side, it may hit the far side, for which the decision is independent.
void cross_where_there(trace_ray ray, shape_record shape, uint primitive, inout crossings c)
{
    const uint far_side = 0x80000000u;
    vec3 point = ray.origin + c.first * ray.direction;
    if (!(c.first > 0.0) ||
        alpha_passes(primitive, c.first_at, point, shape.word, primitive, ray.alpha))
        return;
    point = ray.origin + c.second * ray.direction;
    bool there = c.second > c.first && alpha_passes(primitive, c.second_at, point, shape.word,
                                                    primitive | far_side, ray.alpha);
    c.first = there ? c.second : -1.0;
    c.first_at = c.second_at;
}

// Intersects the ray with a shape. Returns false if the iteration budget was used up inside a
// distance field; `march` is then the position reached.
bool intersect_shape_leaf(trace_ray ray, uint index, inout float march, inout uint iterations,
                          inout trace_hit best)
{
    shape_record shape = load_shape(index);
    uint primitive = PRIMITIVE_SHAPE | index;
    bool done = true;
    crossings c = cross_shape(ray.origin, ray.direction, shape, primitive == ray.ignore_a);
    if (IS_KIND(shape.kind, SHAPE_KIND_SDF)) {
        float t;
        done = march_sdf(ray, index, best.t, march, iterations, t);
        c = crossing_at(t);
    }
    if (HAS(FEATURE_ALPHA) && (shape.word & MATERIAL_WORD_ALPHA) != 0u)
        cross_where_there(ray, shape, primitive, c);
    bool sought = primitive == ray.ignore_b;
    accept_hit(best, done && !sought, c.first, c.first_at, primitive, primitive);
    return done;
}

#endif
