// Reads textures, and applies them to a material and its shading normal.
#ifndef TEXTURE_GLSL
#define TEXTURE_GLSL

#include "lib/angle.glsl"
#include "lib/material.glsl"
#include "lib/surface.glsl"

// --- one texture ---------------------------------------------------------------------------------

struct texture_record {
    uint texels; // index of the first uvec4 with texels
    ivec2 size;
    uint flags;
    vec3 row_s, row_t;
    vec2 green; // TEXTURE_GREEN
};

texture_record load_texture(uint at)
{
    uvec4 head = load_materials(at);
    vec4 row_s = load_materials_float(at + 1u), row_t = load_materials_float(at + 2u);
    return texture_record(head.x, ivec2(head.y & 0xffffu, head.y >> 16u), head.z, row_s.xyz,
                          row_t.xyz, vec2(row_s.w, row_t.w));
}

uint texture_use(uint flags)
{
    return flags >> TEXTURE_USE_SHIFT & 3u;
}

uint texture_group(uint flags)
{
    return flags >> TEXTURE_GROUP_SHIFT & 15u;
}

// Rounds values that are 0 or at least 2^-14 to the 11 significant bits of halves. No value of a
// code is half-way between two halves.
vec4 round_to_half(vec4 x)
{
    return uintBitsToFloat((floatBitsToUint(x) + 0x1000u) & 0xffffe000u);
}

// Decodes sRGB (IEC 61966-2-1, 5.3) up to the rounding to halves, from whole codes of 8 bits. The
// polynomial is a best fit (Remez) of the halves of the codes from 11 on, with errors in units of
// the distance between halves. Before rounding, it is nearer to the code's half than to any other
// half by 2.2e-6 of its value, even if each operation is off by one ulp. So all devices get the
// bits of image_srgb_to_linear(), rounded. tests/kernels/test_texture_codes.c derives the bound.
vec3 decode_srgb(vec3 code)
{
    vec3 curve = vec3(SRGB_CURVE_7);
    curve = curve * code + SRGB_CURVE_6;
    curve = curve * code + SRGB_CURVE_5;
    curve = curve * code + SRGB_CURVE_4;
    curve = curve * code + SRGB_CURVE_3;
    curve = curve * code + SRGB_CURVE_2;
    curve = curve * code + SRGB_CURVE_1;
    curve = curve * code + SRGB_CURVE_0;
    return mix(curve, code * SRGB_TOE, lessThan(code, vec3(SRGB_CURVE_FROM)));
}

// Rounds any value in [0, 1] to a half, ties to even.
float round_any_to_half(float x)
{
    uint bits = floatBitsToUint(x);
    float coarse = uintBitsToFloat((bits + 0xfffu + (bits >> 13u & 1u)) & 0xffffe000u);
    return x < exp2(-14.0) ? roundEven(x * exp2(24.0)) * exp2(-24.0) : coarse;
}

// Returns the value of a texel's codes. On the host, texture_image.values has the same values.
vec4 decode_codes(texture_record t, uint codes)
{
    vec4 code = vec4(uvec4(codes, codes >> 8u, codes >> 16u, codes >> 24u) & 255u);
    vec4 value = code * CODE_UNIT;
    value.rgb = (t.flags & TEXTURE_SRGB) != 0u ? decode_srgb(code.rgb) : value.rgb;
    value = round_to_half(value);
    // Only iridescence has a parameter whose texture goes from a minimum to a maximum.
    if (HAS_LOBE(LOBE_IRIDESCENCE) && (t.flags & TEXTURE_GREEN) != 0u)
        value.g = round_any_to_half(t.green.x + t.green.y * value.g);
    return value;
}

// Returns the texel at `place`. A uvec4 holds four texels of codes, or one texel of floats.
vec4 load_texel(texture_record t, ivec2 place)
{
    uint index = uint(place.y) * uint(t.size.x) + uint(place.x);
    bool is_float = HAS(FEATURE_TEXELS_FLOAT) &&
                    (!HAS(FEATURE_TEXELS_CODES) || (t.flags & TEXTURE_FLOAT) != 0u);
    uvec4 word = load_texels(t.texels + (is_float ? index : index >> 2u));
    if (!HAS(FEATURE_TEXELS_CODES))
        return uintBitsToFloat(word);
    uvec2 pair = (index & 2u) != 0u ? word.zw : word.xy;
    vec4 texel = decode_codes(t, (index & 1u) != 0u ? pair.y : pair.x);
    return is_float ? uintBitsToFloat(word) : texel;
}

