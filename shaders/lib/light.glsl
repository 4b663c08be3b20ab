// For next-event estimation, samples a point on an emitter or a delta light, and returns the
// density of that sample. sample_light and pdf_light must agree, so that MIS weights sum to one.
#ifndef LIGHT_GLSL
#define LIGHT_GLSL

#include "lib/alpha.glsl"
#include "lib/environment.glsl"
#include "lib/light_tree.glsl"
#include "lib/material.glsl"
#include "lib/nee.glsl"
#include "lib/profile.glsl"
#include "lib/random.glsl"
#include "lib/sampling.glsl"
#include "lib/shape_light.glsl"
#include "lib/small_lamp.glsl"
#include "lib/solid_angle.glsl"
#include "lib/sun.glsl"
#include "lib/surface.glsl"
#include "lib/triangle.glsl"

// Returns the distance of the sampled point, for attenuation on the way to it.
float light_distance(light_sample l)
{
    bool is_infinite = HAS_EMITTER(EMITTER_SUNS | EMITTER_ENVIRONMENT) && !l.delta && l.infinite;
    return is_infinite ? 3.4e38 : length(l.to_light);
}

// The selected emitter and its selection probability, which is used if neither the emitter's
// material nor its record has it.
struct light_choice {
    uint primitive;
    float pick;
    bool of_lamp; // the emitter was selected within one lamp, so its record does not have the
                  // probability
};

// Returns the solid angle of a triangle that is sampled by solid angle; 0 if it is sampled by area,
// as are triangles whose corners are rounded.
float solid_angle_of(seen_triangle seen, triangle_record t)
{
    return IS_SMALL(t.word) ? 0.0 : solid_angle_of(seen);
}

// Returns the density of a point on an emitter that is sampled by solid angle; 0 for other
// emitters.
float density_by_solid_angle(vec3 origin, uint primitive, float pick_density)
{
    float area = 0.0, solid_angle = 0.0;
    if (HAS_EMITTER(EMITTER_TRIANGLES) && !IS_SHAPE(primitive)) {
        triangle_record t = load_triangle(primitive);
        solid_angle = solid_angle_of(see_triangle(origin, t.v0, t.edge1, t.edge2), t);
        area = triangle_area(t);
    }
    if (HAS_EMITTER(EMITTER_QUADS) && IS_SHAPE(primitive)) {
        shape_record shape = load_shape(primitive & ~PRIMITIVE_SHAPE);
        if (shape.kind == SHAPE_KIND_QUAD) {
            float first;
            solid_angle =
                solid_angle_of_quad(shape.center - origin, shape.axis, shape.other, first);
            area = shape_area(shape);
        }
    }
    return solid_angle > 0.0 ? pick_density * area / solid_angle : 0.0;
}

// Returns the density per solid angle with which sample_light() samples a point of an emitter as
// seen from `origin`, given the point's distance, the cosine at the emitter and, for a sphere, its
// radius and centre.
float pdf_light_at(vec3 origin, float distance, float cos_light, float radius, vec3 center,
                   uint primitive, float pick_density)
{
    if (HAS_EMITTER(EMITTER_SPHERES) && radius > 0.0) {
        float sin2_max = sphere_sin2(origin, center, radius);
        if (sin2_max < 1.0)
            return pdf_sphere_cone(radius, sin2_max, pick_density);
    }
    float by_solid_angle = density_by_solid_angle(origin, primitive, pick_density);
    if (by_solid_angle > 0.0)
        return by_solid_angle;
    return pdf_area_to_solid_angle(pick_density, distance, cos_light);
}

// Returns the density of pdf_light_at() for the unit direction `direction`, in which the ray hits
// the surface `s` at `distance`.
float pdf_light(vec3 origin, vec3 direction, float distance, surface s, uint primitive,
                float pick_density)
{
    return pdf_light_at(origin, distance, abs(dot(direction, s.normal_geometric)), s.radius,
                        s.center, primitive, pick_density);
}

