// Two scattered paths at a vertex, one diffuse and one specular, at the first frame.split_lobes
// vertices of a path: the lobes of a material that has both are split into
//
//   f = f_d + f_s    d: Lambert, subsurface, sheen, fibres, diffuse transmission
//                    s: reflection and refraction by microfacets, coat, Phong's and Blinn's lobes
//
// and the integral of f L cos into one of each part, which have a sample each, of density p_d and
// p_s (Arvo and Kirk 1990 call that splitting). So the choice of a lobe adds no variance, and no
// weight is divided by its probability.
//
// Each part is estimated by shadow rays, too. By the multi-sample model (Veach 1997, eq. 9.4) the
// estimate of part i is w_i L f_i cos / p_i for what its branch finds and (1 - w_i) L f_i cos / p_l
// for what the shadow ray finds, with weights w_i of p_i against p_l alone: the other branch draws
// no sample of this part. One shadow ray serves both parts,
//
//   L cos (f_d (1 - w_d) + f_s (1 - w_s)) / p_l,
//
// and what a branch finds is weighted by its own density, which stands in the path's record as
// ever. Lobes that are perfectly specular have no density, and a weight of 1.
//
// The diffuse branch stays in the slot of the vertex. The specular one goes on in a slot of its own
// among the 2^split_lobes that the sample has: at vertex n, half of what is left to the slot.
#ifndef SPLIT_GLSL
#define SPLIT_GLSL

#include "lib/sampler.glsl"
#include "lib/scatter.glsl"

// Tested on its own, so that the code that it excludes is removed.
#define CAN_SPLIT (HAS(FEATURE_SPLIT_LOBES) && HAS_LOBE(LOBES_OF_TWO_PARTS))

// Returns whether this path splits at the vertex that is being shaded, with material m. A part that
// is black ends its branch.
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

// Takes the specular branch on in the slot `branch`; false where it ends.
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
