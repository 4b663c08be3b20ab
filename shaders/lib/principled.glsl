// Computes the parts of the principled model that depend only on the material and on wo: the
// weights of the layers and the probabilities of the lobes. Symbols in comments, such as E_d, S and
// C, are those of docs/materials.md. Only lib/bsdf_principled.glsl includes this file.
#ifndef PRINCIPLED_GLSL
#define PRINCIPLED_GLSL

#include "lib/albedo.glsl"
#include "lib/bsdf_dielectric.glsl"
#include "lib/fresnel.glsl"
#include "lib/microfacet.glsl"

struct principled {
    // The base:
    vec3 base_color;
    float roughness;
    vec2 alpha;
    vec2 turn; // cosine and sine of the tangent's rotation
    float eta; // 1 if the indices match
    float metallic;
    float transmission; // multiplied by 1 - metallic
    vec3 f0;            // reflectance of the dielectric at normal incidence
    float f0_index;     // reflectance at normal incidence that follows from eta
    float specular_weight;
    bool is_mixed; // mixes Fresnel's equations and Schlick's approximation, times the specular
                   // colour
    vec3 specular_scale; // the specular colour
    vec3 f0_metal;       // f0 of the metal's Schlick reflectance
    float film; // iridescence; 0 if the film's index is below that of the medium in front
    float film_index;
    float film_thickness;
    vec3 compensation; // M
    vec3 through_compensation; // M_t
    bool tries_again;          // samples of the base are tried again if another microfacet shadows
                               // them
    float tries_scale;         // factor on the base's density due to the tries
    float reflects_more;       // the reflected fraction of the light that Fresnel's equations
                               // transmit
    vec3 tint;         // tint of transmitted light
    bool is_delta;
    bool thin;
    bool separable;
    bool is_gltf; // layers are combined as in glTF's appendix B, not as by Burley
    // The diffuse part, and its weights.
    vec3 below; // (1 - metallic) (1 - transmission) K
    vec3 sheen;
    float sheen_layer; // B
    float subsurface;
    float diffuse_transmission;
    float albedo_diffuse; // E_d(wo)
    // The layers above.
    vec3 fibre_color;
    float fibre_roughness;
    float fibre_albedo; // E_charlie(wo)
    float fibre_layer;  // fraction that the layer above the fibres transmits: 1, or C
    float coat;
    float coat_alpha; // alpha of D
    bool coat_ggx;
    bool coat_delta;
    bool coat_exact;
    float coat_layer; // fraction that the layer above the coat transmits: S, or 1
    float base_layer; // S C
    // The probabilities of selecting the lobes.
    float p_fibre, p_coat, p_base, p_diffuse, p_through;
    uint tables;
};

float max_channel(vec3 v)
{
    return max(v.r, max(v.g, v.b));
}

float mean_channel(vec3 v)
{
    return (v.r + v.g + v.b) * (1.0 / 3.0);
}

// Transforms a direction into the frame of the rotated tangent, or with `back` out of it.
vec3 principled_turn(principled p, vec3 w, bool back)
{
    if (!HAS_LOBE(LOBE_ANISOTROPIC))
        return w;
    float s = back ? -p.turn.y : p.turn.y;
    return vec3(p.turn.x * w.x + s * w.y, p.turn.x * w.y - s * w.x, w.z);
}

vec3 burley_tint(vec3 base_color)
{
    float luminance = dot(base_color, vec3(0.2126, 0.7152, 0.0722));
    return luminance > 0.0 ? base_color / luminance : vec3(1.0);
}

bool principled_is_gltf(material m)
{
    return HAS_LOBE(LOBE_GLTF) && (!HAS_LOBE(LOBE_BURLEY) || material_has(m, MATERIAL_GLTF_LAYERS));
}

// Returns E_d for base colour 1.
float principled_albedo_diffuse(principled p, float mu)
{
    float albedo = 1.0;
    if (HAS_LOBE(LOBE_BURLEY) && !p.is_gltf)
        albedo = albedo_burley(mu, p.roughness);
    if (HAS_LOBE(LOBE_SUBSURFACE)) {
        vec4 e = albedo_diffuse(p.tables, mu);
        float below = e.x + p.roughness * (e.y + p.roughness * e.z);
        albedo += p.subsurface * (below - albedo);
    }
    return albedo;
}

