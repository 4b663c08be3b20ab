// Implements Whitted 1980, "An Improved Illumination Model for Shaded Display" (shown in 1979):
// converts materials to his model, and keeps the stack of rays that a path has yet to follow. The
// stack follows the shadow rays in their buffer.
#ifndef WHITTED_GLSL
#define WHITTED_GLSL

#include "lib/light.glsl"
#include "lib/ray_offset.glsl"
#include "lib/vertex.glsl"

// I = emission + (kd + ks) ambient + sum over lights of (kd / pi + Phong's highlight) cos E
//   + kr S + kt T, with S and T from the mirrored and the refracted direction.
struct whitted_surface {
    vec3 diffuse;   // kd, the diffuse albedo
    vec3 highlight; // ks, the albedo of the highlight
    float exponent; // exponent of the highlight
    vec3 reflected; // kr
    vec3 refracted; // kt, including the scaling of radiance by refraction
    vec3 onwards;   // refracted direction in the local frame
};

// --- our material models in these terms ----------------------------------------------------------

// Returns the Phong exponent for GGX or Beckmann with this alpha. Their normals have about the
// exponent 2 / alpha^2 - 2 (Walter et al. 2007, section 5.2); a lobe about the mirror direction has
// a quarter of that (Fisher and Woo 1994, "R.E versus N.H Specular Highlights").
float exponent_of_alpha(float alpha)
{
    return clamp(0.5 / (alpha * alpha) - 0.5, 0.0, 1e6);
}

// Adds an interface's reflection: smooth interfaces mirror, rough ones have a highlight.
void whitted_gloss(inout whitted_surface w, vec3 reflectance, float alpha)
{
    if (is_delta(alpha)) {
        w.reflected += reflectance;
    } else {
        w.highlight += reflectance;
        w.exponent = exponent_of_alpha(alpha);
    }
}

// Adds refraction, which is sharp even if the interface is rough. `through` is the transmittance
// without reflection.
void whitted_interface(inout whitted_surface w, vec3 wo, vec3 reflectance, vec3 through, float eta,
                       bool thin)
{
    float cos_t;
    fresnel_dielectric(wo.z, eta, cos_t);
    w.reflected += reflectance;
    w.refracted = (1.0 - reflectance) * through;
    w.onwards = -wo;
    if (thin || is_index_matched(eta))
        return;
    w.onwards = vec3(-wo.xy / eta, -cos_t);
    w.refracted /= refraction_divisor(eta);
}

void whitted_dielectric(inout whitted_surface w, material m, vec3 wo, float eta)
{
    float cos_t;
    bool thin = is_thin(m);
    float r = thin ? fresnel_slab(wo.z, eta) : fresnel_dielectric(wo.z, eta, cos_t);
    whitted_interface(w, wo, vec3(is_index_matched(eta) ? 0.0 : r), vec3(1.0), eta, thin);
}

// Metals mirror even if they are rough, and have a highlight in addition.
void whitted_metal(inout whitted_surface w, vec3 reflectance, float alpha)
{
    w.reflected += reflectance;
    if (is_delta(alpha))
        return;
    w.highlight += reflectance;
    w.exponent = exponent_of_alpha(alpha);
}

