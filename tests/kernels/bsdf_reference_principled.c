// The principled model, with the names of docs/materials.md.
#include "bsdf_albedo.h"
#include "bsdf_reference.h"

#include <math.h>
#include <stdlib.h>

enum { DIFFUSE_NODES = 1024 };

struct principled_state {
    double base[3], roughness, alpha[2], turn[2];
    double eta, metallic, transmission; // transmission is multiplied by 1 - metallic
    bool mixed, exact_coat; // Fresnel's and Schlick's reflectance are mixed; the coat has the exact
                            // one of index 1.5
    double specular[3], f0_metal[3]; // scales both reflectances; Schlick's f0 of the metal
    double f0[3], f0_index, specular_weight, compensation[3], through_compensation[3], tint[3];
    bool tries_again;     // a sample of the base that another microfacet blocks is drawn again
    double reflects_more; // fraction of the light that Fresnel's equations transmit which is
                          // reflected instead
    bool is_delta, thin, separable, is_gltf;
    double below[3]; // (1 - metallic) (1 - transmission) K
    double sheen[3], sheen_layer, subsurface, through;
    double fibre[3], fibre_roughness, fibre_albedo, fibre_layer;
    double coat, coat_alpha[2], coat_layer, base_layer;
    bool coat_ggx, coat_delta;
    double p_fibre, p_coat, p_base, p_diffuse, p_through;
    double albedo_burley[DIFFUSE_NODES + 1]; // albedo of d_burley, by the cosine
};

static double weight5(double cosine)
{
    return pow(1 - fmin(cosine, 1), 5);
}

static double mean(const double v[3])
{
    return (v[0] + v[1] + v[2]) / 3;
}

static double largest(const double v[3])
{
    return fmax(v[0], fmax(v[1], v[2]));
}

// Rotates a vector into the frame of the rotated tangent.
static void into_tangent(const struct principled_state *p, const double w[3], double out[3])
{
    out[0] = p->turn[0] * w[0] + p->turn[1] * w[1];
    out[1] = p->turn[0] * w[1] - p->turn[1] * w[0];
    out[2] = w[2];
}

// --- diffuse -------------------------------------------------------------------------------------

// Burley 2012, section 5.3.
static double d_burley(double roughness, double c_o, double c_i, double cos2_d)
{
    double a = 2 * roughness * cos2_d - 0.5;
    return (1 + a * weight5(c_o)) * (1 + a * weight5(c_i)) / M_PI;
}

static double d_below(double roughness, double c_o, double c_i, double cos2_d)
{
    double f90 = roughness * cos2_d;
    double f = (1 + (f90 - 1) * weight5(c_o)) * (1 + (f90 - 1) * weight5(c_i));
    return 1.25 * (f * (1 / (c_o + c_i) - 0.5) + 0.5) / M_PI;
}

// The Gauss-Legendre rule of 8 points is exact for the polynomial in c_i (up to degree 15), and the
// mean over 8 azimuths for that in cos(phi).
static double albedo_burley(double roughness, double c_o)
{
    static const double node[4] = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                                   0.9602898564975363}; // DLMF table 3.5.2
    static const double weight[4] = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                     0.1012285362903763};
    double sum = 0, s_o = sqrt(fmax(0, 1 - c_o * c_o));
    for (int i = 0; i < 8; i++)
        for (int j = 0; j < 8; j++) {
            double x = i & 1 ? node[i / 2] : -node[i / 2], c_i = 0.5 + 0.5 * x;
            double s_i = sqrt(1 - c_i * c_i), phi = (j + 0.5) * M_PI / 4;
            double cos2_d = 0.5 * (1 + c_o * c_i + s_o * s_i * cos(phi));
            sum += 0.5 * weight[i / 2] * M_PI / 4 * d_burley(roughness, c_o, c_i, cos2_d) * c_i;
        }
    return sum;
}

