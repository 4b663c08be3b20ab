#include "bsdf_reference.h"

#include <math.h>
#include <stdlib.h>

bool reference_init(struct reference *reference, const struct material *material,
                    struct bsdf_choices choices, const float wo[3], float eta)
{
    *reference = (struct reference){.material = material, .choices = choices, .eta = (double)eta};
    for (int c = 0; c < 3; c++)
        reference->wo[c] = (double)wo[c];
    optics_normalize(reference->wo);
    if (material->model == MATERIAL_DIELECTRIC)
        dielectric_prepare(reference);
    return material->model != MATERIAL_PRINCIPLED || principled_prepare(reference);
}

void reference_finish(struct reference *reference)
{
    free(reference->principled);
    reference->principled = NULL;
}

// The density is D itself if all normals are sampled (Walter et al. 2007, section 5.3).
double reference_normal_density(const struct reference *r, const double wo[3], const double h[3],
                                const double alpha[2])
{
    if (r->choices.normals == NORMALS_NDF)
        return ggx_density(h, alpha) * h[2];
    return ggx_visible_density(wo, h, alpha);
}

double reference_reflected_density(const struct reference *r, const double wo[3], const double h[3],
                                   const double alpha[2])
{
    if (r->choices.normals == NORMALS_NDF)
        return ggx_density(h, alpha) * h[2] / (4 * optics_dot(wo, h));
    return ggx_reflected_density(wo, h, alpha);
}

double reference_divisor(const struct reference *r, double eta)
{
    return r->choices.unscaled ? 1 : eta * eta;
}

static double lambert_eval(const struct material *m, const double wi[3], double f[3])
{
    double pdf = fmax(wi[2], 0) / M_PI;
    for (int c = 0; c < 3; c++)
        f[c] = (double)m->base_color[c] * pdf;
    return pdf;
}

double reference_eval(const struct reference *reference, const double direction[3], double f[3])
{
    double wi[3] = {direction[0], direction[1], direction[2]};
    f[0] = f[1] = f[2] = 0;
    optics_normalize(wi);
    switch (reference->material->model) {
    case MATERIAL_LAMBERT:
        return lambert_eval(reference->material, wi, f);
    case MATERIAL_PRINCIPLED:
        return principled_eval(reference, wi, f);
    case MATERIAL_DIELECTRIC:
        return dielectric_eval(reference, wi, f);
    case MATERIAL_CONDUCTOR:
        return conductor_eval(reference, wi, f);
    case MATERIAL_PHONG:
    case MATERIAL_BLINN_PHONG:
    case MATERIAL_MICROFACET:
        return classical_eval(reference, wi, f);
    default:
        return 0;
    }
}

static int mirror_deltas(const struct reference *reference, struct reference_delta *out)
{
    *out = (struct reference_delta){
        {-reference->wo[0], -reference->wo[1], reference->wo[2]}, 1, {0}, false};
    for (int c = 0; c < 3; c++)
        out->weight[c] = (double)reference->material->base_color[c];
    return 1;
}

int reference_deltas(const struct reference *reference,
                     struct reference_delta out[REFERENCE_MAX_DELTAS])
{
    switch (reference->material->model) {
    case MATERIAL_MIRROR:
        return mirror_deltas(reference, out);
    case MATERIAL_PRINCIPLED:
        return principled_deltas(reference, out);
    case MATERIAL_DIELECTRIC:
        return dielectric_deltas(reference, out);
    case MATERIAL_CONDUCTOR:
        return conductor_deltas(reference, out);
    case MATERIAL_MICROFACET:
        return classical_deltas(reference, out);
    default:
        return 0;
    }
}

bool reference_hides_refraction(const struct reference *reference)
{
    switch (reference->material->model) {
    case MATERIAL_PRINCIPLED:
        return principled_hides_refraction(reference);
    case MATERIAL_DIELECTRIC:
        return dielectric_hides_refraction(reference);
    default:
        return false;
    }
}

double reference_hidden_normal(const struct reference *reference, const double h[3])
{
    const double *wo = reference->wo;
    double cosine = optics_dot(wo, h), ratio = 1 / reference->eta;
    // Only if the direction leaves on the other side.
    double beyond = optics_cos_refracted(cosine, reference->eta);
    if (!(cosine > 0) || beyond == 0 || !((ratio * cosine - beyond) * h[2] - ratio * wo[2] < 0))
        return 0;
    return reference->material->model == MATERIAL_PRINCIPLED
               ? principled_through_normal(reference, h)
               : dielectric_through_normal(reference, h);
}

double reference_true_survival(const struct reference *reference)
{
    return reference->material->model == MATERIAL_PRINCIPLED ? principled_true_survival(reference)
                                                             : dielectric_true_survival(reference);
}