void sample_triangle_light(vec3 origin, uint index, float pick, vec2 u, inout light_sample l)
{
    triangle_record t = load_triangle(index);
    seen_triangle seen = see_triangle(origin, t.v0, t.edge1, t.edge2);
    float solid_angle = solid_angle_of(seen, t);
    vec2 b = solid_angle > 0.0 ? sample_seen_triangle(seen, u) : sample_triangle(u);
    vec3 point = t.v0 + b.x * t.edge1 + b.y * t.edge2;
    l.material = t.word;
    l.barycentrics = b;
    material m = load_material(t.word);
    float density = material_pick_density(m);
    if (LIGHT_CHOICE != LIGHT_CHOICE_POWER)
        density = pick / triangle_area(t);
    finish_area_sample(l, point - origin, triangle_normal(t), m, density);
    if (solid_angle > 0.0)
        l.pdf = density * triangle_area(t) / solid_angle;
    if (HAS_GEOMETRY(GEOMETRY_SMALL_TRIANGLES)) {
        bool hidden = is_hidden_by_lamp(t, b, -l.to_light);
        l.pdf = hidden ? 0.0 : l.pdf;
    }
}

// Multiplies the emission of a sampled primitive by its textures and by its opacity. The factor of
// opacity is correct on average, because the shadow ray does not test the emitter at its end.
void texture_light(vec3 origin, inout light_sample l)
{
    vec3 point = origin + l.to_light;
    if (HAS(FEATURE_TEXTURES)) {
        surface s;
        bool is_shape = (l.primitive & PRIMITIVE_SHAPE) != 0u;
        if (HAS_EMITTER(EMITTER_TRIANGLES) && !is_shape)
            load_corner_attributes(l.primitive, l.barycentrics, s);
        if (HAS_EMITTER(EMITTERS_SHAPES) && is_shape)
            s = load_shape_surface(l.primitive & ~PRIMITIVE_SHAPE, point, l.barycentrics);
        l.radiance = textured_emission(load_material(l.material), s);
    }
    if (HAS(FEATURE_ALPHA) && (l.material & MATERIAL_WORD_ALPHA) != 0u)
        l.radiance *= alpha_probability(l.primitive, l.barycentrics, point, l.material);
}

// Returns the fraction of a spot light's intensity in the unit direction `from_light`
// (KHR_lights_punctual): clamp((cos - cos_outer) / (cos_inner - cos_outer), 0, 1)^2. It is computed
// from 1 - cos, which avoids cancellation if the cone is narrow.
float spot_falloff(vec3 direction, vec3 from_light, float scale, float offset)
{
    float cos_theta = dot(direction, from_light);
    vec3 normal = cross(direction, from_light);
    float one_minus_cos =
        cos_theta > 0.0 ? dot(normal, normal) / (1.0 + cos_theta) : 1.0 - cos_theta;
    float falloff = clamp(offset - scale * one_minus_cos, 0.0, 1.0);
    return falloff * falloff;
}

// Returns the factor of a light's intensity at a distance of `part` ranges, in addition to the
// square of the distance (KHR_lights_punctual, "Range Property").
float range_window(float part)
{
    float square = part * part;
    return clamp(1.0 - square * square, 0.0, 1.0);
}

// A directional light with an angular diameter is a cone of constant radiance.
void sample_sun_light(vec3 towards, vec3 irradiance, float versine, float reach, vec2 u,
                      inout light_sample l)
{
    vec3 direction;
    l.delta = false;
    l.pdf *= sample_sun(towards, versine, u, direction);
    l.to_light = reach * direction;
    l.radiance = sun_radiance(irradiance, versine);
}

void sample_point_light(vec3 origin, uint index, light_choice choice, vec2 u, inout light_sample l)
{
    uint at = lights_begin() + index * LIGHT_WORDS;
    uvec4 w0 = load_materials(at);
    vec4 w1 = load_materials_float(at + 1u);
    vec4 w2 = load_materials_float(at + 2u);
    vec4 w3 = load_materials_float(at + 3u);
    l.delta = true;
    bool is_recorded = w0.w == LIGHT_DIRECTIONAL && !choice.of_lamp;
    l.pdf = is_recorded || !CHOOSES_BY_PLACE ? w1.w : choice.pick;
    l.radiance = w2.rgb;
    if (w0.w == LIGHT_DIRECTIONAL) {
        l.infinite = true;
        l.to_light = -w3.z * w1.xyz;
        if (HAS_EMITTER(EMITTER_SUNS) && (!HAS_EMITTER(EMITTER_LIGHTS) || w3.w > 0.0))
            sample_sun_light(-w1.xyz, w2.rgb, w3.w, w3.z, u, l);
        return;
    }
    l.to_light = uintBitsToFloat(w0.xyz) - origin;
    float distance2 = dot(l.to_light, l.to_light);
    float distance = sqrt(distance2);
    l.radiance *= range_window(distance * w2.w) / distance2;
    if (w0.w == LIGHT_SPOT)
        l.radiance *= spot_falloff(w1.xyz, -l.to_light / distance, w3.x, w3.y);
    if (HAS_EMITTER(EMITTER_PROFILES)) {
        uvec4 w4 = load_materials(at + 4u);
        if (w4.w != 0u)
            l.radiance *= profile_intensity(w4.w, w1.xyz, uintBitsToFloat(w4.xyz),
                                            -l.to_light / distance);
    }
    // At the light's own position there is no direction to it.
    l.pdf = distance2 > 0.0 ? l.pdf : 0.0;
}

