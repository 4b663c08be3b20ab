// Runs the shipped routines of lib/texture, lib/alpha and lib/surface on inputs that the test wrote
// into the paths' buffer: four uvec4 words for each thread, which are overwritten by what comes
// out; see texture_item.h. Which routine is a specialization constant.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "lib/alpha.glsl"
#include "texture_item.h"

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

void sample_one(uint item)
{
    vec4 uv = load_input_float(item, 1u);
    store_output(item, 0u, sample_texture(load_input(item, 0u).x, uv.xy, uv.zw));
}

void apply(uint item)
{
    material m = load_material(load_input(item, 0u).x);
    surface s;
    vec4 uv = load_input_float(item, 1u);
    s.uv0 = uv.xy;
    s.uv1 = uv.zw;
    s.normal_shading = load_input_float(item, 2u).xyz;
    s.tangent = load_input_float(item, 3u);
    s.color = vec4(0.5, 0.25, 0.125, 0.75);
    apply_textures(m, s);
    store_output(item, 0u, m.group[GROUP_BASE]);
    store_output(item, 1u, m.group[GROUP_METAL]);
    store_output(item, 2u, m.group[GROUP_EMISSION]);
    store_output(item, 3u, vec4(s.normal_shading, 0.0));
}

void axes(uint item)
{
    surface s;
    s.normal_shading = load_input_float(item, 1u).xyz;
    s.normal_geometric = load_input_float(item, 2u).xyz;
    vec4 wo = load_input_float(item, 3u);
    s.tangent = vec4(1.0, 0.0, 0.0, wo.w);
    mat3 f = shading_frame(s, load_material(load_input(item, 0u).x), wo.xyz);
    for (uint i = 0u; i < 3u; i++)
        store_output(item, i, vec4(f[i], 0.0));
}

void alpha(uint item)
{
    uvec4 head = load_input(item, 0u);
    vec4 place = load_input_float(item, 1u);
    uvec4 path = load_input(item, 2u);
    uint word = floatBitsToUint(place.w);
    vec2 b = uintBitsToFloat(head.yz);
    uvec4 key = alpha_key(path.w, path.x, path.y, path.z >> 1u, (path.z & 1u) != 0u);
    bool there = alpha_passes(head.x, b, place.xyz, word, head.w, key);
    store_output(item, 0u, vec4(alpha_at(head.x, b, place.xyz, word), there ? 1.0 : 0.0,
                                alpha_probability(head.x, b, place.xyz, word), 0.0));
}

void load_one_surface(uint item)
{
    vec4 from = load_input_float(item, 0u);
    vec4 towards = load_input_float(item, 1u);
    vec2 b = load_input_float(item, 2u).xy;
    surface s = load_surface(from.xyz, towards.xyz, towards.w, b, floatBitsToUint(from.w),
                             NO_INSTANCE);
    store_output(item, 0u, vec4(s.uv0, s.uv1));
    store_output(item, 1u, s.tangent);
    store_output(item, 2u, s.color);
    store_output(item, 3u, vec4(s.normal_shading, s.front ? 1.0 : 0.0));
}

void main()
{
    uint item = push.first_item + gl_GlobalInvocationID.x;
    if (item >= push.part_items)
        return;
    if (ROUTINE == ROUTINE_SAMPLE)
        sample_one(item);
    if (ROUTINE == ROUTINE_APPLY)
        apply(item);
    if (ROUTINE == ROUTINE_FRAME)
        axes(item);
    if (ROUTINE == ROUTINE_ALPHA)
        alpha(item);
    if (ROUTINE == ROUTINE_SURFACE)
        load_one_surface(item);
}
