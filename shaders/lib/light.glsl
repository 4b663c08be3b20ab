// Next-event estimation: sampling a point on an emitter, and the density with which that would
// have happened. sample_light and pdf_light must agree for the weights of MIS to sum to one.
#ifndef LIGHT_GLSL
#define LIGHT_GLSL

#include "lib/material.glsl"
#include "lib/sampling.glsl"
#include "lib/surface.glsl"

struct light_sample {
    vec3 to_light;  // from the reference point to the sampled one
    float pdf;      // per solid angle at the reference point, the choice of the emitter included
    vec3 radiance;
    uint primitive;
};

// 1 - cos of the half-angle under which a sphere is seen, from sin^2 of it; does not cancel.
float sphere_cone(float sin2_max)
{
    return sin2_max / (1.0 + sqrt(max(0.0, 1.0 - sin2_max)));
}

// Density per solid angle of a direction that reaches a sphere from outside it: uniform in the cone.
float pdf_sphere_cone(float radius, float sin2_max, float pick_density)
{
    float pick = pick_density * 4.0 * PI * radius * radius;
    return pick / (2.0 * PI * sphere_cone(sin2_max));
}

float pdf_area_to_solid_angle(float density, float distance, float cos_light)
{
    return cos_light > 0.0 ? density * distance * distance / cos_light : 0.0;
}

// Density per solid angle with which sample_light() would have chosen the unit `direction` from
// `origin`, given the surface that it hits at `distance`.
float pdf_light(vec3 origin, vec3 direction, float distance, surface s, float pick_density)
{
    if (HAS(FEATURE_EMISSIVE_SPHERES) && s.radius > 0.0) {
        vec3 to_center = s.center - origin;
        float sin2_max = s.radius * s.radius / dot(to_center, to_center);
        if (sin2_max < 1.0)
            return pdf_sphere_cone(s.radius, sin2_max, pick_density);
    }
    return pdf_area_to_solid_angle(pick_density, distance,
                                   abs(dot(direction, s.normal_geometric)));
}

// A point chosen uniformly by area: the vector to it and its surface normal give the density.
void finish_area_sample(inout light_sample l, vec3 to_light, vec3 normal, material m)
{
    float distance = length(to_light);
    float cos_light = abs(dot(to_light, normal)) / distance;
    l.to_light = to_light;
    l.pdf = pdf_area_to_solid_angle(m.group[GROUP_EMISSION].a, distance, cos_light);
    l.radiance = m.group[GROUP_EMISSION].rgb;
}

void sample_triangle_light(vec3 origin, uint index, vec2 u, inout light_sample l)
{
    vec3 v0 = load_triangles_float(index * 3u).xyz;
    uvec4 w1 = load_triangles(index * 3u + 1u);
    vec3 v1 = uintBitsToFloat(w1.xyz);
    vec3 v2 = load_triangles_float(index * 3u + 2u).xyz;
    vec2 b = sample_triangle(u);
    vec3 point = v0 + b.x * (v1 - v0) + b.y * (v2 - v0);
    finish_area_sample(l, point - origin, normalize(cross(v1 - v0, v2 - v0)),
                       load_material(w1.w));
}

// From outside uniformly in the cone that the sphere fills, to its near side; from inside by area.
void sample_sphere_light(vec3 origin, vec3 center, float radius, material m, vec2 u,
                         inout light_sample l)
{
    vec3 to_center = center - origin;
    float distance2 = dot(to_center, to_center);
    float sin2_max = radius * radius / distance2;
    if (sin2_max < 1.0) {
        float distance = sqrt(distance2);
        float one_minus_cos = u.x * sphere_cone(sin2_max);
        float cos_theta = 1.0 - one_minus_cos;
        float sin2_theta = one_minus_cos * (2.0 - one_minus_cos);
        float angle = 2.0 * PI * u.y;
        vec3 local = vec3(sqrt(sin2_theta) * vec2(cos(angle), sin(angle)), cos_theta);
        float half_chord = sqrt(max(0.0, radius * radius - distance2 * sin2_theta));
        l.to_light = basis_around(to_center / distance) * local *
                     (distance * cos_theta - half_chord);
        l.pdf = pdf_sphere_cone(radius, sin2_max, m.group[GROUP_EMISSION].a);
        l.radiance = m.group[GROUP_EMISSION].rgb;
    } else {
        vec3 normal = sample_sphere(u);
        finish_area_sample(l, to_center + radius * normal, normal, m);
    }
}

void sample_shape_light(vec3 origin, uint index, vec2 u, inout light_sample l)
{
    vec4 w0 = load_shapes_float(index * 2u);
    uvec4 w1 = load_shapes(index * 2u + 1u);
    uint kind = w1.w >> SHAPE_KIND_SHIFT;
    material m = load_material(w1.w);
    if (HAS(FEATURE_EMISSIVE_SPHERES) && kind == SHAPE_KIND_SPHERE)
        sample_sphere_light(origin, w0.xyz, w0.w, m, u, l);
    if (HAS(FEATURE_EMISSIVE_DISCS) && kind == SHAPE_KIND_DISC) {
        vec3 normal = uintBitsToFloat(w1.xyz);
        vec2 d = w0.w * sample_disc(u);
        mat3 basis = basis_around(normal);
        finish_area_sample(l, w0.xyz + basis[0] * d.x + basis[1] * d.y - origin, normal, m);
    }
}

// Chooses an emitter in proportion to its power by the alias table (Walker 1977; Vose 1991), then a
// point on it. A pdf of 0 means that there is nothing to connect to.
light_sample sample_light(vec3 origin, vec3 u)
{
    float scaled = u.x * float(push.emitter_count);
    uint bin = min(uint(scaled), push.emitter_count - 1u);
    uvec4 emitter = load_emitters(bin);
    bool own = scaled - float(bin) < uintBitsToFloat(emitter.x);

    light_sample l;
    l.primitive = own ? emitter.y : emitter.z;
    l.to_light = vec3(0.0);
    l.pdf = 0.0;
    l.radiance = vec3(0.0);
    bool is_shape = (HAS(FEATURE_EMISSIVE_SPHERES) || HAS(FEATURE_EMISSIVE_DISCS)) &&
                    (HAS(FEATURE_EMISSIVE_TRIANGLES) ? (l.primitive & PRIMITIVE_SHAPE) != 0u
                                                     : true);
    if (HAS(FEATURE_EMISSIVE_TRIANGLES) && !is_shape)
        sample_triangle_light(origin, l.primitive, u.yz, l);
    if (is_shape)
        sample_shape_light(origin, l.primitive & ~PRIMITIVE_SHAPE, u.yz, l);
    return l;
}

#endif
