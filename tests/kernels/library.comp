// Runs the shipped routines of lib/ on inputs that the test wrote into the paths' buffer: four
// words of four for each thread, which are overwritten by what comes out. Which routine is a
// specialization constant.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "lib/light.glsl"
#include "lib/ray_offset.glsl"
#include "routines.h"

layout(constant_id = CONSTANT_ROUTINE) const uint ROUTINE = 0u;

uvec4 load_input(uint item, uint word)
{
    return paths_words[item * PATH_WORDS + word];
}

vec4 load_input_float(uint item, uint word)
{
    return uintBitsToFloat(load_input(item, word));
}

void store_output(uint item, uint word, vec4 value)
{
    paths_words[item * PATH_WORDS + word] = floatBitsToUint(value);
}

void warp(uint item)
{
    vec2 u = load_input_float(item, 0u).xy;
    if (ROUTINE == ROUTINE_COSINE_HEMISPHERE) {
        vec3 d = sample_cosine_hemisphere(u);
        store_output(item, 0u, vec4(d, pdf_cosine_hemisphere(d.z)));
    }
    if (ROUTINE == ROUTINE_SPHERE)
        store_output(item, 0u, vec4(sample_sphere(u), 0.0));
    if (ROUTINE == ROUTINE_DISC)
        store_output(item, 0u, vec4(sample_disc(u), 0.0, 0.0));
    if (ROUTINE == ROUTINE_TRIANGLE)
        store_output(item, 0u, vec4(sample_triangle(u), 0.0, 0.0));
}

void basis(uint item)
{
    mat3 b = basis_around(load_input_float(item, 0u).xyz);
    for (int i = 0; i < 3; i++)
        store_output(item, uint(i), vec4(b[i], 0.0));
}

void offset(uint item)
{
    vec3 point = load_input_float(item, 0u).xyz;
    vec3 error = load_input_float(item, 1u).xyz;
    vec3 normal = load_input_float(item, 2u).xyz;
    vec3 side = load_input_float(item, 3u).xyz;
    store_output(item, 0u, vec4(offset_origin(point, error, normal, side), 0.0));
}

// A point of triangle number `item`, and the origin of a ray that leaves it.
void leave_triangle(uint item)
{
    vec2 uv = load_input_float(item, 0u).xy;
    vec3 side = load_input_float(item, 1u).xyz;
    surface s = load_triangle_surface(item, uv);
    store_output(item, 0u, vec4(s.position, 0.0));
    store_output(item, 1u, vec4(s.error, 0.0));
    store_output(item, 2u, vec4(offset_origin(s.position, s.error, s.normal_geometric, side), 0.0));
}

void main()
{
    uint item = push.first_item + gl_GlobalInvocationID.x;
    if (item >= push.part_items)
        return;
    warp(item);
    if (ROUTINE == ROUTINE_BASIS)
        basis(item);
    if (ROUTINE == ROUTINE_OFFSET)
        offset(item);
    if (ROUTINE == ROUTINE_LEAVE_TRIANGLE)
        leave_triangle(item);
    if (ROUTINE == ROUTINE_DECODE_NORMAL)
        store_output(item, 0u, vec4(decode_normal(load_input(item, 0u).x), 0.0));
    if (ROUTINE == ROUTINE_IS_FINITE)
        store_output(item, 0u, vec4(is_finite(load_input_float(item, 0u).xyz) ? 1.0 : 0.0));
    if (ROUTINE == ROUTINE_PICK_LIGHT) {
        light_sample l = sample_light(vec3(0.0), load_input_float(item, 0u));
        paths_words[item * PATH_WORDS] = uvec4(l.primitive);
    }
}
