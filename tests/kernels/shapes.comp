// Runs what kernels do with analytic shapes, of items of four uvec4 words that the test wrote into
// the paths' buffer and that are overwritten by what comes out.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "lib/light.glsl"
#include "lib/ray_offset.glsl"
#include "shape_routines.h"

layout(constant_id = CONSTANT_ROUTINE) const uint ROUTINE = 0u;

vec4 load_input(uint item, uint word)
{
    return uintBitsToFloat(paths_words[item * PATH_WORDS + word]);
}

void store_output(uint item, uint word, vec4 value)
{
    paths_words[item * PATH_WORDS + word] = floatBitsToUint(value);
}

// Word 0: a ray's origin, a shape's number; word 1: the ray's direction; word 2: that of a ray that
// leaves from where it meets the shape. Out: where, and t; the error, and the other ray's t; the
// normal outwards, what a hit record keeps; the other ray's origin.
void leave(uint item)
{
    vec4 origin = load_input(item, 0u);
    vec3 direction = load_input(item, 1u).xyz;
    vec3 next = load_input(item, 2u).xyz;
    uint index = floatBitsToUint(origin.w);
    shape_record shape = load_shape(index);
    crossings c = cross_shape(origin.xyz, direction, shape, false);
    surface s = load_shape_surface(index, origin.xyz + c.first * direction, c.first_at);
    vec3 from = offset_origin(s.position, s.error, s.normal_geometric, next);
    crossings again = cross_shape(from, next, shape, true);
    store_output(item, 0u, vec4(s.position, c.first));
    store_output(item, 1u, vec4(s.error, again.first));
    store_output(item, 2u, vec4(s.normal_geometric, c.first_at.x));
    store_output(item, 3u, vec4(from, c.second));
}

// Word 0: a point, a shape's number; word 1: uniforms. Out: to the sampled point, density; its normal
// outwards, and what a hit record would keep; the density for a hit.
void aim(uint item)
{
    vec4 origin = load_input(item, 0u);
    uint index = floatBitsToUint(origin.w);
    vec4 u = load_input(item, 1u);
    light_sample l;
    l.primitive = PRIMITIVE_SHAPE | index;
    l.to_light = vec3(0.0);
    l.pdf = 0.0;
    l.barycentrics = vec2(0.0);
    float pick = LIGHT_CHOICE == LIGHT_CHOICE_ALL ? 1.0 : 1.0 / float(frame.emitter_count);
    sample_shape_light(origin.xyz, index, pick, u.xy, l);
    vec3 wi = normalize(l.to_light);
    surface s = load_shape_surface(index, origin.xyz + l.to_light, l.barycentrics);
    float density =
        pick_density_at(load_material(s.material), l.primitive, origin.xyz, wi, 0u, NO_INSTANCE);
    store_output(item, 0u, vec4(l.to_light, l.pdf));
    store_output(item, 1u, vec4(s.normal_geometric, l.barycentrics.x));
    store_output(item, 2u, vec4(pdf_light(origin.xyz, wi, length(l.to_light), s, l.primitive, density),
                                s.uv0, s.radius));
}

void main()
{
    uint item = push.first_item + gl_GlobalInvocationID.x;
    if (item >= push.part_items)
        return;
    if (ROUTINE == ROUTINE_LEAVE_SHAPE)
        leave(item);
    if (ROUTINE == ROUTINE_AIM_AT_SHAPE)
        aim(item);
}