// Returns `reflectance`, of a surface with reflectance f0 at normal incidence, as changed by the
// film. The film is on the side with the lower index; seen from the other side, the reflectance is
// that of the refracted direction.
vec3 principled_film(principled p, float cos_o, float cos_t, vec3 f0, vec3 reflectance,
                     bool highest)
{
    if (!HAS_LOBE(LOBE_IRIDESCENCE) || !(p.film > 0.0))
        return reflectance;
    vec3 film = fresnel_film(p.eta < 1.0 ? cos_t : cos_o, p.film_index, index_of_f0(f0),
                             p.film_thickness, highest);
    return reflectance + p.film * (film - reflectance);
}

// Returns F_w; `exact` is the Fresnel reflectance for eta.
vec3 principled_dielectric(principled p, float cos_o, float exact, float cos_t, bool highest)
{
    precise vec3 f = exact + (p.f0 - p.f0_index) * ((1.0 - exact) / (1.0 - p.f0_index));
    if (HAS_LOBE(LOBE_MIXED_FRESNEL) && p.is_mixed)
        f = p.specular_scale * exact;
    return principled_film(p, cos_o, cos_t, p.f0, clamp(f, 0.0, 1.0), highest);
}

// Returns R_metal at normal incidence.
vec3 principled_reflects(principled p)
{
    return HAS_LOBE(LOBE_MIXED_FRESNEL) && p.is_mixed ? p.specular_scale * p.f0_metal
                                                      : p.base_color;
}

// Returns R_metal without compensation, from Schlick's reflectance or its mean.
vec3 principled_metal(principled p, float cos_o, float cos_t, vec3 schlick)
{
    if (HAS_LOBE(LOBE_MIXED_FRESNEL) && p.is_mixed)
        schlick *= p.specular_scale;
    return principled_film(p, cos_o, cos_t, principled_reflects(p), schlick, false);
}

vec3 principled_f0_metal(principled p)
{
    return HAS_LOBE(LOBE_MIXED_FRESNEL) && p.is_mixed ? p.f0_metal : p.base_color;
}

bool principled_tries_again(principled p)
{
    if (NORMALS == NORMALS_NDF) // the tables have the probability of survival only for visible
                                // normals
        return false;
    return HAS_LOBE(LOBE_TRANSMISSION) && HAS_LOBE(LOBE_COMPENSATE) && HAS_LOBE(LOBE_ROUGH) &&
           p.tries_again;
}

// Returns the part of a reflectance or an albedo that is missing below the interface: in glTF the
// greatest channel, so that coloured reflection leaves white light (KHR_materials_specular).
vec3 principled_whitened(principled p, vec3 reflected)
{
    return p.is_gltf ? vec3(max_channel(reflected)) : reflected;
}