void whitted_principled(inout whitted_surface w, material m, vec3 wo, float eta)
{
    vec3 base = material_base_color(m);
    float metallic = HAS_LOBE(LOBE_METAL) ? material_metallic(m) : 0.0;
    float transmission =
        HAS_LOBE(LOBE_TRANSMISSION) ? (1.0 - metallic) * material_transmission(m) : 0.0;
    float alpha = dielectric_alpha(m);
    vec3 tint = mix(vec3(1.0), burley_tint(base), material_specular_tint(m));
    vec3 scale = 2.0 * material_specular(m) * tint * material_specular_color(m);
    float cos_t;
    float exact = is_index_matched(eta) ? 0.0 : fresnel_dielectric(wo.z, eta, cos_t);
    vec3 f = exact < 1.0 ? min(vec3(1.0), exact * scale) * material_specular_weight(m) : vec3(1.0);

    w.diffuse = (1.0 - metallic - transmission) * base * (1.0 - f);
    if (HAS_LOBE(LOBE_METAL) && metallic > 0.0)
        whitted_metal(w, metallic * fresnel_schlick(base, wo.z), alpha);
    if (HAS_LOBE(LOBE_TRANSMISSION) && transmission > 0.0) {
        bool thin = is_thin(m);
        vec3 slab = thin ? 2.0 * f / (1.0 + f) : f;
        bool each = thin || material_has(m, MATERIAL_TINT_EACH);
        vec3 before = w.reflected;
        whitted_interface(w, wo, slab, each ? base : sqrt(base), eta, thin);
        w.reflected = before + transmission * slab;
        w.refracted *= transmission;
    }
    float opaque = 1.0 - metallic - transmission;
    if (opaque > 0.0)
        whitted_gloss(w, opaque * f, alpha);
}

void whitted_microfacet(inout whitted_surface w, material m, vec3 wo, float eta)
{
    vec3 f0 = min(fresnel_f0(eta) * material_specular_color(m), vec3(1.0));
    vec3 f = fresnel_schlick(f0, wo.z);
    w.diffuse = material_base_color(m) * (1.0 - f);
    whitted_gloss(w, f, dielectric_alpha(m));
}

whitted_surface whitted_surface_of(material m, vec3 wo, float eta)
{
    uint model = material_model(m);
    whitted_surface w = whitted_surface(vec3(0.0), vec3(0.0), 0.0, vec3(0.0), vec3(0.0), vec3(0.0));
    bool phong = HAS_LOBE(LOBE_PHONG) && model == MATERIAL_PHONG;
    bool blinn = HAS_LOBE(LOBE_BLINN_PHONG) && model == MATERIAL_BLINN_PHONG;
    if (HAS_LOBE(LOBE_LAMBERT) && model == MATERIAL_LAMBERT)
        w.diffuse = material_base_color(m);
    if (HAS_LOBE(LOBE_MIRROR) && model == MATERIAL_MIRROR)
        w.reflected = material_base_color(m);
    if (phong || blinn) {
        classical_parts parts = phong_parts(m);
        w.diffuse = parts.diffuse;
        w.highlight = parts.specular;
        w.exponent = material_exponent(m) * (blinn ? 0.25 : 1.0);
    }
    if (HAS_LOBE(LOBE_MICROFACET) && model == MATERIAL_MICROFACET)
        whitted_microfacet(w, m, wo, eta);
    if (HAS_LOBE(LOBE_CONDUCTOR) && model == MATERIAL_CONDUCTOR)
        whitted_metal(w, conductor_reflectance(m, wo.z, eta), dielectric_alpha(m));
    if (HAS_LOBE(LOBE_DIELECTRIC) && model == MATERIAL_DIELECTRIC)
        whitted_dielectric(w, m, wo, eta);
    if (HAS_LOBE(LOBE_PRINCIPLED) && model == MATERIAL_PRINCIPLED)
        whitted_principled(w, m, wo, eta);
    return w;
}

// --- lights -------------------------------------------------------------------------------------

// Returns the far field of an emissive primitive, as if it were concentrated at its centre:
// radiance times the projected area, divided by the squared distance.
light_sample center_of_triangle(vec3 origin, uint index)
{
    triangle_record t = load_triangle(index);
    vec3 area = 0.5 * cross(t.edge1, t.edge2);
    light_sample l;
    l.primitive = index;
    l.material = t.word;
    l.barycentrics = vec2(1.0 / 3.0);
    l.to_light = (t.v0 + t.v1 + t.v2) * (1.0 / 3.0) - origin;
    l.radiance = material_emission(load_material(t.word));
    l.pdf = abs(dot(area, normalize(l.to_light)));
    if (HAS_GEOMETRY(GEOMETRY_SMALL_TRIANGLES)) {
        bool hidden = is_hidden_by_lamp(t, l.barycentrics, -l.to_light);
        l.pdf = hidden ? 0.0 : l.pdf;
    }
    return l;
}