static double albedo_diffuse(const struct principled_state *p, double c)
{
    double position = fmin(c, 1) * DIFFUSE_NODES;
    int at = position >= DIFFUSE_NODES ? DIFFUSE_NODES - 1 : (int)position;
    double over = p->is_gltf ? 1
                             : p->albedo_burley[at] + (position - at) * (p->albedo_burley[at + 1] -
                                                                         p->albedo_burley[at]);
    double below = p->subsurface > 0 ? table_below(c, p->roughness) : 0;
    return over + p->subsurface * (below - over);
}

// --- the interface -------------------------------------------------------------------------------

// Pharr, Jakob and Humphreys 2016, class DisneyFresnel of pbrt-v3, times the specular colour.
static double shifted(const struct principled_state *p, int c, double exact)
{
    if (p->mixed)
        return p->specular[c] * exact;
    double f = exact + (p->f0[c] - p->f0_index) * (1 - exact) / (1 - p->f0_index);
    return fmin(fmax(f, 0), 1);
}

static double metal(const struct principled_state *p, int c, double weight)
{
    return p->specular[c] * (p->f0_metal[c] + (1 - p->f0_metal[c]) * weight) * p->compensation[c];
}

// Burley 2012, section 5.4, or Fresnel's equations.
static double coat_fresnel(const struct principled_state *p, double cosine)
{
    return p->exact_coat ? optics_fresnel(fmin(cosine, 1), 1.5) : optics_schlick(0.04, cosine);
}

static double slab(const struct principled_state *p, double f)
{
    return p->thin ? 2 * f / (1 + f) : f;
}

// Returns the probability with which reflection is sampled.
static double interface_parts(const struct principled_state *p, double cosine, double reflected[3],
                              double through[3])
{
    double exact = p->eta == 1 ? 0 : optics_fresnel(fmin(cosine, 1), p->eta);
    bool total = p->eta < 1 && optics_cos_refracted(cosine, p->eta) == 0;
    double back[3];
    for (int c = 0; c < 3; c++) {
        double f_w = total ? 1 : p->specular_weight * shifted(p, c, exact), f_t = slab(p, f_w);
        double m_t = p->through_compensation[c];
        reflected[c] = p->metallic * metal(p, c, weight5(cosine)) +
                       (1 - p->metallic - p->transmission) * f_w + p->transmission * m_t * f_t;
        back[c] = f_t;
        through[c] = p->transmission * m_t * p->tint[c];
    }
    for (int c = 0; c < 3; c++)
        through[c] *= 1 - (p->is_gltf ? largest(back) : back[c]);
    if (p->tries_again)
        return mean(back) + p->reflects_more * (1 - mean(back));
    double r = mean(reflected), t = mean(through);
    return t > 0 ? r / (r + t) : 1;
}

// --- what depends on wo alone --------------------------------------------------------------------

static void prepare_base(struct principled_state *p, const struct material *m)
{
    double luminance = 0, weight[3] = {0.2126, 0.7152, 0.0722};
    for (int c = 0; c < 3; c++) {
        p->base[c] = (double)m->base_color[c];
        luminance += weight[c] * p->base[c];
    }
    double alpha = optics_alpha(m->roughness), aspect = sqrt(1 - 0.9 * (double)m->anisotropic);
    p->roughness = (double)m->roughness;
    p->is_delta = alpha < SMALLEST_ALPHA;
    p->alpha[0] = alpha / aspect;
    p->alpha[1] = m->anisotropic > 0 ? fmax(SMALLEST_ALPHA, alpha * aspect) : alpha;
    double turn = 2 * M_PI * (double)m->anisotropic_rotation;
    p->turn[0] = cos(turn);
    p->turn[1] = sin(turn);
    p->metallic = (double)m->metallic;
    p->transmission = (1 - p->metallic) * (double)m->transmission;
    p->thin = m->flags & MATERIAL_THIN;
    p->separable = m->flags & MATERIAL_SEPARABLE;
    p->is_gltf = m->flags & MATERIAL_GLTF_LAYERS;
    p->mixed = m->flags & MATERIAL_MIXED_FRESNEL;
    p->exact_coat = m->flags & MATERIAL_EXACT_COAT;
    p->f0_index = (p->eta - 1) / (p->eta + 1) * ((p->eta - 1) / (p->eta + 1));
    p->specular_weight = (double)m->specular_weight;
    bool each = p->thin || m->flags & MATERIAL_TINT_EACH;
    for (int c = 0; c < 3; c++) {
        double tint = luminance > 0 ? p->base[c] / luminance : 1;
        tint = 1 + (tint - 1) * (double)m->specular_tint;
        p->f0[c] =
            fmin(1, p->f0_index * 2 * (double)m->specular * tint * (double)m->specular_color[c]);
        p->specular[c] = p->mixed ? fmin(1, (double)m->specular_color[c]) : 1;
        p->f0_metal[c] = p->base[c];
        if (p->mixed) {
            double f0 = fmin(1, p->f0_index * 2 * (double)m->specular * tint);
            p->f0_metal[c] = f0 + p->metallic * (p->base[c] - f0);
            p->f0[c] = p->specular[c] * p->f0_index;
        }
        p->tint[c] = each ? p->base[c] : sqrt(p->base[c]);
        p->sheen[c] = luminance > 0 ? p->base[c] / luminance : 1;
        p->sheen[c] = (double)m->sheen * (1 + (p->sheen[c] - 1) * (double)m->sheen_tint);
    }
}

