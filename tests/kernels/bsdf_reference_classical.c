// A Lambertian base below a highlight: Phong, Blinn-Phong or microfacets; see
// docs/materials-classical.md.
#include "bsdf_reference.h"

#include <math.h>

// The value of a highlight without its colour (times the cosine), and the density with which it is
// sampled.
struct highlight {
    double value, pdf, fresnel_cosine;
};

static double alpha_of(const struct material *m)
{
    return optics_alpha(m->roughness);
}

// --- Phong and Blinn-Phong -----------------------------------------------------------------------

// Lafortune and Willems 1994, eq. 1 and 9.
static struct highlight phong(const struct reference *r, const double wi[3])
{
    double n = (double)r->material->exponent;
    double mirrored[3] = {-r->wo[0], -r->wo[1], r->wo[2]};
    // Computes the cosine from the length of the difference: 1 - |d|^2 / 2 keeps digits that a dot
    // product rounds away.
    double square = 0;
    for (int c = 0; c < 3; c++)
        square += (wi[c] - mirrored[c]) * (wi[c] - mirrored[c]);
    double cosine = fmax(0, 1 - square / 2), power = cosine > 0 ? pow(cosine, n) : 0;
    return (struct highlight){(n + 2) / (2 * M_PI) * power * wi[2], (n + 1) / (2 * M_PI) * power,
                              0};
}

// Blinn 1977, normalised as Giesen 2009.
static struct highlight blinn_phong(const struct reference *r, const double wi[3])
{
    double n = (double)r->material->exponent, h[3];
    double cosine = optics_half_reflected(r->wo, wi, h);
    double power = pow(1 + (h[0] * h[0] + h[1] * h[1]) / (h[2] * h[2]), -n / 2); // h.z^n
    double norm = (n + 2) * (n + 4) / (8 * M_PI * (pow(2, -n / 2) + n));
    return (struct highlight){norm * power * wi[2], (n + 1) / (2 * M_PI) * power / (4 * cosine),
                              cosine};
}

// --- microfacets ---------------------------------------------------------------------------------

static double distribution(uint32_t kind, const double h[3], double alpha)
{
    double square = (h[0] * h[0] + h[1] * h[1]) / (h[2] * h[2]); // tan^2
    double exponent = 2 / (alpha * alpha) - 2;
    switch (kind) {
    case DISTRIBUTION_BECKMANN: // Walter et al. 2007, eq. 25
        return exp(-square / (alpha * alpha)) / (M_PI * alpha * alpha * pow(h[2], 4));
    case DISTRIBUTION_PHONG: // eq. 30
        return (exponent + 2) / (2 * M_PI) * pow(1 + square, -exponent / 2);
    default:
        return ggx_density(h, (double[2]){alpha, alpha});
    }
}

// 1 / (alpha tan theta), for Phong sqrt(alpha_p / 2 + 1) / tan theta.
static double steepness(const double w[3], double alpha)
{
    return fabs(w[2]) / (alpha * sqrt(w[0] * w[0] + w[1] * w[1]));
}

// Heitz 2014, eq. 66.
static double beckmann_lambda(const double w[3], double alpha)
{
    double a = steepness(w, alpha);
    return isinf(a) ? 0 : (erf(a) - 1) / 2 + exp(-a * a) / (2 * a * sqrt(M_PI));
}