// Maps a coordinate into the image, [0, 1]. In single precision, x - floor(x) is exact for x >= 0,
// and has an error of at most 2^-25 for x < 0. So the accuracy is limited by the coordinate's own
// resolution: steps of 2^-4 at 1e6.
float wrap_coordinate(float x, uint mode)
{
    if (mode == TEXTURE_WRAP_CLAMP)
        return clamp(x, 0.0, 1.0);
    if (mode == TEXTURE_WRAP_MIRROR) {
        float period = x - 2.0 * floor(0.5 * x);
        return min(period, 2.0 - period);
    }
    return x - floor(x);
}

// Returns the index of the texel for a position that may be one texel outside the image.
int wrap_texel(int i, int size, uint mode)
{
    if (mode == TEXTURE_WRAP_REPEAT)
        i = i < 0 ? size - 1 : (i >= size ? 0 : i);
    return clamp(i, 0, size - 1);
}

// Interpolates bilinearly between the centres of texels, or returns the nearest texel.
vec4 filter_texture(texture_record t, vec2 uv0, vec2 uv1)
{
    vec2 uv = (t.flags & TEXTURE_UV1) != 0u ? uv1 : uv0;
    vec2 st = vec2(dot(t.row_s, vec3(uv, 1.0)), dot(t.row_t, vec3(uv, 1.0)));
    // Coordinates are finite, but their transform may overflow.
    if (!is_finite(vec3(st, 0.0)))
        st = vec2(0.0);
    uvec2 mode = uvec2(t.flags >> TEXTURE_WRAP_S_SHIFT, t.flags >> TEXTURE_WRAP_T_SHIFT) & 3u;
    vec2 place = vec2(wrap_coordinate(st.x, mode.x), wrap_coordinate(st.y, mode.y)) * vec2(t.size);
    bool nearest = (t.flags & TEXTURE_NEAREST) != 0u;
    place -= nearest ? 0.0 : 0.5;
    vec2 corner = floor(place);
    vec2 f = nearest ? vec2(0.0) : place - corner;
    ivec2 low = ivec2(corner);
    ivec2 a = ivec2(wrap_texel(low.x, t.size.x, mode.x), wrap_texel(low.y, t.size.y, mode.y));
    ivec2 b =
        ivec2(wrap_texel(low.x + 1, t.size.x, mode.x), wrap_texel(low.y + 1, t.size.y, mode.y));
    vec4 top = mix(load_texel(t, a), load_texel(t, ivec2(b.x, a.y)), f.x);
    vec4 bottom = mix(load_texel(t, ivec2(a.x, b.y)), load_texel(t, b), f.x);
    return mix(top, bottom, f.y);
}

// Returns the value of the texture with this index in the scene.
vec4 sample_texture(uint index, vec2 uv0, vec2 uv1)
{
    return filter_texture(load_texture(textures_begin() + index * TEXTURE_WORDS), uv0, uv1);
}

// --- parameters scaled by textures ---------------------------------------------------------------

float texel_channel(vec4 texel, uint channel)
{
    vec2 pair = (channel & 2u) != 0u ? texel.zw : texel.xy;
    return (channel & 1u) != 0u ? pair.y : pair.x;
}

// Scales the parameters of a group as the flags say. Texels above 1, from HDR images, count as 1,
// so that parameters stay in their ranges; only emission may be scaled up.
vec4 scale_group(vec4 group, uint flags, vec4 texel)
{
    if (HAS(FEATURE_TEXELS_FLOAT) && texture_group(flags) != GROUP_EMISSION)
        texel = min(texel, 1.0);
    for (uint i = 0u; i < 4u; i++) {
        float value = texel_channel(texel, flags >> (TEXTURE_CHANNELS_SHIFT + 2u * i) & 3u);
        bool inverted = (flags >> (TEXTURE_INVERT_SHIFT + i) & 1u) != 0u;
        float scaled = inverted ? 1.0 - (1.0 - group[i]) * value : group[i] * value;
        group[i] = (flags >> (TEXTURE_MASK_SHIFT + i) & 1u) != 0u ? scaled : group[i];
    }
    return group;
}