static void prepare_layers(struct principled_state *p, const struct material *m, double c_o)
{
    for (int c = 0; c < 3; c++)
        p->fibre[c] = (double)m->sheen_color[c];
    p->fibre_roughness = fmax((double)0.1f, (double)m->sheen_roughness);
    p->fibre_albedo = table_charlie(c_o, p->fibre_roughness);
    double under_fibres = 1 - largest(p->fibre) * fmin(1, p->fibre_albedo);

    double coat = (double)m->clearcoat, albedo;
    p->coat_ggx = m->flags & MATERIAL_COAT_GGX;
    double alpha = p->coat_ggx ? optics_alpha(m->clearcoat_roughness)
                               : 0.1 + (0.001 - 0.1) * (double)m->clearcoat_gloss;
    p->coat_alpha[0] = p->coat_alpha[1] = alpha;
    p->coat_delta = p->coat_ggx && alpha < SMALLEST_ALPHA;
    p->coat = p->coat_ggx ? coat : 0.25 * coat;
    if (!p->coat_ggx)
        albedo =
            coat * (p->exact_coat ? table_coat_exact : table_coat)(c_o, (double)m->clearcoat_gloss);
    else if (p->coat_delta)
        albedo = coat * coat_fresnel(p, c_o);
    else if (p->exact_coat)
        albedo = coat * table_ggx(c_o, alpha) * table_fresnel(c_o, alpha, 1.5);
    else
        albedo = coat * table_ggx(c_o, alpha) * (0.04 + 0.96 * table_schlick(c_o, alpha));
    // Fibres are above the coat, but for glTF below it.
    p->coat_layer = p->is_gltf ? 1 : under_fibres;
    p->fibre_layer = p->is_gltf ? 1 - albedo : 1;
    p->p_fibre = p->fibre_layer * mean(p->fibre) * fmin(1, p->fibre_albedo);
    p->p_coat = p->coat_layer * albedo;
    p->base_layer = under_fibres * (1 - albedo);
}

// Computes E1, and the means of Fresnel's reflectance and of Schlick's weight over the reflected
// light.
static void albedo_of_slopes(const struct principled_state *p, const struct material *m,
                             const double wo[3], double *e1, double *exact, double *schlick)
{
    double turned[3], alpha = optics_alpha(m->roughness), c_o = wo[2];
    double anisotropic = (double)m->anisotropic;
    *e1 = 1;
    *schlick = weight5(c_o);
    *exact = p->eta == 1 ? 0 : optics_fresnel(c_o, p->eta);
    if (p->is_delta)
        return;
    if (!(anisotropic > 0)) {
        *e1 = table_ggx(c_o, alpha);
        *schlick = table_schlick(c_o, alpha);
        *exact = p->eta == 1 ? 0 : table_fresnel(c_o, alpha, p->eta);
        return;
    }
    into_tangent(p, wo, turned);
    double cosine = table_turned_cosine(turned, p->roughness, anisotropic, p->alpha);
    *e1 = table_turned(turned, p->roughness, anisotropic, p->alpha);
    *schlick = weight5(cosine);
    // From inside, at most Schlick's curve from the angle of total reflection on.
    double critical = p->eta < 1 ? sqrt(1 - p->eta * p->eta) : 0;
    double beyond = fmin(fmax((cosine - critical) / (1 - critical), 0), 1);
    if (p->eta > 1)
        *exact = optics_fresnel(cosine, fmax(p->eta, 1.05));
    else if (p->eta < 1)
        *exact = p->f0_index + (1 - p->f0_index) * weight5(beyond);
}

