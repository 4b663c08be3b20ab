// Reads textures: what they make of a material and of its shading normal.
#ifndef TEXTURE_GLSL
#define TEXTURE_GLSL

#include "lib/angle.glsl"
#include "lib/material.glsl"
#include "lib/surface.glsl"

// --- one texture ---------------------------------------------------------------------------------

struct texture_record {
    uint texels; // word of four
    ivec2 size;
    uint flags;
    vec3 row_s, row_t;
};

texture_record load_texture(uint at)
{
    uvec4 head = load_materials(at);
    return texture_record(head.x, ivec2(head.y & 0xffffu, head.y >> 16u), head.z,
                          load_materials_float(at + 1u).xyz, load_materials_float(at + 2u).xyz);
}

uint texture_use(uint flags)
{
    return flags >> TEXTURE_USE_SHIFT & 3u;
}

uint texture_group(uint flags)
{
    return flags >> TEXTURE_GROUP_SHIFT & 15u;
}

// Two texels of halves, or one of floats, are a word of four.
vec4 load_texel(texture_record t, ivec2 place)
{
    uint index = uint(place.y) * uint(t.size.x) + uint(place.x);
    bool is_float = HAS(FEATURE_TEXELS_FLOAT) &&
                    (!HAS(FEATURE_TEXELS_HALF) || (t.flags & TEXTURE_FLOAT) != 0u);
    uvec4 word = load_texels(t.texels + (is_float ? index : index >> 1u));
    if (!HAS(FEATURE_TEXELS_HALF))
        return uintBitsToFloat(word);
    uvec2 halves = (index & 1u) != 0u ? word.zw : word.xy;
    vec4 texel = vec4(unpackHalf2x16(halves.x), unpackHalf2x16(halves.y));
    return is_float ? uintBitsToFloat(word) : texel;
}

// A coordinate to where it lies in the picture, [0, 1]. x - floor(x) is exact in single precision
// for x >= 0 and off by at most 2^-25 below, so that what counts is how finely the coordinate
// itself is resolved: in steps of 2^-4 at 1e6.
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

// The texel beside the picture's edge, of a place at most one beyond it.
int wrap_texel(int i, int size, uint mode)
{
    if (mode == TEXTURE_WRAP_REPEAT)
        i = i < 0 ? size - 1 : (i >= size ? 0 : i);
    return clamp(i, 0, size - 1);
}