// Returns the reflectance and the transmittance of the base's interface at a microfacet: R, and (1
// - metallic) transmission tint (1 - F_t); and the probabilities of sampling either. Arguments are
// cos_o = wo.h, the cosine of the refracted direction, and the Fresnel reflectance. Neither result
// is computed as one minus the other, which would cancel if it is small.
//
// Here and in lib/bsdf_principled.glsl all values that are stored or returned are `precise`.
// Otherwise a compiler could regroup sums and products, and round them differently depending on
// which lobes exist.
void principled_interface(principled p, float cos_o, float cos_t, float exact,
                          out precise vec3 reflected, out vec3 through,
                          out precise vec2 probabilities)
{
    bool total = p.eta < 1.0 && cos_t <= 0.0;
    precise vec3 f = principled_dielectric(p, cos_o, exact, cos_t, false);
    f = total ? vec3(1.0) : p.specular_weight * f;
    reflected = (1.0 - p.metallic) * f;
    through = vec3(0.0);
    vec3 f_t = HAS_LOBE(LOBE_TRANSMISSION) && p.thin ? 2.0 * f / (1.0 + f) : f;
    if (HAS_LOBE(LOBE_TRANSMISSION)) {
        reflected += p.transmission * (p.through_compensation * f_t - f);
        through = p.transmission * p.tint * p.through_compensation *
                  (1.0 - principled_whitened(p, f_t));
    }
    if (HAS_LOBE(LOBE_METAL)) {
        vec3 metal = fresnel_schlick(principled_f0_metal(p), cos_o);
        metal = principled_metal(p, cos_o, cos_t, metal);
        reflected += p.metallic * p.compensation * metal;
    }
    probabilities = vec2(1.0, 0.0);
    if (!HAS_LOBE(LOBE_TRANSMISSION))
        return;
    float r = reflected.r + reflected.g + reflected.b;
    float t = through.r + through.g + through.b;
    if (principled_tries_again(p)) {
        float rest = mean_channel(1.0 - f_t);
        probabilities = vec2(mean_channel(f_t) + p.reflects_more * rest,
                             rest - p.reflects_more * rest);
    } else if (t > 0.0) {
        probabilities = vec2(r, t) / (r + t);
    }
}

// --- layers and lobes ----------------------------------------------------------------------------

void prepare_fibres(inout precise principled p, material m, float mu)
{
    p.fibre_layer = 1.0;
    p.coat_layer = 1.0;
    if (!HAS_LOBE(LOBE_CHARLIE))
        return;
    p.fibre_color = material_sheen_color(m);
    p.fibre_roughness = max(0.1, material_sheen_roughness(m));
    p.fibre_albedo = albedo_charlie(p.tables, mu, p.fibre_roughness);
    float albedo = min(1.0, p.fibre_albedo);
    p.coat_layer = 1.0 - max_channel(p.fibre_color) * albedo;
    p.p_fibre = mean_channel(p.fibre_color) * albedo;
}

// Returns Schlick's reflectance for index 1.5 (Burley 2012, section 5.4), or that of Fresnel's
// equations.
float coat_fresnel(principled p, float cosine)
{
    if (HAS_LOBE(LOBE_EXACT_COAT) && p.coat_exact) {
        float cos_t;
        return fresnel_dielectric(cosine, 1.5, cos_t);
    }
    precise float f = 0.04 + 0.96 * schlick_weight(cosine);
    return f;
}

// Returns the albedo of a coat of weight 1 with the exact reflectance.
float coat_albedo_exact(principled p, float mu, float gloss)
{
    if (!p.coat_ggx)
        return 4.0 * albedo_coat_exact(p.tables, mu, gloss);
    if (p.coat_delta)
        return coat_fresnel(p, mu);
    return albedo_ggx(p.tables, mu, p.coat_alpha) *
           albedo_fresnel(p.tables, mu, p.coat_alpha, 1.5);
}

void prepare_coat(inout precise principled p, material m, float mu)
{
    p.base_layer = p.coat_layer;
    if (!HAS_LOBE(LOBE_CLEARCOAT))
        return;
    float weight = material_clearcoat(m);
    float roughness = material_clearcoat_roughness(m);
    float gloss = material_clearcoat_gloss(m);
    p.coat_ggx = material_has(m, MATERIAL_COAT_GGX);
    p.coat = p.coat_ggx ? weight : 0.25 * weight;
    p.coat_alpha = p.coat_ggx ? roughness * roughness : mix(0.1, 0.001, gloss);
    p.coat_delta = p.coat_ggx && is_delta(p.coat_alpha);
    float mean = p.coat_delta ? schlick_weight(mu) : albedo_schlick(p.tables, mu, p.coat_alpha);
    float albedo = (p.coat_delta ? 1.0 : albedo_ggx(p.tables, mu, p.coat_alpha)) *
                   (0.04 + 0.96 * mean);
    if (!p.coat_ggx)
        albedo = 4.0 * albedo_coat(p.tables, mu, gloss);
    if (HAS_LOBE(LOBE_EXACT_COAT) && material_has(m, MATERIAL_EXACT_COAT)) {
        p.coat_exact = true;
        albedo = coat_albedo_exact(p, mu, gloss);
    }
    albedo *= p.coat;
    p.base_layer = p.coat_layer * (1.0 - albedo);
    if (HAS_LOBE(LOBE_GLTF) && p.is_gltf) {
        p.coat_layer = 1.0;
        p.fibre_layer = 1.0 - albedo;
        p.p_fibre *= p.fibre_layer;
    }
    p.p_coat = p.coat_layer * albedo;
}