// Returns the albedo of an interface that transmits and loses nothing, with Fresnel's equations, or
// with total reflection as its only reflection.
static double lossless_part(const struct principled_state *p, const struct material *m,
                            const double wo[3], bool is_clear)
{
    double turned[3], alpha = optics_alpha(m->roughness);
    into_tangent(p, wo, turned);
    if (m->anisotropic > 0)
        return table_turned_glass(turned, p->roughness, (double)m->anisotropic, p->alpha, p->eta,
                                  is_clear);
    return is_clear ? table_clear(wo[2], alpha, p->eta) : table_glass(wo[2], alpha, p->eta);
}

// Returns the albedo of this material with its own reflectance, for one channel.
static double lossless_albedo(const struct principled_state *p, const struct material *m, int c,
                              const double wo[3], double e1)
{
    double moved = (p->f0[c] - p->f0_index) / (1 - p->f0_index);
    if (p->thin)
        return e1;
    // This scales reflection, except total reflection, as the specular weight does.
    double scale = p->specular_weight * p->specular[c];
    if (p->mixed)
        return scale * lossless_part(p, m, wo, false) + (1 - scale) * lossless_part(p, m, wo, true);
    double albedo = (1 - moved) * lossless_part(p, m, wo, false) + moved * e1;
    if (p->specular_weight == 1)
        return albedo;
    return p->specular_weight * albedo + (1 - p->specular_weight) * lossless_part(p, m, wo, true);
}

// See docs/materials.md, "Sampling".
static void prepare_tries(struct principled_state *p, bool tries, double e1, double *survival)
{
    double f0 = slab(p, p->specular_weight * mean(p->f0)), lossless[3];
    double reflected = (1 - p->metallic) * f0 + p->metallic * mean(p->base);
    double reflects = reflected / (reflected + p->transmission * mean(p->tint) * (1 - f0));
    for (int c = 0; c < 3; c++)
        lossless[c] = 1 / p->through_compensation[c];
    p->tries_again = tries;
    p->reflects_more = f0 < 1 ? fmin(fmax((reflects - f0) / (1 - f0), 0), 1) : 0;
    *survival = !tries ? 0 : fmin(1, mean(lossless) + p->reflects_more * (e1 - mean(lossless)));
}

static void prepare_interface(struct principled_state *p, const struct material *m,
                              const double wo[3], bool is_visible, double *survival)
{
    double albedo[3], back[3], e1, exact, schlick;
    albedo_of_slopes(p, m, wo, &e1, &exact, &schlick);
    bool gives_back =
        m->flags & MATERIAL_COMPENSATE && p->transmission > 0 && !p->is_delta && p->eta != 1;
    for (int c = 0; c < 3; c++)
        p->through_compensation[c] = gives_back ? 1 / lossless_albedo(p, m, c, wo, e1) : 1;
    if (gives_back)
        prepare_tries(p, is_visible && !p->separable, e1, survival);
    for (int c = 0; c < 3; c++) {
        bool compensates = m->flags & MATERIAL_COMPENSATE;
        double f0_metal = p->specular[c] * p->f0_metal[c];
        p->compensation[c] = compensates ? 1 + f0_metal * (1 - e1) / e1 : 1;
        double f_w = (p->eta < 1 ? 1 : p->specular_weight) * shifted(p, c, exact);
        // Total reflection is not scaled.
        if (p->mixed && p->eta < 1)
            f_w = fmax(f_w, exact);
        double f_t = slab(p, f_w);
        albedo[c] =
            e1 * (p->metallic * metal(p, c, schlick) + (1 - p->metallic - p->transmission) * f_w +
                  p->transmission * p->through_compensation[c] * (f_t + p->tint[c] * (1 - f_t)));
        back[c] = e1 * f_w;
    }
    for (int c = 0; c < 3; c++)
        p->below[c] =
            (1 - p->metallic - p->transmission) * (1 - (p->is_gltf ? largest(back) : back[c]));
    p->p_base = p->base_layer * mean(albedo);
}

