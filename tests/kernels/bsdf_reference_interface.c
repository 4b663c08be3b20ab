// Dielectrics and conductors; docs/materials-classical.md.
#include "bsdf_albedo.h"
#include "bsdf_reference.h"

#include <math.h>

static double alpha_of(const struct material *m)
{
    return optics_alpha(m->roughness);
}

static bool is_thin(const struct material *m)
{
    return m->flags & MATERIAL_THIN;
}

static bool is_straight(const struct reference *r)
{
    return fabs(r->eta - 1) <= 6 * 0x1p-24;
}

// Of a slab without thickness: all orders of reflection between its faces.
static double reflectance(const struct reference *r, double cosine)
{
    double one = optics_fresnel(fmin(cosine, 1), r->eta);
    return is_thin(r->material) ? 2 * one / (1 + one) : one;
}

static void set_all(double f[3], double value)
{
    f[0] = f[1] = f[2] = value;
}

// What single scattering loses, given back to it: of a lossless interface all.
static double compensation(const struct reference *r)
{
    double alpha = alpha_of(r->material);
    if (!(r->material->flags & MATERIAL_COMPENSATE))
        return 1;
    return 1 / (is_thin(r->material) ? table_ggx(r->wo[2], alpha)
                                     : table_glass(r->wo[2], alpha, r->eta));
}

// --- dielectric ----------------------------------------------------------------------------------

static double reflected(const struct reference *r, const double wi[3], bool through, double f[3])
{
    double alpha[2] = {alpha_of(r->material), alpha_of(r->material)}, h[3];
    bool separable = r->material->flags & MATERIAL_SEPARABLE;
    double cosine = optics_half_reflected(r->wo, wi, h), part = reflectance(r, cosine);
    part = through ? 1 - part : part;
    set_all(f, compensation(r) * part * ggx_density(h, alpha) *
                   ggx_masking_both(r->wo, wi, alpha, separable) / (4 * r->wo[2]));
    return part * ggx_reflected_density(r->wo, h, alpha);
}

double dielectric_eval(const struct reference *r, const double wi[3], double f[3])
{
    double alpha[2] = {alpha_of(r->material), alpha_of(r->material)}, h[3];
    if (is_straight(r) || alpha[0] < SMALLEST_ALPHA || wi[2] == 0)
        return 0;
    if (wi[2] > 0)
        return reflected(r, wi, false, f);
    if (is_thin(r->material)) {
        const double mirrored[3] = {wi[0], wi[1], -wi[2]};
        return reflected(r, mirrored, true, f);
    }
    if (dielectric_hides_refraction(r))
        return 0;
    double jacobian = optics_half_refracted(r->wo, wi, r->eta, h);
    if (!(jacobian > 0))
        return 0;
    double cosine = optics_dot(r->wo, h), part = 1 - reflectance(r, cosine);
    set_all(f, compensation(r) * part * ggx_density(h, alpha) *
                   ggx_masking_both(r->wo, wi, alpha, false) * cosine / r->wo[2] * jacobian /
                   (r->eta * r->eta));
    return part * ggx_visible_density(r->wo, h, alpha) * jacobian;
}

bool dielectric_hides_refraction(const struct reference *r)
{
    double alpha = alpha_of(r->material);
    return !is_thin(r->material) && !is_straight(r) && alpha >= SMALLEST_ALPHA &&
           alpha * fabs(r->eta - 1) < 0x1p-17;
}

double dielectric_through_normal(const struct reference *r, const double h[3])
{
    double alpha[2] = {alpha_of(r->material), alpha_of(r->material)};
    return (1 - reflectance(r, optics_dot(r->wo, h))) * ggx_visible_density(r->wo, h, alpha);
}

int dielectric_deltas(const struct reference *r, struct reference_delta *out)
{
    const double *wo = r->wo;
    if (is_straight(r)) {
        out[0] = (struct reference_delta){{-wo[0], -wo[1], -wo[2]}, 1, {1, 1, 1}, true};
        return 1;
    }
    if (alpha_of(r->material) >= SMALLEST_ALPHA)
        return 0;
    double part = reflectance(r, wo[2]), scale = 1 / (r->eta * r->eta);
    double beyond = optics_cos_refracted(wo[2], r->eta);
    out[0] = (struct reference_delta){{-wo[0], -wo[1], wo[2]}, part, {1, 1, 1}, false};
    out[1] = (struct reference_delta){
        {-wo[0] / r->eta, -wo[1] / r->eta, -beyond}, 1 - part, {scale, scale, scale}, true};
    if (is_thin(r->material))
        out[1] = (struct reference_delta){{-wo[0], -wo[1], -wo[2]}, 1 - part, {1, 1, 1}, true};
    return 2;
}

// --- conductor -----------------------------------------------------------------------------------

static void conductor_reflectance(const struct reference *r, double cosine, double out[3])
{
    const struct material *m = r->material;
    double outside = (double)m->ior / r->eta;
    for (int c = 0; c < 3; c++)
        out[c] = optics_fresnel_conductor(fmin(cosine, 1), (double)m->conductor_eta[c] / outside,
                                          (double)m->conductor_k[c] / outside);
}

double conductor_eval(const struct reference *r, const double wi[3], double f[3])
{
    double alpha[2] = {alpha_of(r->material), alpha_of(r->material)}, h[3], part[3];
    bool separable = r->material->flags & MATERIAL_SEPARABLE;
    if (alpha[0] < SMALLEST_ALPHA || !(wi[2] > 0))
        return 0;
    double cosine = optics_half_reflected(r->wo, wi, h), normal[3];
    double e1 = table_ggx(r->wo[2], alpha[0]);
    conductor_reflectance(r, cosine, part);
    conductor_reflectance(r, 1, normal);
    for (int c = 0; c < 3; c++)
        part[c] *= r->material->flags & MATERIAL_COMPENSATE ? 1 + normal[c] * (1 - e1) / e1 : 1;
    for (int c = 0; c < 3; c++)
        f[c] = part[c] * ggx_density(h, alpha) * ggx_masking_both(r->wo, wi, alpha, separable) /
               (4 * r->wo[2]);
    return ggx_reflected_density(r->wo, h, alpha);
}

int conductor_deltas(const struct reference *r, struct reference_delta *out)
{
    if (alpha_of(r->material) >= SMALLEST_ALPHA)
        return 0;
    *out = (struct reference_delta){{-r->wo[0], -r->wo[1], r->wo[2]}, 1, {0}, false};
    conductor_reflectance(r, r->wo[2], out->weight);
    return 1;
}