// For a solid, the point where the line to its centre meets its surface represents the centre, so
// that the shape itself is not in the way.
light_sample center_of_shape(vec3 origin, uint index)
{
    shape_record shape = load_shape(index);
    light_sample l;
    l.primitive = PRIMITIVE_SHAPE | index;
    l.material = shape.word;
    l.barycentrics = vec2(0.0);
    l.to_light = shape.center - origin;
    l.radiance = material_emission(load_material(shape.word));
    l.pdf = shape_area_seen(shape, normalize(l.to_light));
    bool is_solid = HAS_EMITTER(EMITTERS_SOLID) && shape.kind >= SHAPE_KIND_BOX;
    if (is_solid) {
        crossings c = cross_shape(origin, l.to_light, shape, false);
        bool is_near = c.first > 0.0 && c.first < 1.0;
        l.to_light *= is_near ? c.first : 1.0;
        l.barycentrics = is_near ? c.first_at : vec2(1.0, 0.0);
    }
    return l;
}

// Returns the light of the emitter with this index; `radiance` is the irradiance of a surface that
// faces it. pdf is 0 if there is no such emitter.
light_sample whitted_light(vec3 origin, uint number)
{
    light_sample l;
    uint primitive = load_emitters(number).y;
    bool is_environment = (primitive & PRIMITIVE_ENVIRONMENT) != 0u;
    bool is_point = (primitive & PRIMITIVE_LIGHT) != 0u;
    bool is_shape = (primitive & PRIMITIVE_SHAPE) != 0u;
    l.pdf = 0.0;
    l.primitive = primitive;
    l.radiance = l.to_light = vec3(0.0);
    if (is_environment)
        return l;
    if (is_point) {
        if (HAS_EMITTER(EMITTERS_LIGHTS))
            sample_point_light(origin, primitive & ~PRIMITIVE_LIGHT,
                               light_choice(primitive, 1.0, false), vec2(0.5), l);
        return l;
    }
    if (HAS_EMITTER(EMITTER_TRIANGLES) && !is_shape)
        l = center_of_triangle(origin, primitive);
    if (HAS_EMITTER(EMITTERS_SHAPES) && is_shape)
        l = center_of_shape(origin, primitive & ~PRIMITIVE_SHAPE);
    float distance2 = dot(l.to_light, l.to_light);
    if (HAS_EMITTER(EMITTER_SPHERES) && is_shape) {
        vec4 w0 = load_shapes_float((primitive & ~PRIMITIVE_SHAPE) * SHAPE_WORDS);
        uint word = load_shapes((primitive & ~PRIMITIVE_SHAPE) * SHAPE_WORDS + 1u).w;
        if (word >> SHAPE_KIND_SHIFT == SHAPE_KIND_SPHERE)
            l.to_light *= max(0.0, 1.0 - w0.w * inversesqrt(distance2));
    }
    if (HAS(FEATURE_TEXTURES) || HAS(FEATURE_ALPHA))
        texture_light(origin, l);
    l.radiance *= l.pdf / distance2;
    l.pdf = dot(l.to_light, l.to_light) > 0.0 ? 1.0 : 0.0;
    return l;
}

