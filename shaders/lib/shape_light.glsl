// Sampling points on shapes that emit, and the density with which that happens.
#ifndef SHAPE_LIGHT_GLSL
#define SHAPE_LIGHT_GLSL

#include "lib/light_types.glsl"
#include "lib/material.glsl"
#include "lib/primitive.glsl"
#include "lib/sampling.glsl"
#include "lib/surface.glsl"

// 1 - cos of the half-angle under which a sphere is seen, from sin^2 of it; does not cancel.
float sphere_cone(float sin2_max)
{
    return sin2_max / (1.0 + sqrt(max(0.0, 1.0 - sin2_max)));
}

// Density per solid angle of a direction that reaches a sphere from outside it: uniform in the
// cone.
float pdf_sphere_cone(float radius, float sin2_max, float pick_density)
{
    float pick = pick_density * 4.0 * PI * radius * radius;
    return pick / (2.0 * PI * sphere_cone(sin2_max));
}

float shape_area(uint kind, float radius)
{
    return (kind == SHAPE_KIND_SPHERE ? 4.0 : 1.0) * PI * radius * radius;
}

// From outside uniformly in the cone that the sphere fills, to its near side; from inside by area.
void sample_sphere_light(vec3 origin, vec3 center, float radius, material m, float density, vec2 u,
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
        l.pdf = pdf_sphere_cone(radius, sin2_max, density);
        l.radiance = m.group[GROUP_EMISSION].rgb;
    } else {
        vec3 normal = sample_sphere(u);
        finish_area_sample(l, to_center + radius * normal, normal, m, density);
    }
}

void sample_shape_light(vec3 origin, uint index, float pick, vec2 u, inout light_sample l)
{
    vec4 w0 = load_shapes_float(index * SHAPE_WORDS);
    uvec4 w1 = load_shapes(index * SHAPE_WORDS + 1u);
    uint kind = w1.w >> SHAPE_KIND_SHIFT;
    material m = load_material(w1.w);
    float density = m.group[GROUP_EMISSION].a;
    if (LIGHT_CHOICE != LIGHT_CHOICE_POWER)
        density = pick / shape_area(kind, w0.w);
    l.material = w1.w;
    if (HAS_EMITTER(EMITTER_SPHERES) && kind == SHAPE_KIND_SPHERE)
        sample_sphere_light(origin, w0.xyz, w0.w, m, density, u, l);
    if (HAS_EMITTER(EMITTER_DISCS) && kind == SHAPE_KIND_DISC) {
        vec3 normal = uintBitsToFloat(w1.xyz);
        vec2 d = w0.w * sample_disc(u);
        mat3 basis = basis_around(normal);
        finish_area_sample(l, w0.xyz + basis[0] * d.x + basis[1] * d.y - origin, normal, m,
                           density);
    }
}

#endif