// Sets the dielectric's reflectance at normal incidence: that of the index, scaled and tinted.
void prepare_dielectric(inout precise principled p, material m, float eta)
{
    p.eta = is_index_matched(eta) ? 1.0 : eta;
    p.f0_index = fresnel_f0(p.eta);
    vec3 tint = mix(vec3(1.0), burley_tint(p.base_color), material_specular_tint(m));
    // With specular = 1/2 and no tint, the factor is 1 and the curve is exactly that of the index.
    p.f0 = min(vec3(1.0),
               p.f0_index * (2.0 * material_specular(m) * tint * material_specular_color(m)));
    p.specular_weight = material_specular_weight(m);
    if (HAS_LOBE(LOBE_MIXED_FRESNEL) && material_has(m, MATERIAL_MIXED_FRESNEL)) {
        p.is_mixed = true;
        p.specular_scale = min(vec3(1.0), material_specular_color(m));
        vec3 f0 = min(vec3(1.0), p.f0_index * (2.0 * material_specular(m) * tint));
        p.f0_metal = mix(f0, p.base_color, p.metallic);
        p.f0 = p.f0_index * p.specular_scale;
    }
    if (HAS_LOBE(LOBE_IRIDESCENCE)) {
        // ior / eta is the index of the medium on the other side.
        p.film_index = material_film_ior(m) / material_ior(m) * (p.eta < 1.0 ? 1.0 / p.eta : p.eta);
        p.film_thickness = material_film_thickness(m);
        p.film = p.film_index >= 1.0 ? material_iridescence(m) : 0.0;
    }
}

// Returns albedos that depend only on the slopes of the microfacets: E1; the means over reflected
// directions of the Fresnel reflectance (an upper bound if the surface is anisotropic) and of
// Schlick's weight; and a cosine at which these functions have about their means.
vec4 principled_albedo_slopes(principled p, material m, vec3 wo, float alpha)
{
    float cos_t;
    vec4 e = vec4(1.0, fresnel_dielectric(wo.z, p.eta, cos_t), schlick_weight(wo.z), wo.z);
    if (!HAS_LOBE(LOBE_ROUGH) || p.is_delta)
        return e;
    float anisotropic = material_anisotropic(m);
    if (HAS_LOBE(LOBE_ANISOTROPIC) && anisotropic > 0.0) {
        float alpha_o;
        vec3 axes = albedo_axes_turned(principled_turn(p, wo, false), p.roughness, anisotropic,
                                       p.alpha, alpha_o);
        float cosine = albedo_turned_cosine(p.tables, wo.z, axes, alpha_o);
        e.x = albedo_turned(p.tables, wo.z, axes, alpha_o);
        e.z = schlick_weight(cosine);
        e.w = cosine;
        e.y = fresnel_dielectric(cosine, max(p.eta, 1.05), cos_t);
        // Seen from inside, the value is at most that of Schlick's curve which begins at the angle
        // of total reflection.
        float critical = sqrt(max(0.0, (1.0 - p.eta) * (1.0 + p.eta)));
        float beyond = schlick_weight((cosine - critical) / (1.0 - critical));
        if (p.eta < 1.0)
            e.y = p.f0_index + (1.0 - p.f0_index) * beyond;
        if (p.eta == 1.0)
            e.y = 0.0;
    } else {
        e.x = albedo_ggx(p.tables, wo.z, alpha);
        e.y = p.eta == 1.0 ? 0.0 : albedo_fresnel(p.tables, wo.z, alpha, p.eta);
        if (HAS_LOBE(LOBE_METAL) || HAS_LOBE(LOBE_IRIDESCENCE))
            e.z = albedo_schlick(p.tables, wo.z, alpha);
        if (HAS_LOBE(LOBE_IRIDESCENCE))
            e.w = 1.0 - pow(e.z, 0.2);
    }
    return e;
}