// Returns Lambda of Phong's distribution: Smith's integral over Student's t with 2 k degrees of
// freedom; see docs/materials-classical.md.
static double phong_lambda(const double w[3], double alpha)
{
    // Nodes of the Gauss-Legendre rule of 3 points (DLMF table 3.5.1), in 16 parts.
    static const double node[3] = {0.11270166537925831, 0.5, 0.88729833462074169};
    static const double weight[3] = {5.0 / 18, 8.0 / 18, 5.0 / 18};
    enum { PARTS = 16 };
    double k = 1 / (alpha * alpha), x = fabs(w[2]), sum = 0;
    double c = exp(lgamma(k + 0.5) - lgamma(k)) / sqrt(M_PI);
    double end = fmin(x, 7 / sqrt(k)); // beyond it the integrand is below e^-49
    double sine2 = w[0] * w[0] + w[1] * w[1];
    for (int i = 0; i < PARTS; i++)
        for (int j = 0; j < 3; j++) {
            double y = (i + node[j]) * end / PARTS;
            sum += weight[j] * end / PARTS * exp((k - 1) * log1p(-fmin(y * y, 1)));
        }
    double power = sine2 > 0 ? pow(sine2, k) : 0;
    return fmax(0, c * power / ((2 * k - 1) * x) - 0.5 + c * sum);
}

static double smith_lambda(uint32_t kind, const double w[3], double alpha)
{
    switch (kind) {
    case DISTRIBUTION_BECKMANN:
        return beckmann_lambda(w, alpha);
    case DISTRIBUTION_PHONG:
        return phong_lambda(w, alpha);
    default:
        return ggx_lambda(w, (double[2]){alpha, alpha});
    }
}

// Walter et al. 2007, eq. 27. For other distributions the result is at most Smith's, unless that is
// unbounded.
static double rational(uint32_t kind, const double w[3], double alpha, bool is_bounded)
{
    double a = steepness(w, alpha);
    double value = a < 1.6 ? (3.535 * a + 2.181 * a * a) / (1 + 2.276 * a + 2.577 * a * a) : 1;
    return kind == DISTRIBUTION_BECKMANN || !is_bounded
               ? value
               : fmin(value, 1 / (1 + smith_lambda(kind, w, alpha)));
}

// Schlick 1994, eq. 19.
static double schlick_masking(const double w[3], double k)
{
    return w[2] / (w[2] * (1 - k) + k);
}

static double masking(const struct reference *r, const double wi[3], double cosine)
{
    const struct material *m = r->material;
    const double *wo = r->wo;
    double alpha = alpha_of(m), k;
    uint32_t kind = m->flags >> MATERIAL_DISTRIBUTION_SHIFT & 3u;
    bool separable = m->flags & MATERIAL_SEPARABLE;
    switch (m->flags >> MATERIAL_MASKING_SHIFT & 7u) {
    case MASKING_SCHLICK_GGX: // k of Karis 2013
        return schlick_masking(wo, alpha / 2) * schlick_masking(wi, alpha / 2);
    case MASKING_SCHLICK: // Schlick's own, below eq. 19
        k = sqrt(2 * alpha * alpha / M_PI);
        return schlick_masking(wo, k) * schlick_masking(wi, k);
    case MASKING_SCHLICK_REMAPPED: // Karis 2013, for delta lights
        k = ((double)m->roughness + 1) * ((double)m->roughness + 1) / 8;
        return schlick_masking(wo, k) * schlick_masking(wi, k);
    case MASKING_LH:
        return wo[2] * wi[2] / (cosine * cosine);
    case MASKING_RATIONAL:
        return rational(kind, wo, alpha, true) * rational(kind, wi, alpha, true);
    case MASKING_RATIONAL_UNBOUNDED:
        return rational(kind, wo, alpha, false) * rational(kind, wi, alpha, false);
    default:
        break;
    }
    if (kind == DISTRIBUTION_GGX)
        return ggx_masking_both(wo, wi, (double[2]){alpha, alpha}, separable);
    double lambda_o = smith_lambda(kind, wo, alpha), lambda_i = smith_lambda(kind, wi, alpha);
    return separable ? 1 / ((1 + lambda_o) * (1 + lambda_i)) : 1 / (1 + lambda_o + lambda_i);
}