static void prepare_diffuse(struct principled_state *p, const struct material *m, double c_o)
{
    double albedo[3], rest[3], scale = fmax(1, table_sheen(0) * largest(p->sheen));
    for (int i = 0; i <= DIFFUSE_NODES; i++)
        p->albedo_burley[i] = albedo_burley(p->roughness, (double)i / DIFFUSE_NODES);
    p->subsurface = (double)m->subsurface;
    p->through = p->thin ? (double)m->diffuse_transmission : 0;
    for (int c = 0; c < 3; c++)
        p->sheen[c] /= scale;
    p->sheen_layer = 1 - largest(p->sheen) * table_sheen(c_o);
    for (int c = 0; c < 3; c++) {
        rest[c] = p->below[c] * p->sheen_layer * p->base[c];
        albedo[c] = p->below[c] * p->sheen[c] * table_sheen(c_o) +
                    rest[c] * (1 - p->through) * fmin(1, albedo_diffuse(p, c_o));
    }
    p->p_diffuse = p->base_layer * mean(albedo);
    p->p_through = p->base_layer * p->through * mean(rest);
}

bool principled_prepare(struct reference *r)
{
    struct principled_state *p = calloc(1, sizeof *p);
    double c_o = r->wo[2];
    r->principled = p;
    if (!p)
        return false;
    p->eta = fabs(r->eta - 1) <= 6 * 0x1p-24 ? 1 : r->eta;
    prepare_base(p, r->material);
    prepare_layers(p, r->material, c_o);
    prepare_interface(p, r->material, r->wo, r->choices.normals == NORMALS_VISIBLE, &r->survival);
    prepare_diffuse(p, r->material, c_o);
    double sum = p->p_fibre + p->p_coat + p->p_base + p->p_diffuse + p->p_through;
    double scale = sum > 0 ? 1 / sum : 0;
    p->p_fibre *= scale;
    p->p_coat *= scale;
    p->p_base *= scale;
    p->p_diffuse *= scale;
    p->p_through *= scale;
    return true;
}

// --- lobes ---------------------------------------------------------------------------------------

static double add_fibres(const struct principled_state *p, const double wo[3], const double wi[3],
                         const double h[3], double f[3])
{
    double a = p->fibre_roughness * p->fibre_roughness;
    double sine = sqrt(h[0] * h[0] + h[1] * h[1]);
    double d = (2 + 1 / a) * pow(fmin(sine, 1), 1 / a) / (2 * M_PI);
    double v = 1 / (4 * (wo[2] + wi[2] - wo[2] * wi[2]));
    double scale = fmax(1, fmax(p->fibre_albedo, table_charlie(wi[2], p->fibre_roughness)));
    for (int c = 0; c < 3; c++)
        f[c] += p->fibre_layer * p->fibre[c] * d * v * wi[2] / scale;
    return p->p_fibre / (2 * M_PI);
}

static double add_coat(const struct reference *r, const double wi[3], const double h[3],
                       double cosine, double f[3])
{
    const struct principled_state *p = r->principled;
    const double *wo = r->wo;
    static const double quarter[2] = {0.25, 0.25};
    double value, pdf, a2 = p->coat_alpha[0] * p->coat_alpha[0];
    if (p->coat_ggx) {
        value = ggx_density(h, p->coat_alpha) *
                ggx_masking_both(wo, wi, p->coat_alpha, p->separable) / (4 * wo[2]);
        pdf = reference_reflected_density(r, wo, h, p->coat_alpha);
    } else {
        double sin2 = h[0] * h[0] + h[1] * h[1];
        double d = (a2 - 1) / (M_PI * log(a2) * (a2 * h[2] * h[2] + sin2));
        value = d * ggx_masking(wo, quarter) * ggx_masking(wi, quarter) / (4 * wo[2]);
        pdf = d * h[2] / (4 * cosine);
    }
    for (int c = 0; c < 3; c++)
        f[c] += p->coat_layer * p->coat * coat_fresnel(p, cosine) * value;
    return p->p_coat * pdf;
}