// Returns the orthonormal frame of a unit normal and the tangent nearest to the given one; it is
// left-handed if the bitangent's sign is negative. If the given tangent is parallel to the normal,
// up to rounding, the tangent is arbitrary. The tangent is orthogonalised twice, because a single
// step leaves an error that grows as tangent and normal get closer (Giraud, Langou, Rozloznik 2005,
// "The loss of orthogonality in the Gram-Schmidt process").
mat3 tangent_frame(vec3 n, vec4 tangent)
{
    vec3 t = tangent.xyz - dot(tangent.xyz, n) * n;
    if (dot(t, t) <= GAMMA(8) * GAMMA(8))
        return basis_around(n);
    t = normalize(t);
    t = normalize(t - dot(t, n) * n);
    return mat3(t, tangent.w * cross(n, t), n);
}

// Sets the shading normal from a tangent-space normal. A texel without a direction changes nothing.
void perturb_normal(vec4 texel, float scale, inout surface s)
{
    vec3 local = texel.xyz * 2.0 - 1.0;
    local.xy *= scale;
    vec3 turned = tangent_frame(s.normal_shading, s.tangent) * local;
    if (dot(turned, turned) > 0.0)
        s.normal_shading = normalize(turned);
}

// KHR_materials_anisotropy: red and green are the direction in (tangent, bitangent), to which the
// material's rotation is added; blue scales the strength.
void turn_anisotropy(vec4 texel, inout material m)
{
    vec2 direction = texel.xy * 2.0 - 1.0;
    material_anisotropic(m) *= texel.z;
    if (any(notEqual(direction, vec2(0.0))))
        material_anisotropic_rotation(m) += atan_turns(direction.y, direction.x);
}

// Vertex colours scale base colour and opacity; for unlit surfaces they scale the colour to show.
void apply_color(vec4 color, inout material m)
{
    bool unlit = material_has(m, MATERIAL_UNLIT);
    m.group[GROUP_BASE] *= vec4(unlit ? vec3(1.0) : color.rgb, color.a);
    if (unlit)
        material_emission(m) *= color.rgb;
}

// Groups are selected by constant indices: a variable index would place all groups in memory.
#define PICK_GROUP(number) picked = group == number ? m.group[number] : picked
#define PUT_GROUP(number) m.group[number] = group == number ? scaled : m.group[number]

void scale_material(uint flags, vec4 texel, inout material m)
{
    uint group = texture_group(flags);
    vec4 picked = m.group[GROUP_BASE];
    PICK_GROUP(GROUP_EMISSION);
    PICK_GROUP(GROUP_METAL);
    PICK_GROUP(GROUP_SPECULAR);
    PICK_GROUP(GROUP_INTERFACE);
    PICK_GROUP(GROUP_CLEARCOAT);
    PICK_GROUP(GROUP_SHEEN);
    PICK_GROUP(GROUP_DIFFUSE);
    PICK_GROUP(GROUP_FILM);
    PICK_GROUP(GROUP_CONDUCTOR);
    PICK_GROUP(GROUP_CONDUCTOR_K);
    vec4 scaled = scale_group(picked, flags, texel);
    PUT_GROUP(GROUP_BASE);
    PUT_GROUP(GROUP_EMISSION);
    PUT_GROUP(GROUP_METAL);
    PUT_GROUP(GROUP_SPECULAR);
    PUT_GROUP(GROUP_INTERFACE);
    PUT_GROUP(GROUP_CLEARCOAT);
    PUT_GROUP(GROUP_SHEEN);
    PUT_GROUP(GROUP_DIFFUSE);
    PUT_GROUP(GROUP_FILM);
    PUT_GROUP(GROUP_CONDUCTOR);
    PUT_GROUP(GROUP_CONDUCTOR_K);
}

