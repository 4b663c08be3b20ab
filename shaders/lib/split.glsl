// Splits paths: at the first frame.split_lobes vertices of a path, two rays are scattered, a
// diffuse and a specular one. The lobes of a material that has both are divided into
//
//   f = f_d + f_s    d: Lambert, subsurface, sheen, fibres, diffuse transmission
//                    s: reflection and refraction by microfacets, coat, Phong's and Blinn's lobes
//
// and the integral of f L cos into one for each part. Each has its own sample, with densities p_d
// and p_s ("splitting", Arvo and Kirk 1990). So the selection of a lobe adds no variance, and no
// weight is divided by its probability.
//
// Shadow rays sample each part, too. By the multi-sample model (Veach 1997, eq. 9.4) the estimate
// of part i is w_i L f_i cos / p_i for the part's branch, and (1 - w_i) L f_i cos / p_l for the
// shadow ray. The weights w_i compare p_i and p_l only, because the other branch does not sample
// this part. One shadow ray serves both parts,
//
//   L cos (f_d (1 - w_d) + f_s (1 - w_s)) / p_l,
//
// and the contribution of a branch is weighted by the branch's own density, which the path's record
// has as usual. Delta lobes have no density, and a weight of 1.
//
// The diffuse branch stays in the slot of the vertex. The specular one continues in another of the
// 2^split_lobes slots of the sample: at each vertex, a branch passes half of its slots on.
#ifndef SPLIT_GLSL
#define SPLIT_GLSL

#include "lib/sampler.glsl"
#include "lib/scatter.glsl"

// This is a separate macro, so that compilers remove the excluded code.
#define CAN_SPLIT (HAS(FEATURE_SPLIT_LOBES) && HAS_LOBE(LOBES_OF_TWO_PARTS))

// Returns whether the path splits at the vertex that is being shaded, with material m. If a part is
// black, its branch ends.
bool splits_lobes(material m)
{
    uint model = material_model(m);
    bool has_parts = model == MATERIAL_PRINCIPLED || model == MATERIAL_PHONG ||
                     model == MATERIAL_BLINN_PHONG || model == MATERIAL_MICROFACET;
    return has_parts && push.bounce < frame.split_lobes;
}

uint branch_slot(uint slot)
{
    return slot + (slots_a_sample() >> (push.bounce + 1u));
}

// Continues the specular branch in slot `branch`; returns false if it ends.
bool go_on_specular(vertex v, uint branch, vec3 direction, uint stack)
{
    v.slot = branch;
    v.m = part_of(v.m, MATERIAL_SPECULAR_PART);
    vec4 u = uniforms(branch, bounce_dimension(push.bounce, DIMENSION_BSDF));
    float u_roulette = 0.0;
    if (HAS(FEATURE_ROULETTE))
        u_roulette = uniforms(branch, bounce_dimension(push.bounce, DIMENSION_LIGHT)).w;
    return go_on(v, direction, false, stack, u, 0.0, u_roulette);
}

#endif
