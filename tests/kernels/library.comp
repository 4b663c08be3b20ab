// Runs the shipped routines of lib/ on inputs that the test wrote into the paths' buffer: four
// uvec4 words for each thread, which are overwritten by what comes out. Which routine is a
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
    surface s = load_triangle_surface(item, uv, NO_INSTANCE);
    store_output(item, 0u, vec4(s.position, 0.0));
    store_output(item, 1u, vec4(s.error, 0.0));
    store_output(item, 2u, vec4(offset_origin(s.position, s.error, s.normal_geometric, side), 0.0));
}

// Word 0: position, and whether light from behind counts; word 1: normal; word 2: uniforms, or the
// number of an emitter.
void tree(uint item)
{
    vec4 place = load_input_float(item, 0u);
    receiver r = receiver(place.xyz, load_input_float(item, 1u).xyz, place.w != 0.0);
    uvec4 last = load_input(item, 2u);
    float probability;
    if (ROUTINE == ROUTINE_TREE_CHOICE) {
        uint primitive = choose_from_tree(r, uintBitsToFloat(last.xy), probability);
        paths_words[item * PATH_WORDS + 3u] = uvec4(primitive, floatBitsToUint(probability), 0u, 0u);
    }
    if (ROUTINE == ROUTINE_TREE_SAMPLE) {
        light_sample l = sample_light(r, uintBitsToFloat(last));
        store_output(item, 3u, vec4(l.pdf, l.barycentrics, length(l.to_light)));
    }
    if (ROUTINE == ROUTINE_TREE_PROBABILITY)
        store_output(item, 3u, vec4(probability_in_tree(r, last.x), vec3(0.0)));
}

// Samples the environment, and evaluates it in a direction.
void surroundings(uint item)
{
    vec4 u = load_input_float(item, 0u);
    if (ROUTINE == ROUTINE_SAMPLE_ENVIRONMENT) {
        vec3 direction, radiance;
        float pdf = sample_environment(u.xy, u.zw, direction, radiance);
        store_output(item, 0u, vec4(direction, pdf));
        store_output(item, 1u, vec4(radiance, load_environment_at(direction).a));
    }
    if (ROUTINE == ROUTINE_SEE_ENVIRONMENT)
        store_output(item, 0u, vec4(environment_radiance(u.xyz), load_environment_at(u.xyz).a));
    if (ROUTINE == ROUTINE_ANGLES)
        store_output(item, 0u, vec4(atan_turns(u.y, u.x), cos_sin_turns(u.z), 0.0));
    if (ROUTINE == ROUTINE_SUN) {
        vec3 direction;
        float pdf = sample_sun(u.xyz, u.w, load_input_float(item, 1u).xy, direction);
        store_output(item, 0u, vec4(direction, pdf));
        store_output(item, 1u, vec4(sees_sun(u.xyz, u.w, direction)));
    }
}

// Word 0: a point of the field's own space and the field's number; or of the world, and the shape's.
void distance_field(uint item)
{
    vec3 point = load_input_float(item, 0u).xyz;
    uint number = load_input(item, 0u).w;
    if (ROUTINE == ROUTINE_SDF_VALUE) {
        sdf_field f = load_sdf(number);
        store_output(item, 0u, vec4(sdf_value(f.first, f.count, point), sdf_error(f), 0.0, 0.0));
    }
    if (ROUTINE == ROUTINE_SDF_SURFACE) {
        vec3 side = load_input_float(item, 1u).xyz;
        surface s;
        load_sdf_surface(number, point, s);
        store_output(item, 0u, vec4(s.position, 0.0));
        store_output(item, 1u, vec4(s.error, 0.0));
        store_output(item, 2u, vec4(s.normal_geometric, 0.0));
        store_output(item, 3u,
                     vec4(offset_origin(s.position, s.error, s.normal_geometric, side), 0.0));
    }
}

// Words 0 to 2: a triangle's corner and edges, seen from the origin; word 3: uniforms.
void see_triangle(uint item)
{
    seen_triangle seen =
        see_triangle(vec3(0.0), load_input_float(item, 0u).xyz, load_input_float(item, 1u).xyz,
                     load_input_float(item, 2u).xyz);
    vec2 b = sample_seen_triangle(seen, load_input_float(item, 3u).xy);
    store_output(item, 0u, vec4(b, seen.solid_angle, solid_angle_of(seen)));
}

void main()
{
    uint item = push.first_item + gl_GlobalInvocationID.x;
    if (item >= push.part_items)
        return;
    warp(item);
    surroundings(item);
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
    if (ROUTINE == ROUTINE_SEE_TRIANGLE)
        see_triangle(item);
    tree(item);
    distance_field(item);
    if (ROUTINE == ROUTINE_PICK_LIGHT) {
        light_sample l = sample_light(receiver(vec3(0.0), vec3(0.0), true), load_input_float(item, 0u));
        paths_words[item * PATH_WORDS] = uvec4(l.primitive);
    }
}