// Expresses the reflectance F of an interface with modified reflectance or a film by a number from
// 0 (Fresnel's equations) to 1 (F = 1): 1 - F as a fraction of the light that Fresnel's equations
// transmit. Without a film this is exact. Otherwise the fraction is a least-squares fit over
// cosines beyond total reflection.
vec3 principled_moved(principled p)
{
    vec3 moved = (p.f0 - p.f0_index) / (1.0 - p.f0_index);
    if (!HAS_LOBE(LOBE_IRIDESCENCE) || !(p.film > 0.0))
        return moved;
    const int count = 3;
    float critical = p.eta < 1.0 ? sqrt((1.0 - p.eta) * (1.0 + p.eta)) : 0.0;
    vec3 product = vec3(0.0);
    float square = 0.0;
    for (int i = 0; i < count; i++) {
        float cos_t;
        float cos_o = mix(critical, 1.0, (float(i) + 0.5) / float(count));
        float exact = fresnel_dielectric(cos_o, p.eta, cos_t);
        product += (1.0 - exact) * (1.0 - principled_dielectric(p, cos_o, exact, cos_t, false));
        square += (1.0 - exact) * (1.0 - exact);
    }
    return 1.0 - product / square;
}

// Returns the albedos of a lossless transmitting interface: with Fresnel's reflectance, and if only
// total reflection reflects.
vec2 principled_albedo_lossless(principled p, material m, vec3 wo, float alpha)
{
    float anisotropic = material_anisotropic(m);
    float factor = 1.0;
    if (HAS_LOBE(LOBE_ANISOTROPIC) && anisotropic > 0.0) {
        float alpha_o;
        vec3 axes = albedo_axes_turned(principled_turn(p, wo, false), p.roughness, anisotropic,
                                       p.alpha, alpha_o);
        alpha = albedo_turned_stand_in(wo.z, p.alpha, alpha_o);
        factor = albedo_turned_glass(p.tables, wo.z, axes, p.roughness, alpha_o, p.eta);
    }
    bool is_scaled = p.specular_weight < 1.0 || (HAS_LOBE(LOBE_MIXED_FRESNEL) && p.is_mixed);
    float clear = is_scaled ? albedo_clear(p.tables, wo.z, alpha, p.eta) : 0.0;
    return min(vec2(1.0), factor * vec2(albedo_glass(p.tables, wo.z, alpha, p.eta), clear));
}

// Returns the albedo, per channel, of a transmitting interface with this material's reflectance. It
// is linear in the reflectance: between the albedo for Fresnel's reflectance and E1, which is that
// for F = 1; and, by the specular weight, between this value and the albedo without reflection. e1
// is E1.
vec3 principled_albedo_through(principled p, material m, vec3 wo, float alpha, float e1)
{
    if (p.thin)
        return vec3(e1);
    vec2 lossless = principled_albedo_lossless(p, m, wo, alpha);
    // The specular colour scales reflection except total reflection, like the specular weight.
    if (HAS_LOBE(LOBE_MIXED_FRESNEL) && p.is_mixed && !(p.film > 0.0))
        return mix(vec3(lossless.y), vec3(lossless.x), p.specular_weight * p.specular_scale);
    vec3 albedo = lossless.x + principled_moved(p) * (e1 - lossless.x);
    if (p.specular_weight < 1.0)
        albedo = mix(vec3(lossless.y), albedo, p.specular_weight);
    return albedo;
}