// Stores a shadow ray to each light; returns false if none is needed. If there is a single light, a
// ray without contribution is not stored.
bool whitted_lights(vertex v, whitted_surface w)
{
    surface s = v.s;
    vec3 origin = offset_origin(s.position, s.error, s.normal_geometric, s.normal_geometric);
    vec3 mirrored_wo = vec3(-v.wo.xy, v.wo.z);
    bool any_light = false;
    for (uint i = 0u; i < LIGHT_RAYS; i++) {
        light_sample l = whitted_light(origin, i);
        vec3 wi = normalize(l.to_light);
        vec3 local = wi * v.frame;
        vec3 radiance = vec3(0.0);
        if (l.pdf > 0.0 && local.z > 0.0 && dot(wi, s.normal_geometric) > 0.0) {
            // The lobe of eval_phong(): Lafortune and Willems 1994.
            vec3 difference = local - mirrored_wo;
            float lobe = 0.5 * INV_PI * (w.exponent + 2.0) *
                         power_one_minus(0.5 * dot(difference, difference), w.exponent);
            radiance = v.throughput * (w.diffuse * INV_PI + w.highlight * lobe) * local.z *
                       l.radiance;
            if (HAS(FEATURE_MEDIA))
                radiance *= transmittance(load_medium(medium_towards(v, wi)), length(l.to_light));
        }
        bool counts = any(notEqual(radiance, vec3(0.0)));
        any_light = any_light || counts;
        store_shadow_ray(v.slot, i, 0u, uvec4(floatBitsToUint(origin), v.primitive));
        store_shadow_ray(v.slot, i, 1u, uvec4(floatBitsToUint(l.to_light), l.primitive));
        store_shadow_ray(v.slot, i, 2u, floatBitsToUint(vec4(radiance, 1.0)));
        store_shadow_instance(v.slot, i, v.instance);
    }
    return any_light;
}

// --- rays of the tree ----------------------------------------------------------------------------

// If two rays continue, one whose weight is less than this is dropped (Hall and Greenberg 1983, "A
// Testbed for Realistic Image Synthesis"); otherwise trees would double in size with each level. A
// ray that continues alone is followed whatever its weight.
const float LEAST_PART = 0.0009765625; // 2^-10: about a quarter of a step of 8 bits

// A ray of the tree: it is `depth` scattering events from the camera, and `pending` other rays are
// below it on the stack. Both numbers are in the word that holds the density of the direction in
// other integrators.
struct whitted_ray {
    vec3 origin;
    uint ignore;
    uint instance; // instance of the ignored primitive
    vec3 direction;
    uint depth;
    uint pending;
    vec3 throughput;
    uint media;
};

uint whitted_state(whitted_ray r)
{
    return r.depth | r.pending << 16u;
}

void follow(uint slot, whitted_ray r)
{
    store_path(slot, PATH_ORIGIN, uvec4(floatBitsToUint(r.origin), r.ignore));
    store_path(slot, PATH_DIRECTION, uvec4(floatBitsToUint(r.direction), whitted_state(r)));
    store_path(slot, PATH_THROUGHPUT, uvec4(floatBitsToUint(r.throughput), r.media));
    store_path_start_instance(slot, r.instance);
}

// The stack of a slot has one entry for each depth, because a ray waits while its sibling's whole
// tree is traced, and at most one ray waits at each depth.
uint pending_word(uint slot, uint entry)
{
    uint first = HAS(FEATURE_NEE) ? frame.wave_slots * LIGHT_RAYS : 0u;
    return (first + slot * frame.pending_rays + entry) * SHADOW_WORDS;
}

void put_off(uint slot, whitted_ray r)
{
    uint at = pending_word(slot, r.pending);
    shadow_rays_words[at] = uvec4(floatBitsToUint(r.origin), r.ignore);
    shadow_rays_words[at + 1u] = uvec4(floatBitsToUint(r.direction), whitted_state(r));
    shadow_rays_words[at + 2u] = uvec4(floatBitsToUint(r.throughput), r.media);
    if (HAS_GEOMETRY(GEOMETRY_INSTANCES))
        shadow_rays_words[at + SHADOW_INSTANCE] = uvec4(r.instance, 0u, 0u, 0u);
}

// The ray that was postponed last becomes the slot's ray.
void take_up(uint slot, uint pending)
{
    uint at = pending_word(slot, pending - 1u);
    store_path(slot, PATH_ORIGIN, load_shadow_rays(at));
    store_path(slot, PATH_DIRECTION, load_shadow_rays(at + 1u));
    store_path(slot, PATH_THROUGHPUT, load_shadow_rays(at + 2u));
    if (HAS_GEOMETRY(GEOMETRY_INSTANCES))
        store_path_start_instance(slot, load_shadow_rays(at + SHADOW_INSTANCE).x);
}

#endif
