// Defines conventions and types for all parts of lib/bsdf.glsl. All functions are pure.
#ifndef BSDF_TYPES_GLSL
#define BSDF_TYPES_GLSL

#include "lib/material.glsl"

// Returns the number by which refraction divides radiance: eta^2; or 1 if the setting
// `radiance_scaling` is off, as if radiance were the power in a beam whose solid angle does not
// change.
float refraction_divisor(float eta)
{
    return RADIANCE_SCALING != 0u ? eta * eta : 1.0;
}

struct bsdf_sample {
    vec3 wi;
    vec3 weight;      // BSDF * |wi.z| / pdf
    float pdf;        // per solid angle; 0 if `specular`
    bool specular;    // a Dirac delta: no other strategy samples this direction
    bool transmitted; // wi is on the other side
    bool valid;       // false: absorbed
};

// Each model has these two functions:
//   bsdf_sample sample_MODEL(material m, vec3 wo, float eta, vec4 u)
//     u: direction x, y; choice of the lobe; a second choice
//   vec3 eval_MODEL(material m, vec3 wo, vec3 wi, float eta, out float pdf)
//     BSDF * |wi.z| of all lobes that are not delta, and the density with which sample_MODEL
//     samples wi
// The weight of a sample that is not a delta is eval / pdf for the same wi.

// Returns whether the material is restricted to this part of its lobes, MATERIAL_DIFFUSE_PART or
// MATERIAL_SPECULAR_PART. The BSDFs of both parts add up to the material's, and each part has a
// density of its own; lib/split.glsl lists the lobes of each part.
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