void sample_environment_light(float pick, vec2 u, inout light_sample l)
{
    // `more` supplies bits below those of u, for the environment's texels. They need not be
    // stratified.
    uvec4 more = pcg4d(uvec4(floatBitsToUint(u), 0u, 0u));
    vec3 direction;
    vec2 low = vec2(more.xy >> 8u) * 5.9604644775390625e-8;
    l.pdf = pick * sample_environment(u, low, direction, l.radiance);
    l.to_light = frame.environment_reach * direction;
    l.infinite = true;
}

// Selects one of frame.emitter_count bins of the alias table, and a position in it, by two
// uniforms: one alone has too few bits if bins are many or very unequal. u = (x, y) represents the
// number x + 2^-24 y, which has 48 bits.
uint choose_bin(vec2 u, out float within)
{
    uvec2 bits = uvec2(u * 16777216.0);
    uint high, low, below_high, below_low, carry;
    umulExtended(bits.x, frame.emitter_count, high, low);
    umulExtended(bits.y, frame.emitter_count, below_high, below_low);
    low = uaddCarry(low, below_high << 8 | below_low >> 24, carry);
    high += carry;
    within = float(low & 0xffffffu) * 5.9604644775390625e-8 +
             float(below_low & 0xffffffu) * 3.552713678800501e-15;
    return high << 8 | low >> 24;
}

// Selects an emitter: in proportion to power by the alias table (Walker 1977; Vose 1991), with
// equal probability, or by the light tree.
light_choice choose_light(receiver r, vec2 u)
{
    if (CHOOSES_BY_PLACE) {
        float probability;
        uint primitive = choose_from_tree(r, u, probability);
        return light_choice(primitive, probability, false);
    }
    float within;
    uvec4 emitter = load_emitters(choose_bin(u, within));
    bool own = within < uintBitsToFloat(emitter.x);
    return light_choice(own ? emitter.y : emitter.z, 1.0 / float(frame.emitter_count), false);
}

// Samples a point on an emitter. A pdf of 0 means that there is no emitter to connect to.
light_sample sample_emitter(vec3 origin, light_choice choice, vec2 u)
{
    light_sample l;
    l.primitive = choice.primitive;
    l.to_light = vec3(0.0);
    l.pdf = 0.0;
    l.radiance = vec3(0.0);
    l.delta = false;
    l.infinite = false;
    l.material = 0u;
    l.barycentrics = vec2(0.0);
    // If no emitter can contribute, the word is not that of a primitive, so there is no record to
    // read.
    if (CHOOSES_BY_PLACE) {
        if (!(choice.pick > 0.0))
            return l;
    }
    bool is_point = HAS_EMITTER(EMITTERS_LIGHTS) && (l.primitive & PRIMITIVE_LIGHT) != 0u;
    bool is_environment = HAS_EMITTER(EMITTER_ENVIRONMENT) && l.primitive == PRIMITIVE_ENVIRONMENT;
    bool is_shape = HAS_EMITTER(EMITTERS_SHAPES) && !is_point && !is_environment &&
                    (HAS_EMITTER(EMITTER_TRIANGLES) ? (l.primitive & PRIMITIVE_SHAPE) != 0u
                                                     : true);
    if (HAS_EMITTER(EMITTER_TRIANGLES) && !is_shape && !is_point && !is_environment)
        sample_triangle_light(origin, l.primitive, choice.pick, u, l);
    if (is_shape)
        sample_shape_light(origin, l.primitive & ~PRIMITIVE_SHAPE, choice.pick, u, l);
    if ((HAS(FEATURE_TEXTURES) || HAS(FEATURE_ALPHA)) && !is_point && !is_environment)
        texture_light(origin, l);
    if (is_point)
        sample_point_light(origin, l.primitive & ~PRIMITIVE_LIGHT, choice, u, l);
    if (is_environment)
        sample_environment_light(choice.of_lamp ? 1.0 : frame.environment_pick, u, l);
#ifdef PLANTED_PDF_FACTOR // planted fault, which tests must detect: a wrong density
    l.pdf *= PLANTED_PDF_FACTOR;
#endif
    return l;
}