// Applies textures and vertex colours to the material and surface at this point.
void apply_textures(inout material m, inout surface s)
{
    if (HAS(FEATURE_COLORS))
        apply_color(s.color, m);
    if (!HAS(FEATURE_TEXTURES))
        return;
    uint at = textures_begin() + m.first_texture * TEXTURE_WORDS;
    for (uint i = 0u; i < m.texture_count; i++) {
        texture_record t = load_texture(at + i * TEXTURE_WORDS);
        vec4 texel = filter_texture(t, s.uv0, s.uv1);
        uint use = texture_use(t.flags);
        if (use == TEXTURE_USE_SCALE)
            scale_material(t.flags, texel, m);
        if (HAS_LOBE(LOBE_ANISOTROPIC) && use == TEXTURE_USE_ANISOTROPY)
            turn_anisotropy(texel, m);
        if (HAS(FEATURE_NORMAL_MAPS) && use == TEXTURE_USE_NORMAL)
            perturb_normal(texel, material_normal_scale(m), s);
    }
}

// Returns a group of parameters scaled by textures, for callers that need only that group. The
// index must be a constant.
vec4 textured_group(material m, uint group, vec2 uv0, vec2 uv1)
{
    vec4 result = m.group[group];
    uint at = textures_begin() + m.first_texture * TEXTURE_WORDS;
    for (uint i = 0u; i < m.texture_count; i++) {
        texture_record t = load_texture(at + i * TEXTURE_WORDS);
        if (texture_use(t.flags) == TEXTURE_USE_SCALE && texture_group(t.flags) == group)
            result = scale_group(result, t.flags, filter_texture(t, uv0, uv1));
    }
    return result;
}

vec3 textured_emission(material m, surface s)
{
    return textured_group(m, GROUP_EMISSION, s.uv0, s.uv1).rgb;
}

// --- the shading frame ---------------------------------------------------------------------------

// Bends the shading normal so that the surface could reflect: the mirror direction r of wo must be
// on the same side of the geometric normal ng as wo. Interpolated normals and normal maps may
// violate this. Reflected light would then be lost, and a normal that faces away from wo has no
// visible hemisphere.
//
// The bent normal is the half vector of wo and of r raised to the horizon (Keller et al. 2017, "The
// Iray Light Transport Simulation and Rendering System", appendix A.3, with the projection along ng
// in place of that along the shading normal, which may be tangential). If h is a unit vector,
// dot(h, ng) = low >= 0 and dot(wo, ng) > 0, then n = normalize(wo + h) has
//   dot(n, wo) = (1 + dot(h, wo)) / |wo + h| > 0, since h = -wo would be below the surface;
//   dot(n, ng) = (low + dot(wo, ng)) / |wo + h| > 0;
//   and its mirror direction is h, which is above the surface.
// This holds in single precision, too: an error e of the sum turns n by e / |wo + h| and its mirror
// direction by twice that, where |wo + h| >= dot(wo + h, ng) >= 2 low. So low^2 = e is sufficient,
// and e is less than 32 roundings. `low` is never greater than for the mirror direction of ng
// itself (as in Cycles' ensure_valid_specular_reflection()), so ng is never bent.
// No energy is gained: BSDFs reflect at most 1 about any normal that faces wo, and directions below
// the surface are rejected.
vec3 bend_normal(vec3 ns, vec3 ng, vec3 wo)
{
    float low = sqrt(GAMMA(32));
    float cos_o = dot(wo, ng);
    vec3 r = 2.0 * dot(wo, ns) * ns - wo;
    float height = dot(r, ng);
    if (height >= min(low, cos_o))
        return dot(wo, ns) < 0.0 ? -ns : ns;
    vec3 along = r - height * ng;
    if (cos_o <= low || !(dot(along, along) > 0.0))
        return ng;
    return normalize(wo + normalize(normalize(along) + low * ng));
}

// Returns tangent, bitangent and shading normal: orthonormal, and left-handed if the bitangent's
// sign is negative. `wo` points to the viewer. Lambertian surfaces keep their normal, because they
// reflect equally in all directions.
mat3 shading_frame(surface s, material m, vec3 wo)
{
    vec3 n = s.normal_shading;
    if ((HAS(FEATURE_NORMALS) || HAS(FEATURE_NORMAL_MAPS)) &&
        material_model(m) != MATERIAL_LAMBERT)
        n = bend_normal(n, s.normal_geometric, wo);
    // Applied only if needed, so that other surfaces keep their bits.
    bool turned = material_model(m) == MATERIAL_PRINCIPLED && material_anisotropic(m) > 0.0;
    if (HAS_LOBE(LOBE_ANISOTROPIC) && turned)
        return tangent_frame(n, s.tangent);
    return basis_around(n);
}

#endif
