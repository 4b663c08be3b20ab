// A point of an emitter that was chosen to connect to.
#ifndef LIGHT_TYPES_GLSL
#define LIGHT_TYPES_GLSL

#include "lib/constants.glsl"
#include "lib/material.glsl"

struct light_sample {
    vec3 to_light;  // from the reference point to the sampled one
    float pdf;      // per solid angle at the reference point, the choice of the emitter included
    vec3 radiance;
    uint primitive;
    bool delta; // a delta light: nothing else finds it, so that its weight is 1; `radiance` is the
                // irradiance of a surface that faces it, and `pdf` that of the choice alone
    bool infinite;     // infinitely far, whatever the length of to_light
    uint material;     // word of a primitive's
    vec2 barycentrics; // the point on a triangle; on a shape see struct crossings
};

float pdf_area_to_solid_angle(float density, float distance, float cos_light)
{
    return cos_light > 0.0 ? density * distance * distance / cos_light : 0.0;
}

// A point chosen uniformly by area: the vector to it and its surface normal give the density.
// `density`: of choosing the emitter and a point on it, a unit area. By power it is the same for
// all of one material, boxes and cylinders aside, so that no lookup is needed to weight a hit.
void finish_area_sample(inout light_sample l, vec3 to_light, vec3 normal, material m, float density)
{
    float distance = length(to_light);
    float cos_light = abs(dot(to_light, normal)) / distance;
    l.to_light = to_light;
    l.pdf = pdf_area_to_solid_angle(density, distance, cos_light);
    l.radiance = material_emission(m);
}

#endif