static struct highlight microfacet(const struct reference *r, const double wi[3])
{
    const struct material *m = r->material;
    double alpha = alpha_of(m), h[3];
    if (alpha < SMALLEST_ALPHA)
        return (struct highlight){0};
    uint32_t kind = m->flags >> MATERIAL_DISTRIBUTION_SHIFT & 3u;
    double cosine = optics_half_reflected(r->wo, wi, h);
    double value = distribution(kind, h, alpha) * masking(r, wi, cosine) / (4 * r->wo[2]);
    double pdf = ggx_reflected_density(r->wo, h, (double[2]){alpha, alpha});
    if (r->choices.normals == NORMALS_NDF)
        pdf = distribution(kind, h, alpha) * h[2] / (4 * cosine);
    return (struct highlight){value, pdf, cosine};
}

static double microfacet_fresnel(const struct reference *r, int channel, double cosine)
{
    double ks = fmin((double)r->material->specular_color[channel], 1);
    if (r->material->flags & MATERIAL_EXACT_FRESNEL)
        return ks * optics_fresnel(fmin(cosine, 1), r->eta);
    return optics_schlick(ks, cosine);
}

// --- the sum -------------------------------------------------------------------------------------

// Returns the probability with which the highlight is sampled.
static double specular_probability(const struct reference *r)
{
    const struct material *m = r->material;
    double specular = 0, diffuse = 0;
    for (int c = 0; c < 3; c++) {
        double kd = (double)m->base_color[c], ks = fmin((double)m->specular_color[c], 1);
        bool is_microfacet = m->model == MATERIAL_MICROFACET;
        double fresnel = is_microfacet ? microfacet_fresnel(r, c, r->wo[2]) : ks;
        specular += fresnel;
        // Uncoupled, for light along the normal: the half-vector is at half of wo's angle.
        if (is_microfacet && m->flags & MATERIAL_UNCOUPLED)
            fresnel = microfacet_fresnel(r, c, cos(acos(fmin(r->wo[2], 1)) / 2));
        diffuse += is_microfacet ? kd * (1 - fresnel) : fmin(kd, 1 - ks);
    }
    return diffuse > 0 ? specular / (specular + diffuse) : 1;
}

// Returns the fraction of light that reaches the base and leaves it again or, uncoupled, that a
// microfacet in between does not reflect.
static double base_part(const struct reference *r, int channel, const double wi[3])
{
    double h[3];
    if (r->material->flags & MATERIAL_UNCOUPLED)
        return 1 - microfacet_fresnel(r, channel, optics_half_reflected(r->wo, wi, h));
    return (1 - microfacet_fresnel(r, channel, r->wo[2])) *
           (1 - microfacet_fresnel(r, channel, wi[2]));
}

double classical_eval(const struct reference *r, const double wi[3], double f[3])
{
    const struct material *m = r->material;
    double p = specular_probability(r);
    if (!(wi[2] > 0))
        return 0;
    struct highlight h = m->model == MATERIAL_PHONG         ? phong(r, wi)
                         : m->model == MATERIAL_BLINN_PHONG ? blinn_phong(r, wi)
                                                            : microfacet(r, wi);
    for (int c = 0; c < 3; c++) {
        double kd = (double)m->base_color[c], ks = fmin((double)m->specular_color[c], 1);
        if (m->model == MATERIAL_MICROFACET)
            f[c] = kd * base_part(r, c, wi) * wi[2] / M_PI +
                   microfacet_fresnel(r, c, h.fresnel_cosine) * h.value;
        else
            f[c] = fmin(kd, 1 - ks) * wi[2] / M_PI + ks * h.value;
    }
    return p * h.pdf + (1 - p) * wi[2] / M_PI;
}

int classical_deltas(const struct reference *r, struct reference_delta *out)
{
    double p = specular_probability(r);
    if (alpha_of(r->material) >= SMALLEST_ALPHA || !(p > 0))
        return 0;
    *out = (struct reference_delta){{-r->wo[0], -r->wo[1], r->wo[2]}, p, {0}, false};
    for (int c = 0; c < 3; c++)
        out->weight[c] = microfacet_fresnel(r, c, r->wo[2]) / p;
    return 1;
}