// Bilinear between the centres of texels, or the texel that contains the place.
vec4 filter_texture(texture_record t, vec2 uv0, vec2 uv1)
{
    vec2 uv = (t.flags & TEXTURE_UV1) != 0u ? uv1 : uv0;
    vec2 st = vec2(dot(t.row_s, vec3(uv, 1.0)), dot(t.row_t, vec3(uv, 1.0)));
    // Coordinates are finite, but a transform may overflow.
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

// Texture number `index` of the scene.
vec4 sample_texture(uint index, vec2 uv0, vec2 uv1)
{
    return filter_texture(load_texture(textures_begin() + index * TEXTURE_WORDS), uv0, uv1);
}

// --- scaling parameters by texels ----------------------------------------------------------------

float texel_channel(vec4 texel, uint channel)
{
    vec2 pair = (channel & 2u) != 0u ? texel.zw : texel.xy;
    return (channel & 1u) != 0u ? pair.y : pair.x;
}

// The parameters of a group, scaled as the flags say. Emission may be scaled up; all else would
// leave its range, so that values of HDR pictures above 1 count as 1.
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

// The orthonormal frame of a unit normal and the tangent nearest to the given one; left-handed
// where the bitangent's sign is negative. Any tangent where the given one is along the normal, as
// far as rounding can tell. Orthogonalised twice: once leaves an error that grows as the two get
// closer (Giraud, Langou, Rozloznik 2005, "The loss of orthogonality in the Gram-Schmidt process").
mat3 tangent_frame(vec3 n, vec4 tangent)
{
    vec3 t = tangent.xyz - dot(tangent.xyz, n) * n;
    if (dot(t, t) <= GAMMA(8) * GAMMA(8))
        return basis_around(n);
    t = normalize(t);
    t = normalize(t - dot(t, n) * n);
    return mat3(t, tangent.w * cross(n, t), n);
}

// A tangent-space normal about the shading normal. One that says nothing leaves it.
void perturb_normal(vec4 texel, float scale, inout surface s)
{
    vec3 local = texel.xyz * 2.0 - 1.0;
    local.xy *= scale;
    vec3 turned = tangent_frame(s.normal_shading, s.tangent) * local;
    if (dot(turned, turned) > 0.0)
        s.normal_shading = normalize(turned);
}

// KHR_materials_anisotropy: red and green are the direction in (tangent, bitangent), which the
// rotation turns further; blue scales the strength.
void turn_anisotropy(vec4 texel, inout material m)
{
    vec2 direction = texel.xy * 2.0 - 1.0;
    material_anisotropic(m) *= texel.z;
    if (any(notEqual(direction, vec2(0.0))))
        material_anisotropic_rotation(m) += atan_turns(direction.y, direction.x);
}

// Vertex colours scale base colour and opacity; of unlit surfaces what they show.
void apply_color(vec4 color, inout material m)
{
    bool unlit = material_has(m, MATERIAL_UNLIT);
    m.group[GROUP_BASE] *= vec4(unlit ? vec3(1.0) : color.rgb, color.a);
    if (unlit)
        material_emission(m) *= color.rgb;
}

// Groups are selected by constant numbers, because a variable index would put all groups into
// memory.
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

// Makes of a material and its surface what textures and colours say at this point.
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

// A group of parameters as textures leave it, where no more of the material is asked for. The
// number is to be a constant.
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

// The shading normal, bent to where the surface could reflect: its mirror direction r of wo lies on
// the side of the geometric normal ng that wo is on, which normals of maps and interpolated ones
// may miss. Otherwise what is reflected is lost, and a normal that faces away has no hemisphere at
// all.
//
// The bent normal is the half vector of wo and of r pulled up to the horizon (Keller et al. 2017,
// "The Iray Light Transport Simulation and Rendering System", appendix A.3, with the projection
// along ng in place of that along the shading normal, which may be tangential). With h unit,
// dot(h, ng) = low >= 0 and dot(wo, ng) > 0, n = normalize(wo + h) has
//   dot(n, wo) = (1 + dot(h, wo)) / |wo + h| > 0, since h = -wo would be below the surface;
//   dot(n, ng) = (low + dot(wo, ng)) / |wo + h| > 0;
//   and h for its mirror direction, above the surface.
// In single precision, too: an error e of the sum turns n by e / |wo + h| and its mirror direction
// by twice that, where |wo + h| >= dot(wo + h, ng) >= 2 low; so low^2 = e is enough, and e is less
// than 32 roundings. Never is more asked for than the mirror direction of ng itself has (as in
// Cycles' ensure_valid_specular_reflection()), so that ng is never bent, and is the answer for a
// viewer that is as low as that.
// No energy is made: BSDFs reflect at most 1 about any normal that faces wo, and directions below
// the surface are refused.
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

// Tangent, bitangent and shading normal: orthonormal, and left-handed where the bitangent's sign is
// negative. `wo` points to the viewer. Lambert surfaces keep their normal: they reflect alike to
// all sides.
mat3 shading_frame(surface s, material m, vec3 wo)
{
    vec3 n = s.normal_shading;
    if ((HAS(FEATURE_NORMALS) || HAS(FEATURE_NORMAL_MAPS)) &&
        material_model(m) != MATERIAL_LAMBERT)
        n = bend_normal(n, s.normal_geometric, wo);
    // Only where it matters, so that leaving it out changes no bit elsewhere.
    bool turned = material_model(m) == MATERIAL_PRINCIPLED && material_anisotropic(m) > 0.0;
    if (HAS_LOBE(LOBE_ANISOTROPIC) && turned)
        return tangent_frame(n, s.tangent);
    return basis_around(n);
}

#endif
