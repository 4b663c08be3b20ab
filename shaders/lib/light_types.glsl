// Defines the type of a sampled point on an emitter.
#ifndef LIGHT_TYPES_GLSL
#define LIGHT_TYPES_GLSL

#include "lib/constants.glsl"
#include "lib/material.glsl"

struct light_sample {
    vec3 to_light;  // from the reference point to the sampled point
    float pdf;      // per solid angle at the reference point, including the selection of the
                    // emitter
    vec3 radiance;
    uint primitive;
    bool delta; // a delta light: no other strategy finds it, so its MIS weight is 1; `radiance` is
                // then the irradiance of a surface that faces it, and `pdf` the selection
                // probability
    bool infinite;     // infinitely far away, whatever the length of to_light
    uint material;     // material word of a primitive
    vec2 barycentrics; // coordinates of the point on a triangle; for a shape see struct crossings
};

float pdf_area_to_solid_angle(float density, float distance, float cos_light)
{
    return cos_light > 0.0 ? density * distance * distance / cos_light : 0.0;
}

// Completes a point that was sampled uniformly by area: its density per solid angle follows from
// the vector to it and its normal. density: the density per unit of area of selecting the emitter
// and the point. With selection by power it is the same for all emitters of a material except boxes
// and cylinders, so MIS weights of hits need no table lookup.
void finish_area_sample(inout light_sample l, vec3 to_light, vec3 normal, material m, float density)
{
    float distance = length(to_light);
    float cos_light = abs(dot(to_light, normal)) / distance;
    l.to_light = to_light;
    l.pdf = pdf_area_to_solid_angle(density, distance, cos_light);
    l.radiance = material_emission(m);
}

#endif
