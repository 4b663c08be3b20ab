// Scattering of light paths. BSDFs are evaluated with the arguments that camera paths give them, so
// that models that are not symmetric, and normals that are bent towards the viewer, have the same
// values for both.
#ifndef ADJOINT_GLSL
#define ADJOINT_GLSL

#include "lib/sampler.glsl"
#include "lib/texture.glsl"
#include "lib/vertex.glsl"

// Returns the vertex as it is seen from a unit direction.
vertex seen_from(vertex v, vec3 viewer)
{
    if (dot(viewer, v.s.normal_geometric) < 0.0) {
        v.s.normal_geometric = -v.s.normal_geometric;
        v.s.normal_shading = -v.s.normal_shading;
        if (HAS_TANGENT)
            v.s.tangent = -v.s.tangent;
        v.s.front = !v.s.front;
        if (HAS(FEATURE_MEDIA) && v.m.medium != 0u)
            v.eta = 1.0 / v.eta;
    }
    v.frame = shading_frame(v.s, v.m, viewer);
    v.wo = viewer * v.frame;
    v.view = viewer;
    return v;
}

// The BSDF times the cosine of v.view, for light that comes from there and goes to `onwards`, and
// the density with which a path that comes from `onwards` is scattered to v.view.
vec3 eval_reversed(vertex v, vec3 onwards, out float pdf)
{
    vertex other = seen_from(v, onwards);
    vec3 local = v.view * other.frame;
    vec3 f = vec3(0.0);
    pdf = 0.0;
    if (sides_agree(other, v.view, local))
        f = eval_bsdf(other.m, other.wo, local, other.eta, pdf);
    return f;
}

// Returns whether a path that comes from `onwards` is scattered to v.view where one from v.view is
// scattered to `onwards` by a Dirac delta: not if the normal was bent for either of them.
bool is_reversible(vertex v, vec3 onwards)
{
    if (!HAS(FEATURE_NORMALS) && !HAS(FEATURE_NORMAL_MAPS))
        return true;
    vertex other = seen_from(v, onwards);
    vec3 n = dot(other.frame[2], v.frame[2]) < 0.0 ? -other.frame[2] : other.frame[2];
    return all(equal(n, v.frame[2])) && sides_agree(other, v.view, v.view * other.frame);
}

// Returns the factor by which a light path's BSDF is corrected for the shading normal (Veach 1997,
// eq. 5.20), without the cosines with the shading normal itself: the ratio of the cosines of the
// two directions with the geometric normal.
float measure_ratio(vertex v, vec3 onwards)
{
    return abs(dot(onwards, v.s.normal_geometric) / dot(v.view, v.s.normal_geometric));
}

// The light that goes through a principled base in a single direction, without the scale of
// radiance.
vec3 principled_straight(vertex v)
{
    principled p = principled_prepare(v.m, v.wo, v.eta);
    vec3 reflected, through;
    vec2 probabilities;
    float cos_t;
    float exact = fresnel_dielectric(v.wo.z, p.eta, cos_t);
    principled_interface(p, v.wo.z, cos_t, exact, reflected, through, probabilities);
    return through * p.base_layer;
}

// The factor on the weight of a perfectly specular sample that makes it one for light: radiance is
// scaled by refraction, light is not, and layers that are not symmetric are as seen from
// `onwards`. Reflection is symmetric.
vec3 delta_factor(vertex v, vec3 onwards, bool transmitted)
{
    vertex other = seen_from(v, onwards);
    float cosines = measure_ratio(v, onwards) * abs(v.wo.z / other.wo.z);
    vec3 factor = vec3(cosines);
    if (HAS_LOBE(LOBES_THROUGH) && transmitted) {
        if (HAS(FEATURE_MEDIA) && v.m.medium != 0u)
            factor *= RADIANCE_SCALING != 0u ? v.eta * v.eta : 1.0 / (v.eta * v.eta);
        if (HAS_LOBE(LOBE_TRANSMISSION) && material_model(v.m) == MATERIAL_PRINCIPLED) {
            vec3 here = principled_straight(v), there = principled_straight(other);
            factor *= mix(vec3(0.0), there / here, greaterThan(here, vec3(0.0)));
        }
    }
    return factor;
}

#endif