// Samples a point on an emitter. u: selects the emitter; the point on it, x, y; more bits for the
// emitter.
light_sample sample_light(receiver r, vec4 u)
{
    return sample_emitter(r.position, choose_light(r, u.xw), u.yz);
}

// Samples a point on a lamp, when each lamp has its own shadow ray. u.xy selects the point on the
// emitter, u.zw the emitter of the lamp.
light_sample sample_lamp(receiver r, uint lamp, vec4 u)
{
    float probability;
    uint primitive = choose_in_lamp(lamp, r, u.zw, probability);
    return sample_emitter(r.position, light_choice(primitive, probability, true), u.xy);
}

// Returns, from the material's word, whether light from behind the surface may continue to the
// viewer.
bool is_lit_from_both_sides(uint material)
{
    return (material >> MATERIAL_CLASS_SHIFT & MATERIAL_CLASS_MASK) == CLASS_TRANSMISSIVE;
}

// Returns the origin of a ray as a receiver, from the primitive and the instance on which the ray
// starts.
receiver receiver_of(vec3 origin, vec3 direction, uint primitive, uint instance)
{
    bool is_shape = IS_SHAPE(primitive);
    vec3 normal = vec3(0.0);
    uint material = 0u;
    if (HAS(FEATURE_TRIANGLES) && !is_shape) {
        triangle_record t = load_triangle(primitive);
        normal = triangle_normal(t);
        material = t.word;
        if (HAS_GEOMETRY(GEOMETRY_INSTANCES) && instance != NO_INSTANCE) {
            normal = normalize_any(load_instance_inverse(instance).rows * normal);
            material = instance_material(instance, material);
        }
    }
    if (is_shape) {
        shape_record shape = load_shape(primitive & ~PRIMITIVE_SHAPE);
        normal = shape_normal_at(shape, origin);
        material = shape.word;
    }
    return receiver(origin, dot(normal, direction) < 0.0 ? -normal : normal,
                    is_lit_from_both_sides(material));
}

// Returns the density per unit of area with which the point of an emitter that a ray has hit would
// be selected. `m` is the emitter's material, whose pick density is not 0. The ray starts on
// primitive `from` of an instance, or of no instance.
float pick_density_at(material m, uint primitive, vec3 origin, vec3 direction, uint from,
                      uint from_instance)
{
    bool is_shape = HAS_EMITTER(EMITTERS_SHAPES) &&
                    (HAS_EMITTER(EMITTER_TRIANGLES) ? (primitive & PRIMITIVE_SHAPE) != 0u : true);
    uint index = primitive & ~PRIMITIVE_SHAPE;
    if (LIGHT_CHOICE == LIGHT_CHOICE_POWER) {
        // All emitters with the same material have the same density, except convex shapes, of which
        // only the visible part is sampled.
        if (HAS_EMITTER(EMITTERS_CONVEX) && is_shape)
            return shape_density(load_shape(index), m, 1.0, origin);
        return material_pick_density(m);
    }
    float area;
    uint emitter;
    if (is_shape) {
        area = shape_area_visible(load_shape(index), origin);
        emitter = load_shapes(index * SHAPE_WORDS + 2u).x;
    } else {
        triangle_record t = load_triangle(primitive);
        area = triangle_area(t);
        emitter = emitter_of(t);
    }
    float pick = 1.0 / float(frame.emitter_count);
    if (CHOOSES_BY_PLACE) {
        receiver r = receiver_of(origin, direction, from, from_instance);
        bool by_lamp = false;
        if (LIGHT_CHOICE == LIGHT_CHOICE_ALL) {
            by_lamp = connected_to_each();
            if (by_lamp)
                pick = probability_in_lamp(r, emitter);
        }
        if (!CONNECTS_ALWAYS_TO_EACH) {
            if (!by_lamp)
                pick = probability_in_tree(r, emitter);
        }
    }
    return pick / area;
}

#endif
