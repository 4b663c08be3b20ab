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

// Returns the reflectance of a slab without thickness, with all orders of reflection between its
// faces.
static double reflectance(const struct reference *r, double cosine)
{
    double one = optics_fresnel(fmin(cosine, 1), r->eta);
    return is_thin(r->material) ? 2 * one / (1 + one) : one;
}

static void set_all(double f[3], double value)
{
    f[0] = f[1] = f[2] = value;
}

// Returns the factor that compensates the loss of single scattering; a lossless interface gets all
// of it back.
static double compensation(const struct reference *r)
{
    double alpha = alpha_of(r->material);
    if (!(r->material->flags & MATERIAL_COMPENSATE))
        return 1;
    return 1 / (is_thin(r->material) ? table_ggx(r->wo[2], alpha)
                                     : table_glass(r->wo[2], alpha, r->eta));
}

// --- drawn again ---------------------------------------------------------------------------------

enum { TRIES = 32 };

void dielectric_prepare(struct reference *r)
{
    uint32_t flags = r->material->flags & (MATERIAL_COMPENSATE | MATERIAL_SEPARABLE);
    bool again = flags == MATERIAL_COMPENSATE && alpha_of(r->material) >= SMALLEST_ALPHA &&
                 r->choices.normals == NORMALS_VISIBLE;
    r->survival = again && !is_straight(r) ? fmin(1, 1 / compensation(r)) : 0;
}

double dielectric_tried(const struct reference *r, double density, double unshadowed)
{
    if (r->survival == 0)
        return density;
    return density * unshadowed * -expm1(TRIES * log1p(-r->survival)) / r->survival;
}

double dielectric_unshadowed(const double wo[3], const double h[3], const double alpha[2],
                             double eta, bool thin, double reflects)
{
    double cosine = optics_dot(wo, h), beyond = optics_cos_refracted(cosine, eta);
    double over[3], under[3], sum = 0;
    for (int c = 0; c < 3; c++) {
        over[c] = 2 * cosine * h[c] - wo[c];
        under[c] = (cosine / eta - beyond) * h[c] - wo[c] / eta;
    }
    if (over[2] > 0)
        sum += (thin ? 1 : reflects) * ggx_masking_both(wo, over, alpha, false) /
               ggx_masking(wo, alpha);
    if (under[2] < 0 && !thin)
        sum += (1 - reflects) * ggx_masking(under, alpha);
    return sum;
}

// Reflected about visible normals, wo is uniformly distributed in a spherical cap (Dupuy and
// Benyoub 2023). The quadrature is a lattice over the cap's height, by smoothstep, and around it.
// Each column is a golden section higher than the previous one, so that the circle where total
// reflection begins is not along a row.
double dielectric_survival(const struct reference *r, const double wo[3], const double alpha[2],
                           bool thin, double (*reflects)(const struct reference *, double cosine))
{
    enum { ROWS = 256, COLUMNS = 256 };
    double stretched[3] = {alpha[0] * wo[0], alpha[1] * wo[1], wo[2]}, sum = 0, all = 0;
    optics_normalize(stretched);
    double sine2 = stretched[0] * stretched[0] + stretched[1] * stretched[1];
    for (int i = 0; i < ROWS * COLUMNS; i++) {
        double shift = fmod((i % COLUMNS + 0.5) * 0.6180339887498949, 1);
        double t = (i / COLUMNS + shift) / ROWS, phi = (i % COLUMNS + 0.5) / COLUMNS * 2 * M_PI;
        double height = (1 - t * t * (3 - 2 * t)) * (1 + stretched[2]);
        double sine =
            sqrt(t * t * (3 - 2 * t) * (1 + stretched[2]) * (height + sine2 / (1 + stretched[2])));
        double h[3] = {alpha[0] * (sine * cos(phi) + stretched[0]),
                       alpha[1] * (sine * sin(phi) + stretched[1]), height};
        optics_normalize(h);
        double cosine = optics_dot(wo, h);
        all += t * (1 - t);
        if (cosine > 0)
            sum += t * (1 - t) *
                   dielectric_unshadowed(wo, h, alpha, r->eta, thin, reflects(r, cosine));
    }
    return fmin(1, sum / all);
}

double dielectric_true_survival(const struct reference *r)
{
    const double alpha[2] = {alpha_of(r->material), alpha_of(r->material)};
    return dielectric_survival(r, r->wo, alpha, is_thin(r->material), reflectance);
}

// --- dielectric ----------------------------------------------------------------------------------

static double reflected(const struct reference *r, const double wi[3], bool through, double f[3])
{
    double alpha[2] = {alpha_of(r->material), alpha_of(r->material)}, h[3];
    bool separable = r->material->flags & MATERIAL_SEPARABLE;
    double cosine = optics_half_reflected(r->wo, wi, h), part = reflectance(r, cosine);
    part = through ? 1 - part : part;
    double both = ggx_masking_both(r->wo, wi, alpha, separable);
    set_all(f, compensation(r) * part * ggx_density(h, alpha) * both / (4 * r->wo[2]));
    return dielectric_tried(r, part * reference_reflected_density(r, r->wo, h, alpha),
                            both / ggx_masking(r->wo, alpha));
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
                   reference_divisor(r, r->eta));
    return dielectric_tried(r, part * reference_normal_density(r, r->wo, h, alpha) * jacobian,
                            ggx_masking(wi, alpha));
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
    double density =
        (1 - reflectance(r, optics_dot(r->wo, h))) * reference_normal_density(r, r->wo, h, alpha);
    return dielectric_tried(r, density, dielectric_unshadowed(r->wo, h, alpha, r->eta, false, 0));
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
    double part = reflectance(r, wo[2]), scale = 1 / reference_divisor(r, r->eta);
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
    return reference_reflected_density(r, r->wo, h, alpha);
}

int conductor_deltas(const struct reference *r, struct reference_delta *out)
{
    if (alpha_of(r->material) >= SMALLEST_ALPHA)
        return 0;
    *out = (struct reference_delta){{-r->wo[0], -r->wo[1], r->wo[2]}, 1, {0}, false};
    conductor_reflectance(r, r->wo[2], out->weight);
    return 1;
}
