// Reads the records of shapes, and finds the crossings of rays with them.
#ifndef SHAPE_RECORD_GLSL
#define SHAPE_RECORD_GLSL

#include "lib/buffers.glsl"
#include "lib/intersect_shape.glsl"
#include "lib/large_sphere.glsl"
#include "lib/primitive.glsl"

// A struct gpu_shape, unpacked.
struct shape_record {
    vec3 center;
    float radius;
    vec3 axis;
    vec3 other; // loaded if the scene has kinds of shapes that need it
    uint kind;
    uint word; // material word
};

shape_record load_shape(uint index)
{
    vec4 w0 = load_shapes_float(index * SHAPE_WORDS);
    uvec4 w1 = load_shapes(index * SHAPE_WORDS + 1u);
    shape_record shape;
    shape.center = w0.xyz;
    shape.radius = w0.w;
    shape.axis = uintBitsToFloat(w1.xyz);
    shape.other = vec3(0.0);
    shape.kind = w1.w >> SHAPE_KIND_SHIFT;
    shape.word = w1.w;
    if (HAS_GEOMETRY(GEOMETRY_QUADS | GEOMETRY_BOXES))
        shape.other = load_shapes_float(index * SHAPE_WORDS + 2u).yzw;
    return shape;
}

// Loads `other` for shapes where it is a direction that only textures need.
vec3 load_shape_across(uint index)
{
    return load_shapes_float(index * SHAPE_WORDS + 2u).yzw;
}

crossings crossing_at(float t)
{
    return crossings(t, -1.0, vec2(0.0), vec2(0.0));
}

// Returns the crossings of a ray with any shape except distance fields, for which see
// lib/sdf_march.glsl. starts_here: the ray starts on this shape.
crossings cross_shape(vec3 origin, vec3 direction, shape_record shape, bool starts_here)
{
    crossings c = crossing_at(-1.0);
    if (IS_KIND(shape.kind, SHAPE_KIND_SPHERE)) {
        if (HAS_GEOMETRY(GEOMETRY_LARGE_SPHERES)) {
            vec2 t;
            bool met = intersect_large_sphere(origin, direction, shape.center, shape.radius,
                                              starts_here, t);
            c.first = met ? (t.x > 0.0 ? t.x : t.y) : -1.0;
            c.second = met && t.x > 0.0 ? t.y : -1.0;
        } else {
            c.first = intersect_sphere(origin, direction, shape.center, shape.radius, starts_here);
            // The sum of both roots is twice the distance to the point nearest to the centre.
            if (HAS(FEATURE_ALPHA) && !starts_here)
                c.second = 2.0 * dot(shape.center - origin, direction) / dot(direction, direction) -
                           c.first;
        }
    }
    if (IS_KIND(shape.kind, SHAPE_KIND_DISC) && !starts_here)
        c.first = intersect_disc(origin, direction, shape.center, shape.axis, shape.radius);
    if (IS_KIND(shape.kind, SHAPE_KIND_PLANE) && !starts_here)
        c.first = intersect_plane(origin, direction, shape.center, shape.axis);
    if (IS_KIND(shape.kind, SHAPE_KIND_QUAD) && !starts_here)
        c.first = intersect_quad(origin, direction, shape.center, shape.axis, shape.other,
                                 c.first_at);
    if (IS_KIND(shape.kind, SHAPE_KIND_BOX))
        c = intersect_box(origin, direction, shape.center,
                          box_frame_of(shape.axis, shape.other, shape.radius), starts_here);
    if (IS_KIND(shape.kind, SHAPE_KIND_CYLINDER))
        c = intersect_cylinder(origin, direction, shape.center, shape.axis, shape.radius,
                               starts_here);
    if (IS_KIND(shape.kind, SHAPE_KIND_TUBE))
        c = intersect_tube(origin, direction, shape.center, shape.axis, shape.radius, starts_here);
    return c;
}

#endif