// Adds reflection or, with `through`, the mirrored reflection that a thin sheet transmits.
static double add_reflection(const struct reference *r, const double wi[3], const double h[3],
                             double cosine, bool is_through, double f[3])
{
    const struct principled_state *p = r->principled;
    const double *wo = r->wo;
    double o[3], i[3], n[3], reflected[3], through[3];
    into_tangent(p, wo, o);
    into_tangent(p, wi, i);
    into_tangent(p, h, n);
    double probability = interface_parts(p, cosine, reflected, through);
    double both = ggx_masking_both(o, i, p->alpha, p->separable);
    double value = ggx_density(n, p->alpha) * both / (4 * wo[2]);
    for (int c = 0; c < 3; c++)
        f[c] += p->base_layer * (is_through ? through[c] : reflected[c]) * value;
    probability = is_through ? 1 - probability : probability;
    return p->p_base *
           dielectric_tried(r, probability * reference_reflected_density(r, o, n, p->alpha),
                            both / ggx_masking(o, p->alpha));
}

static double add_refraction(const struct reference *r, const double wi[3], double f[3])
{
    const struct principled_state *p = r->principled;
    const double *wo = r->wo;
    double o[3], i[3], n[3], h[3], reflected[3], through[3];
    double jacobian = optics_half_refracted(wo, wi, p->eta, h);
    if (!(jacobian > 0))
        return 0;
    into_tangent(p, wo, o);
    into_tangent(p, wi, i);
    into_tangent(p, h, n);
    double cosine = optics_dot(wo, h);
    double probability = 1 - interface_parts(p, cosine, reflected, through);
    double value = ggx_density(n, p->alpha) * ggx_masking_both(o, i, p->alpha, false) * cosine *
                   jacobian / (wo[2] * reference_divisor(r, p->eta));
    for (int c = 0; c < 3; c++)
        f[c] += p->base_layer * through[c] * value;
    double density = probability * reference_normal_density(r, o, n, p->alpha) * jacobian;
    return p->p_base * dielectric_tried(r, density, ggx_masking(i, p->alpha));
}

static double add_diffuse(const struct principled_state *p, const double wo[3], const double wi[3],
                          double cosine, double f[3])
{
    double cos2_d = cosine * cosine, c_o = wo[2], c_i = wi[2];
    double over = p->is_gltf ? 1 / M_PI : d_burley(p->roughness, c_o, c_i, cos2_d);
    double d = (1 - p->subsurface) * over + p->subsurface * d_below(p->roughness, c_o, c_i, cos2_d);
    d /= fmax(1, fmax(albedo_diffuse(p, c_o), albedo_diffuse(p, c_i)));
    for (int c = 0; c < 3; c++)
        f[c] +=
            p->base_layer * p->below[c] * c_i *
            (p->sheen[c] * weight5(cosine) + p->sheen_layer * (1 - p->through) * p->base[c] * d);
    return p->p_diffuse * c_i / M_PI;
}

static double eval_over(const struct reference *r, const double wi[3], double f[3])
{
    const struct principled_state *p = r->principled;
    const double *wo = r->wo;
    double h[3], cosine = optics_half_reflected(wo, wi, h);
    double pdf = add_diffuse(p, wo, wi, cosine, f);
    if (!p->is_delta)
        pdf += add_reflection(r, wi, h, cosine, false, f);
    if (!p->coat_delta && p->coat > 0)
        pdf += add_coat(r, wi, h, cosine, f);
    return pdf + add_fibres(p, wo, wi, h, f);
}

