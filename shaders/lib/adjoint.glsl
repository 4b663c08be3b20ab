// Scatters light paths. BSDFs are evaluated with the same arguments as for a camera path that
// arrives from the opposite end, so that asymmetric models and normals that were bent towards the
// viewer have the same values for both kinds of path.
#ifndef ADJOINT_GLSL
#define ADJOINT_GLSL

#include "lib/sampler.glsl"
#include "lib/texture.glsl"
#include "lib/vertex.glsl"

// Returns the vertex as seen from the unit direction `viewer`.
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

// Returns the BSDF times the cosine of v.view, for light that arrives from v.view and leaves in
// direction `onwards`. pdf: the density with which a camera path that arrives from `onwards` is
// scattered to v.view.
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

// Returns whether delta scattering from v.view to `onwards` can be reversed, so that a path that
// arrives from `onwards` leaves to v.view. It cannot be reversed if the normal was bent for either
// direction.
bool is_reversible(vertex v, vec3 onwards)
{
    if (!HAS(FEATURE_NORMALS) && !HAS(FEATURE_NORMAL_MAPS))
        return true;
    vertex other = seen_from(v, onwards);
    vec3 n = dot(other.frame[2], v.frame[2]) < 0.0 ? -other.frame[2] : other.frame[2];
    return all(equal(n, v.frame[2])) && sides_agree(other, v.view, v.view * other.frame);
}

// Returns the correction of a light path's BSDF for shading normals (Veach 1997, eq. 5.20), apart
// from the cosines with the shading normal, which are part of the BSDF: the ratio of the two
// directions' cosines with the geometric normal.
float measure_ratio(vertex v, vec3 onwards)
{
    return abs(dot(onwards, v.s.normal_geometric) / dot(v.view, v.s.normal_geometric));
}

// Returns the weight of light that passes straight through a principled base, without the scaling
// of radiance.
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

// Returns the factor that converts the weight of a delta sample of a camera path into that of a
// light path. Refraction scales radiance, but not the flux of light paths; and asymmetric layers
// must be evaluated as seen from `onwards`. Reflection is symmetric.
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
