// Conventions and types that the parts of lib/bsdf.glsl share. Pure.
//
// Local frame: z is the shading normal on the viewer's side, x the tangent; wo (towards the viewer)
// and wi (towards the light) are unit vectors and wo.z > 0. `eta` is the index of refraction beyond
// the surface over the one on wo's side; surfaces without an inside give their own ior over that of
// the medium outside.
//
// BSDFs are of radiance: refraction scales by 1 / eta^2 (Veach 1997, section 5.2), so that the
// radiance inside of glass of index n is n^2 times that outside.
#ifndef BSDF_TYPES_GLSL
#define BSDF_TYPES_GLSL

#include "lib/material.glsl"

// Refraction divides radiance by this: eta^2, or 1 where the setting `radiance_scaling` is off, as
// if light were power in a bundle of rays that does not become narrower.
float refraction_divisor(float eta)
{
    return RADIANCE_SCALING != 0u ? eta * eta : 1.0;
}

struct bsdf_sample {
    vec3 wi;
    vec3 weight;      // BSDF * |wi.z| / pdf
    float pdf;        // per solid angle; 0 where `specular`
    bool specular;    // a Dirac delta: nothing else finds this direction
    bool transmitted; // wi is on the other side
    bool valid;       // false: absorbed
};

// Each model has these two:
//   bsdf_sample sample_MODEL(material m, vec3 wo, float eta, vec4 u)
//     u: direction x, y; choice of the lobe; a second choice
//   vec3 eval_MODEL(material m, vec3 wo, vec3 wi, float eta, out float pdf)
//     BSDF * |wi.z| of all that is not a delta, and the density with which sample_MODEL draws wi
// and the weight of a sample that is no delta is eval / pdf for the same wi.

// Returns whether only this part of the material's lobes is asked for, MATERIAL_DIFFUSE_PART or
// _SPECULAR_PART. The BSDFs of both parts add up to the material's, and each has a density of its
// own; lib/split.glsl says which lobes belong to which part.
bool is_part(material m, uint part)
{
    return HAS(FEATURE_SPLIT_LOBES) && material_has(m, part);
}

material part_of(material m, uint part)
{
    m.model_flags |= part;
    return m;
}

bsdf_sample bsdf_absorbed()
{
    return bsdf_sample(vec3(0.0, 0.0, 1.0), vec3(0.0), 0.0, false, false, false);
}

#endif