static double eval_under(const struct reference *r, const double wi[3], double f[3])
{
    const struct principled_state *p = r->principled;
    const double mirrored[3] = {wi[0], wi[1], -wi[2]};
    double h[3], pdf = p->p_through * mirrored[2] / M_PI;
    for (int c = 0; c < 3; c++)
        f[c] += p->base_layer * p->below[c] * p->sheen_layer * p->through * p->base[c] *
                mirrored[2] / M_PI;
    if (p->is_delta || p->eta == 1 || p->transmission == 0)
        return pdf;
    if (p->thin) {
        double cosine = optics_half_reflected(r->wo, mirrored, h);
        return pdf + add_reflection(r, mirrored, h, cosine, true, f);
    }
    return principled_hides_refraction(r) ? pdf : pdf + add_refraction(r, wi, f);
}

double principled_eval(const struct reference *r, const double wi[3], double f[3])
{
    if (wi[2] == 0)
        return 0;
    return wi[2] > 0 ? eval_over(r, wi, f) : eval_under(r, wi, f);
}

// --- deltas --------------------------------------------------------------------------------------

bool principled_hides_refraction(const struct reference *r)
{
    const struct principled_state *p = r->principled;
    double width = fmin(p->alpha[0], p->alpha[1]) * fabs(p->eta - 1);
    return p->transmission > 0 && !p->is_delta && (p->eta == 1 || (!p->thin && width < 0x1p-17));
}

double principled_through_normal(const struct reference *r, const double h[3])
{
    const struct principled_state *p = r->principled;
    double o[3], n[3], reflected[3], through[3];
    into_tangent(p, r->wo, o);
    into_tangent(p, h, n);
    double probability = 1 - interface_parts(p, optics_dot(r->wo, h), reflected, through);
    return p->p_base * dielectric_tried(r,
                                        probability * reference_normal_density(r, o, n, p->alpha),
                                        dielectric_unshadowed(o, n, p->alpha, p->eta, false, 0));
}

static double reflects(const struct reference *r, double cosine)
{
    double reflected[3], through[3];
    return interface_parts(r->principled, cosine, reflected, through);
}

double principled_true_survival(const struct reference *r)
{
    const struct principled_state *p = r->principled;
    double o[3];
    into_tangent(p, r->wo, o);
    return dielectric_survival(r, o, p->alpha, p->thin, reflects);
}

int principled_deltas(const struct reference *r, struct reference_delta *out)
{
    const struct principled_state *p = r->principled;
    const double *wo = r->wo;
    double reflected[3], through[3];
    int count = 0;
    if (p->coat_delta && p->p_coat > 0) {
        double weight = p->coat_layer * p->coat * coat_fresnel(p, wo[2]) / p->p_coat;
        out[count++] = (struct reference_delta){
            {-wo[0], -wo[1], wo[2]}, p->p_coat, {weight, weight, weight}, false};
    }
    if (!p->is_delta || !(p->p_base > 0))
        return count;
    double reflects = p->p_base * interface_parts(p, wo[2], reflected, through);
    double passes = p->p_base - reflects, ratio = 1 / p->eta;
    if (reflects > 0) {
        struct reference_delta *delta = &out[count++];
        *delta = (struct reference_delta){{-wo[0], -wo[1], wo[2]}, reflects, {0}, false};
        for (int c = 0; c < 3; c++)
            delta->weight[c] = p->base_layer * reflected[c] / reflects;
    }
    if (passes > 0) {
        struct reference_delta *delta = &out[count++];
        bool straight = p->thin || p->eta == 1;
        *delta = (struct reference_delta){{-wo[0], -wo[1], -wo[2]}, passes, {0}, true};
        for (int c = 0; c < 2 && !straight; c++)
            delta->wi[c] = -ratio * wo[c];
        if (!straight)
            delta->wi[2] = -optics_cos_refracted(wo[2], p->eta);
        for (int c = 0; c < 3; c++)
            delta->weight[c] =
                p->base_layer * through[c] / passes / (straight ? 1 : reference_divisor(r, p->eta));
    }
    return count;
}