// Sets how the base is sampled, and sampled again, if transmission loses no energy. The probability
// of reflection is that of Fresnel's equations, averaged over the channels. It is greater if
// transmission is tinted or a metal reflects, too: then a fraction of the light that Fresnel's
// equations transmit is also reflected. At normal incidence the probabilities are therefore
// proportional to the mean reflectance and the mean transmittance. The probability that a try
// survives is linear in the probability of reflection, like the albedo.
void prepare_tries(inout precise principled p, vec3 albedo, float e1)
{
    float f0 = p.specular_weight * mean_channel(p.f0);
    f0 = p.thin ? 2.0 * f0 / (1.0 + f0) : f0;
    float reflected = (1.0 - p.metallic) * f0 + p.metallic * mean_channel(p.base_color);
    float through = p.transmission * mean_channel(p.tint) * (1.0 - f0);
    float reflects = reflected / (reflected + through);
    p.tries_again = !p.separable;
    p.reflects_more = f0 < 1.0 ? clamp((reflects - f0) / (1.0 - f0), 0.0, 1.0) : 0.0;
    p.tries_scale = tries_scale(min(1.0, mix(mean_channel(albedo), e1, p.reflects_more)));
}

// Returns E_dielectric; `albedo` becomes the albedo of reflection and transmission together.
vec3 prepare_interface(inout precise principled p, material m, vec3 wo, float alpha,
                       out precise vec3 albedo)
{
    vec4 e = principled_albedo_slopes(p, m, wo, alpha);
    float cos_t = e.w;
    if (HAS_LOBE(LOBE_IRIDESCENCE))
        fresnel_dielectric(e.w, p.eta, cos_t);
    precise vec3 f = principled_dielectric(p, e.w, e.y, cos_t, !p.is_delta);
    f *= p.eta < 1.0 ? 1.0 : p.specular_weight;
    if (HAS_LOBE(LOBE_MIXED_FRESNEL) && p.is_mixed && p.eta < 1.0)
        f = max(f, vec3(e.y));
    albedo = (1.0 - p.metallic) * f;
    if (HAS_LOBE(LOBE_TRANSMISSION)) {
        if (HAS_LOBE(LOBE_COMPENSATE) && material_has(m, MATERIAL_COMPENSATE) &&
            p.transmission > 0.0 && !p.is_delta && p.eta != 1.0) {
            vec3 lossless = principled_albedo_through(p, m, wo, alpha, e.x);
            p.through_compensation = 1.0 / lossless;
            prepare_tries(p, lossless, e.x);
        }
        vec3 f_t = p.thin ? 2.0 * f / (1.0 + f) : f;
        albedo += p.transmission *
                  (p.through_compensation * (f_t + p.tint * (1.0 - f_t)) - f);
    }
    if (HAS_LOBE(LOBE_METAL)) {
        if (HAS_LOBE(LOBE_COMPENSATE) && material_has(m, MATERIAL_COMPENSATE))
            p.compensation = 1.0 + principled_reflects(p) * ((1.0 - e.x) / e.x);
        vec3 f0 = principled_f0_metal(p);
        vec3 metal = principled_metal(p, e.w, cos_t, f0 + (1.0 - f0) * e.z);
        albedo += p.metallic * p.compensation * metal;
    }
    albedo *= e.x;
    return e.x * f;
}

void prepare_diffuse(inout precise principled p, material m, float mu)
{
    p.subsurface = material_subsurface(m);
    p.albedo_diffuse = principled_albedo_diffuse(p, mu);
    p.sheen_layer = 1.0;
    vec3 albedo = vec3(0.0);
    if (HAS_LOBE(LOBE_SHEEN)) {
        vec3 color = material_sheen(m) *
                     mix(vec3(1.0), burley_tint(p.base_color), material_sheen_tint(m));
        float largest = load_materials_float(p.tables + ALBEDO_DIFFUSE).w;
        p.sheen = color / max(1.0, largest * max_channel(color));
        float sheen_albedo = albedo_diffuse(p.tables, mu).w;
        p.sheen_layer = 1.0 - max_channel(p.sheen) * sheen_albedo;
        albedo = p.sheen * sheen_albedo;
    }
    if (HAS_LOBE(LOBE_DIFFUSE_TRANSMISSION) && p.thin)
        p.diffuse_transmission = material_diffuse_transmission(m);
    vec3 rest = p.sheen_layer * p.base_color;
    albedo += rest * ((1.0 - p.diffuse_transmission) * min(1.0, p.albedo_diffuse));
    p.p_diffuse = p.base_layer * mean_channel(p.below * albedo);
    p.p_through = p.base_layer * p.diffuse_transmission * mean_channel(p.below * rest);
}

