// Decides by opacity whether a surface exists at the point where a ray hits it. Reads materials,
// vertex attributes and textures.
#ifndef ALPHA_GLSL
#define ALPHA_GLSL

#include "lib/random.glsl"
#include "lib/texture.glsl"

// Returns the opacity at the point where a ray hits a primitive, from its material, textures and
// vertex colours. The point on a triangle is given by the barycentric coordinates of corners 1 and
// 2; a point on a shape by `point`, with the data of struct crossings in place of the barycentrics.
float alpha_at(uint primitive, vec2 barycentrics, vec3 point, uint material_word)
{
    surface s;
    s.uv0 = s.uv1 = vec2(0.0);
    s.color = vec4(1.0);
    bool is_shape = IS_SHAPE(primitive);
    if (HAS(FEATURE_TRIANGLES) && !is_shape)
        load_corner_attributes(primitive, barycentrics, s);
    if (HAS(FEATURE_TEXTURES) && is_shape)
        s = load_shape_surface(primitive & ~PRIMITIVE_SHAPE, point, barycentrics);

    uint at = material_at(material_word);
    uvec4 head = load_materials(at);
    float alpha = load_materials_float(at + 1u + GROUP_BASE).a;
    if (HAS(FEATURE_COLORS))
        alpha *= s.color.a;
    if (!HAS(FEATURE_TEXTURES))
        return alpha;
    uint textures = textures_begin() + head.y * TEXTURE_WORDS;
    const uint scales_alpha = 1u << (TEXTURE_MASK_SHIFT + PARAMETER_OPACITY);
    for (uint i = 0u; i < head.z; i++) {
        texture_record t = load_texture(textures + i * TEXTURE_WORDS);
        if (texture_use(t.flags) == TEXTURE_USE_SCALE && texture_group(t.flags) == GROUP_BASE &&
            (t.flags & scales_alpha) != 0u)
            alpha = scale_group(vec4(alpha), t.flags, filter_texture(t, s.uv0, s.uv1)).a;
    }
    return alpha;
}

// Returns the probability that the surface exists: its opacity or, with an alpha mask, 0 or 1.
float alpha_probability(uint primitive, vec2 barycentrics, vec3 point, uint material_word)
{
    uint at = material_at(material_word);
    float alpha = alpha_at(primitive, barycentrics, point, material_word);
    float cutoff = load_materials_float(at + 1u + GROUP_CONDUCTOR_K).a;
    bool is_masked = (load_materials(at).x & MATERIAL_ALPHA_MASK) != 0u;
    return is_masked ? (alpha >= cutoff ? 1.0 : 0.0) : alpha;
}

// Returns the part of the hash key that all decisions along one ray share. is_shadow distinguishes
// the shadow rays of a bounce from its scattered ray.
uvec4 alpha_key(uint seed, uint pixel, uint sample_index, uint bounce, bool is_shadow)
{
    const uint apart = 0x80000000u; // makes the key differ from all keys of random_4d()
    return pcg4d(uvec4(pixel, sample_index, apart | bounce << 1u | (is_shadow ? 1u : 0u), seed));
}

// Returns whether the surface exists for this ray. `crossing` identifies the decision: it is the
// primitive's id, or another number where the ray hits the same sphere a second time. The function
// is pure, so the order in which a traversal finds surfaces does not matter.
bool alpha_passes(uint primitive, vec2 barycentrics, vec3 point, uint material_word, uint crossing,
                  uvec4 key)
{
    // pcg4d() hardly mixes differences in the highest bits, so the high bits of `crossing` are also
    // added to a lower component.
    uint bits = pcg4d(key + uvec4(0u, 0u, crossing >> 16u, crossing)).x >> 8u;
    return float(bits) * 5.9604644775390625e-8 <
           alpha_probability(primitive, barycentrics, point, material_word);
}

#endif