// Keeps only the lobes of the part to which the material is restricted. For the diffuse part, the
// specular lobes are marked as delta lobes, so that they are not evaluated.
void prepare_part(inout precise principled p, material m)
{
    if (is_part(m, MATERIAL_DIFFUSE_PART)) {
        p.is_delta = true;
        p.coat_delta = true;
        p.tries_again = false;
        p.p_base = 0.0;
        p.p_coat = 0.0;
    }
    if (is_part(m, MATERIAL_SPECULAR_PART)) {
        p.below = vec3(0.0);
        p.fibre_color = vec3(0.0);
        p.p_diffuse = 0.0;
        p.p_through = 0.0;
        p.p_fibre = 0.0;
    }
}

principled principled_prepare(material m, vec3 wo, float eta)
{
    precise principled p;
    p.tables = albedos_begin();
    p.base_color = material_base_color(m);
    p.roughness = material_roughness(m);
    p.metallic = HAS_LOBE(LOBE_METAL) ? material_metallic(m) : 0.0;
    p.transmission =
        HAS_LOBE(LOBE_TRANSMISSION) ? (1.0 - p.metallic) * material_transmission(m) : 0.0;
    p.thin = is_thin(m);
    p.separable = is_separable(m);
    p.is_gltf = principled_is_gltf(m);
    p.tint = p.thin || material_has(m, MATERIAL_TINT_EACH) ? p.base_color : sqrt(p.base_color);
    p.film = 0.0;
    p.film_index = 1.0;
    p.film_thickness = 0.0;
    p.compensation = vec3(1.0);
    p.through_compensation = vec3(1.0);
    p.tries_again = false;
    p.tries_scale = 1.0;
    p.reflects_more = 0.0;
    p.sheen = vec3(0.0);
    p.diffuse_transmission = 0.0;
    p.fibre_color = vec3(0.0);
    p.fibre_roughness = 1.0;
    p.fibre_albedo = 0.0;
    p.coat = 0.0;
    p.coat_alpha = 1.0;
    p.coat_ggx = false;
    p.coat_delta = false;
    p.coat_exact = false;
    p.is_mixed = false;
    p.specular_scale = vec3(1.0);
    p.f0_metal = p.base_color;
    p.p_fibre = 0.0;
    p.p_coat = 0.0;

    float alpha = p.roughness * p.roughness;
    p.is_delta = is_delta(alpha);
    p.alpha = vec2(alpha);
    p.turn = vec2(1.0, 0.0);
    float anisotropic = material_anisotropic(m);
    if (HAS_LOBE(LOBE_ANISOTROPIC) && anisotropic > 0.0) {
        float aspect = sqrt(1.0 - 0.9 * anisotropic);
        p.alpha = vec2(alpha / aspect, max(SMALLEST_ALPHA, alpha * aspect));
        p.turn = cos_sin_turns(material_anisotropic_rotation(m));
    }

    prepare_fibres(p, m, wo.z);
    prepare_coat(p, m, wo.z);
    prepare_dielectric(p, m, eta);
    vec3 albedo;
    vec3 dielectric = prepare_interface(p, m, wo, alpha, albedo);
    p.p_base = p.base_layer * mean_channel(albedo);
    p.below = (1.0 - p.metallic - p.transmission) * (1.0 - principled_whitened(p, dielectric));
    prepare_diffuse(p, m, wo.z);
    prepare_part(p, m);

    float sum = p.p_fibre + p.p_coat + p.p_base + p.p_diffuse + p.p_through;
    float scale = sum > 0.0 ? 1.0 / sum : 0.0;
    p.p_fibre *= scale;
    p.p_coat *= scale;
    p.p_base *= scale;
    p.p_diffuse *= scale;
    p.p_through *= scale;
    return p;
}

#endif
