#include "render/tables/albedo_integrals.h"

#include "base/maths.h"
#include "shared/albedo.h"
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#define PI 3.14159265358979323846

static double square(double x)
{
    return x * x;
}

static double schlick_weight(double cos_theta)
{
    return pow(1.0 - clamp01(cos_theta), 5.0);
}

// Returns the reflectance by the formula of fresnel_dielectric() in lib/fresnel.glsl.
static double fresnel(double cos_i, double eta)
{
    double k = (eta - 1.0) * (eta + 1.0);
    double g2 = k + cos_i * cos_i;
    if (k == 0.0 || g2 <= 0.0)
        return k == 0.0 ? 0.0 : 1.0;
    double g = sqrt(g2);
    double sum = cos_i + g;
    double r_s = k / (sum * sum);
    double r_p = k * (cos_i * sum - 1.0) / (sum * (eta * eta * cos_i + g));
    return 0.5 * (r_s * r_s + r_p * r_p);
}

// A quadrature over visible GGX normals: its points are the random numbers from which
// sample_ggx_vndf() (Dupuy and Benyoub 2023) would sample the normals. The sum of the weights G2 /
// G1(wo) is the albedo for F = 1.
#define ROWS_MAX 192
#define COLUMNS_MAX 192
struct visible_normals {
    uint32_t count;
    double weight[ROWS_MAX * COLUMNS_MAX];
    double cosine[ROWS_MAX * COLUMNS_MAX]; // cosine of the angle between wo and the normal h
};

// Computes the quadrature. phi is the azimuth of wo. If alpha_x = alpha_y and phi = 0, half of the
// circle suffices by symmetry.
static void find_visible_normals(struct visible_normals *n, double mu, double phi, double alpha_x,
                                 double alpha_y, int rows, int columns)
{
    bool symmetric = alpha_x == alpha_y && phi == 0.0;
    double cosines[COLUMNS_MAX], sines[COLUMNS_MAX];
    for (int j = 0; j < columns; j++) {
        cosines[j] = cos((symmetric ? PI : 2.0 * PI) * (j + 0.5) / columns);
        sines[j] = sin((symmetric ? PI : 2.0 * PI) * (j + 0.5) / columns);
    }
    double sin_o = sqrt((1.0 - mu) * (1.0 + mu));
    double wo_x = sin_o * cos(phi), wo_y = sin_o * sin(phi);
    double length_o = sqrt(square(alpha_x * wo_x) + square(alpha_y * wo_y) + mu * mu);
    double tilt_x = alpha_x * wo_x / length_o, tilt_y = alpha_y * wo_y / length_o;
    double k = mu / length_o;
    double below = (tilt_x * tilt_x + tilt_y * tilt_y) / (1.0 + k);
    n->count = 0;
    for (int i = 0; i < rows; i++) {
        // Changes variables by smoothstep, because the integrand has kinks at both ends.
        double t = (i + 0.5) / rows;
        double u = t * t * (3.0 - 2.0 * t);
        double density = 6.0 * t * (1.0 - t) / (rows * columns);
        double height = (1.0 - u) * (1.0 + k);
        double sine = sqrt(u * (1.0 + k) * (height + below));
        for (int j = 0; j < columns; j++) {
            double h_x = alpha_x * (sine * cosines[j] + tilt_x);
            double h_y = alpha_y * (sine * sines[j] + tilt_y);
            double norm = 1.0 / sqrt(h_x * h_x + h_y * h_y + height * height);
            double cosine = (wo_x * h_x + wo_y * h_y + mu * height) * norm;
            double wi_z = 2.0 * cosine * height * norm - mu;
            if (wi_z <= 0.0 || cosine <= 0.0)
                continue;
            double wi_x = 2.0 * cosine * h_x * norm - wo_x;
            double wi_y = 2.0 * cosine * h_y * norm - wo_y;
            double length_i = sqrt(square(alpha_x * wi_x) + square(alpha_y * wi_y) + wi_z * wi_z);
            n->weight[n->count] =
                density * wi_z * (mu + length_o) / (mu * length_i + wi_z * length_o);
            n->cosine[n->count++] = cosine;
        }
    }
}

// The following functions map a coordinate in [0, 1] along an axis of lib/albedo.glsl to a
// parameter.
static double axis_alpha(double y)
{
    double root4 = 0.1 + 0.9 * y;
    return root4 * root4 * root4 * root4;
}

static double axis_mu(double x, double scale)
{
    double v = x * x;
    return fmin(1.0, v * scale / (1.0 + scale - v)); // rounding may exceed 1
}

static double axis_eta(double z, int inside)
{
    double r = z * z * z * z;
    // At the end of the axis the parameter is infinite.
    if (r >= 1.0)
        return inside ? 0.0 : 1e6;
    return inside ? (1.0 - r) / (1.0 + r) : (1.0 + r) / (1.0 - r);
}

static double fresnel_mu(double x, double alpha, double eta, int inside)
{
    double root_k = sqrt(fabs((eta - 1.0) * (eta + 1.0)));
    if (!inside)
        return axis_mu(x, alpha + 0.6 * root_k / (1.0 + root_k));
    double t = 2.0 * x - 1.0;
    return t < 0.0 ? root_k * (1.0 - t * t) : root_k + (1.0 - root_k) * t * t;
}

double albedo_ggx(double x, double y)
{
    static struct visible_normals n;
    double alpha = axis_alpha(y);
    double sum = 0.0;
    find_visible_normals(&n, axis_mu(x, alpha), 0.0, alpha, alpha, 128, 64);
    for (uint32_t i = 0; i < n.count; i++)
        sum += n.weight[i];
    return fmin(1.0, sum);
}

// Returns the mean of Schlick's weight over the directions of reflected light.
double albedo_schlick(double x, double y)
{
    static struct visible_normals n;
    double alpha = axis_alpha(y);
    double sum = 0.0, weighted = 0.0;
    find_visible_normals(&n, axis_mu(x, alpha + 0.2), 0.0, alpha, alpha, 128, 64);
    for (uint32_t i = 0; i < n.count; i++) {
        sum += n.weight[i];
        weighted += n.weight[i] * schlick_weight(n.cosine[i]);
    }
    return weighted / sum;
}

// Returns the mean of the Fresnel reflectance over the directions of reflected light.
double albedo_fresnel(double x, double y, double z, double w)
{
    int inside = w > 0.5;
    static struct visible_normals n;
    double alpha = axis_alpha(y), eta = axis_eta(z, inside);
    double sum = 0.0, weighted = 0.0;
    if (z == 0.0)
        return 0.0;
    find_visible_normals(&n, fresnel_mu(x, alpha, eta, inside), 0.0, alpha, alpha, 64, 32);
    for (uint32_t i = 0; i < n.count; i++) {
        sum += n.weight[i];
        weighted += n.weight[i] * fresnel(n.cosine[i], eta);
    }
    return weighted / sum;
}

// --- interfaces that also refract ----------------------------------------------------------------

// A rough interface between two dielectrics, for light in direction wo.
struct interface {
    double wo[3], alpha[2], eta;
    double length_o; // |(alpha_x wo.x, alpha_y wo.y, wo.z)|
    bool is_clear;   // reflects only where reflection is total
};

static double stretched_length(const double w[3], const double alpha[2])
{
    return sqrt(square(alpha[0] * w[0]) + square(alpha[1] * w[1]) + w[2] * w[2]);
}

static struct interface make_interface(double mu, double phi, const double alpha[2], double eta)
{
    double sin_o = sqrt((1.0 - mu) * (1.0 + mu));
    struct interface s = {
        .wo = {sin_o * cos(phi), sin_o * sin(phi), mu}, .alpha = {alpha[0], alpha[1]}, .eta = eta};
    s.length_o = stretched_length(s.wo, alpha);
    return s;
}

// Returns G2 / G1(wo) of the reflection at a microfacet with normal h; 0 if the reflected direction
// is below the surface.
static double reflection_weight(const struct interface *s, const double h[3], double cosine)
{
    double wi[3];
    for (int c = 0; c < 3; c++)
        wi[c] = 2.0 * cosine * h[c] - s->wo[c];
    if (wi[2] <= 0.0)
        return 0.0;
    double length_i = stretched_length(wi, s->alpha);
    return wi[2] * (s->wo[2] + s->length_o) / (s->wo[2] * length_i + wi[2] * s->length_o);
}

// Returns the weight of the refraction, G1(wi); cos_t is the cosine on the other side of h.
static double refraction_weight(const struct interface *s, const double h[3], double cosine,
                                double cos_t)
{
    double wi[3];
    for (int c = 0; c < 3; c++)
        wi[c] = (cosine / s->eta - cos_t) * h[c] - s->wo[c] / s->eta;
    return wi[2] < 0.0 ? 2.0 * -wi[2] / (stretched_length(wi, s->alpha) - wi[2]) : 0.0;
}

// Returns the energy that a microfacet of normal h, visible from wo, scatters without meeting
// another microfacet.
static double interface_weight(const struct interface *s, const double h[3])
{
    double cosine = fmin(1.0, vec3_dot(s->wo, h));
    double squared = (s->eta - 1.0) * (s->eta + 1.0) + cosine * cosine; // (eta cos_t)^2
    if (cosine <= 0.0)
        return 0.0;
    if (squared <= 0.0)
        return reflection_weight(s, h, cosine);
    double reflectance = s->is_clear ? 0.0 : fresnel(cosine, s->eta);
    return reflectance * reflection_weight(s, h, cosine) +
           (1.0 - reflectance) * refraction_weight(s, h, cosine, sqrt(squared) / s->eta);
}

// Returns the energy that leaves a rough interface after one scattering event, by a quadrature over
// visible normals. `circle` is the fraction of their azimuths that is integrated.
static double interface_albedo(const struct interface *s, double circle, int rows, int columns)
{
    double tilt_x = s->alpha[0] * s->wo[0] / s->length_o;
    double tilt_y = s->alpha[1] * s->wo[1] / s->length_o, k = s->wo[2] / s->length_o;
    double below = (tilt_x * tilt_x + tilt_y * tilt_y) / (1.0 + k), sum = 0.0;
    double cosines[COLUMNS_MAX], sines[COLUMNS_MAX];
    for (int j = 0; j < columns; j++) {
        cosines[j] = cos(circle * (j + 0.5) / columns);
        sines[j] = sin(circle * (j + 0.5) / columns);
    }
    for (int i = 0; i < rows; i++) {
        double t = (i + 0.5) / rows;
        double height = (1.0 - t * t * (3.0 - 2.0 * t)) * (1.0 + k);
        double sine = sqrt(t * t * (3.0 - 2.0 * t) * (1.0 + k) * (height + below));
        double density = 6.0 * t * (1.0 - t) / (rows * columns);
        for (int j = 0; j < columns; j++) {
            double x = s->alpha[0] * (sine * cosines[j] + tilt_x);
            double y = s->alpha[1] * (sine * sines[j] + tilt_y);
            double norm = 1.0 / sqrt(x * x + y * y + height * height);
            const double h[3] = {x * norm, y * norm, height * norm};
            sum += density * interface_weight(s, h);
        }
    }
    return sum;
}

// Returns interface_albedo() of an isotropic interface, for which half of the circle suffices.
static double isotropic_albedo(double mu, double alpha, double eta, bool is_clear)
{
    // At grazing angles total reflection ends along a line across the visible normals. With half as
    // many columns, the position of that line between two of them would change the result by 0.3 %.
    const int columns = eta < 1.0 && mu < 0.1 && alpha > 0.3 ? 64 : 32;
    const double alphas[2] = {alpha, alpha};
    struct interface s = make_interface(mu, 0.0, alphas, eta);
    s.is_clear = is_clear;
    return interface_albedo(&s, PI, 64, columns);
}

// Returns the square root of an albedo, as the tables store it. Albedos fall to nearly 0 at grazing
// angles as eta approaches 1; because results are divided by them, their relative error matters.
static double root_glass(double x, double y, double z, int inside, bool is_clear)
{
    double alpha = axis_alpha(y), eta = axis_eta(z, inside);
    double root_k = sqrt(fabs((eta - 1.0) * (eta + 1.0)));
    double mu = axis_mu(x, inside ? alpha + 0.6 * root_k / (1.0 + root_k) : alpha);
    return sqrt(isotropic_albedo(mu, alpha, eta, is_clear));
}

double glass_outside(double x, double y, double z, double w)
{
    (void)w;
    return root_glass(x, y, z, 0, false);
}

double glass_inside(double x, double y, double z, double w)
{
    (void)w;
    return root_glass(x, y, z, 1, false);
}

double clear_glass(double x, double y, double z, double w)
{
    return root_glass(x, y, z, w > 0.5, true);
}

// An anisotropic GGX distribution: a roughness, an aspect (alpha_y / alpha_x)^(1/2) and the azimuth
// of wo, on the axes of lib/albedo.glsl.
struct anisotropy {
    double alpha_x, alpha_y, phi;
    double alpha_o; // alpha along the azimuth of wo
};

static struct anisotropy axis_anisotropy(double y, double z, double w)
{
    double alpha = square(0.01 + 0.99 * y);
    double aspect = pow(0.1, 0.5 * z);
    double psi = 0.5 * PI * w;
    struct anisotropy a = {.alpha_x = alpha / aspect, .alpha_y = fmax(1e-4, alpha * aspect)};
    a.phi = w >= 1.0 ? 0.5 * PI : atan(tan(psi) * sqrt(a.alpha_x / a.alpha_y));
    a.alpha_o = hypot(a.alpha_x * cos(a.phi), a.alpha_y * sin(a.phi));
    return a;
}

double albedo_anisotropic(double x, double y, double z, double w)
{
    static struct visible_normals n;
    struct anisotropy a = axis_anisotropy(y, z, w);
    double sum = 0.0;
    double mu = axis_mu(x, a.alpha_o);
    // Near the normal the reflected light is in a narrow band of azimuths, so that 48 points would
    // have an error of 2 %.
    int points = mu > 0.95 ? 192 : 48;
    find_visible_normals(&n, mu, a.phi, a.alpha_x, a.alpha_y, points, points);
    for (uint32_t i = 0; i < n.count; i++)
        sum += n.weight[i];
    return fmin(1.0, sum);
}

// Returns 1 minus the cosine at which (1 - cos)^12 equals its mean over the directions of reflected
// light. The Fresnel reflectance is a concave function of (1 - cos)^12, so its mean is at most its
// value at that cosine.
double albedo_anisotropic_sine(double x, double y, double z, double w)
{
    static struct visible_normals n;
    struct anisotropy a = axis_anisotropy(y, z, w);
    double sum = 0.0, weighted = 0.0;
    find_visible_normals(&n, axis_mu(x, a.alpha_o + 0.2), a.phi, a.alpha_x, a.alpha_y, 48, 48);
    for (uint32_t i = 0; i < n.count; i++) {
        double power = square(square(1.0 - fmin(1.0, n.cosine[i])));
        sum += n.weight[i];
        weighted += n.weight[i] * power * power * power;
    }
    return pow(weighted / sum, 1.0 / 12.0);
}

static double ggx_masking(double mu, double alpha)
{
    return 2.0 * mu / (mu + sqrt(square(alpha) * (1.0 - mu) * (1.0 + mu) + mu * mu));
}

// Returns the logarithm of a quotient: the energy that an anisotropic interface sends to both
// sides, divided by that of an isotropic one with the alpha of albedo_turned_stand_in(). The
// quotient varies little, so few nodes suffice. `at`: coordinates along mu, roughness, aspect,
// azimuth and eta.
double turned_glass(const double at[5], int inside)
{
    const double least = ALBEDO_TURNED_GLASS_ROUGHNESS_LEAST;
    double roughness = least + (1.0 - least) * at[1];
    struct anisotropy a = axis_anisotropy((roughness - 0.01) / 0.99, at[2], at[3]);
    double eta = axis_eta(ALBEDO_TURNED_GLASS_ETA_LAST * at[4], inside);
    double root_k = sqrt(fabs((eta - 1.0) * (eta + 1.0)));
    double scale = inside ? a.alpha_o + 0.6 * root_k / (1.0 + root_k) : a.alpha_o;
    double mu = fmax(1e-4, axis_mu(at[0], scale));
    double along = square(a.alpha_o), both = square(a.alpha_x) + square(a.alpha_y);
    double variance = along + 0.5 * mu * mu * (both - 2.0 * along);
    double stand_in = sqrt(variance / sqrt(1.0 + square(variance)));
    if (at[4] == 0.0) // the interface transmits everything, except for masking
        return log(ggx_masking(mu, a.alpha_o) / ggx_masking(mu, stand_in));
    const double alphas[2] = {a.alpha_x, a.alpha_y}, isotropic[2] = {stand_in, stand_in};
    struct interface turned = make_interface(mu, a.phi, alphas, eta);
    struct interface round = make_interface(mu, 0.0, isotropic, eta);
    return log(interface_albedo(&turned, 2.0 * PI, 24, 32) / interface_albedo(&round, PI, 24, 16));
}

double albedo_charlie(double x, double y)
{
    double roughness = 0.1 + 0.9 * y;
    double mu = axis_mu(x, roughness);
    double a = roughness * roughness;
    double sin_o = sqrt(1.0 - mu * mu);
    double sum = 0.0;
    const int rows = 96, columns = 48;
    for (int i = 0; i < rows; i++)
        for (int j = 0; j < columns; j++) {
            // Squaring gathers points at grazing angles and near the azimuth opposite to wo, where
            // the fibres reflect most.
            double t = (i + 0.5) / rows, q = (j + 0.5) / columns;
            double cos_i = t * t, sin_i = sqrt(1.0 - cos_i * cos_i);
            double phi = PI * (1.0 - q * q);
            double x_h = sin_i * cos(phi) + sin_o, y_h = sin_i * sin(phi), z_h = cos_i + mu;
            double tangential = x_h * x_h + y_h * y_h;
            double sin2 = tangential / (tangential + z_h * z_h);
            double d = (2.0 + 1.0 / a) * pow(sin2, 0.5 / a) / (2.0 * PI);
            double g = d / (4.0 * (cos_i + mu - cos_i * mu));
            sum += g * cos_i * (2.0 * t / rows) * 2.0 * (2.0 * PI * q / columns);
        }
    return sum;
}

// Returns the albedo of a coat of weight 1, with Schlick's reflectance or that of index 1.5.
static double albedo_of_coat(double x, double y, bool is_exact)
{
    double mu = axis_mu(x, 0.25);
    double a = 0.1 + (0.001 - 0.1) * y;
    double sin_o = sqrt(1.0 - mu * mu);
    double sum = 0.0;
    const int rows = 128, columns = 32;
    for (int i = 0; i < rows; i++)
        for (int j = 0; j < columns; j++) {
            double t = (i + 0.5) / rows;
            double u = t * t * (3.0 - 2.0 * t);
            double phi = PI * (j + 0.5) / columns;
            double cos2 = (1.0 - pow(a * a, 1.0 - u)) / (1.0 - a * a);
            double h_z = sqrt(cos2), h_xy = sqrt(1.0 - cos2);
            double cosine = sin_o * h_xy * cos(phi) + mu * h_z;
            double wi_z = 2.0 * cosine * h_z - mu;
            if (wi_z <= 0.0 || cosine <= 0.0)
                continue;
            double length_o = sqrt(0.0625 * (1.0 - mu * mu) + mu * mu);
            double length_i = sqrt(0.0625 * (1.0 - wi_z * wi_z) + wi_z * wi_z);
            double g1_over_mu = 2.0 / (mu + length_o), g1_i = 2.0 * wi_z / (wi_z + length_i);
            double f = is_exact ? fresnel(cosine, 1.5) : 0.04 + 0.96 * schlick_weight(cosine);
            sum += 0.25 * f * g1_over_mu * g1_i * cosine / h_z * 6.0 * t * (1.0 - t) /
                   (rows * columns);
        }
    return sum;
}

double albedo_coat(double x, double y)
{
    return albedo_of_coat(x, y, false);
}

double albedo_coat_exact(double x, double y)
{
    return albedo_of_coat(x, y, true);
}

// Writes the albedos of Burley's subsurface approximation at roughnesses 0, 1/2 and 1 to out[0] to
// out[2], and that of his sheen to out[3].
void albedo_diffuse(double x, double out[4])
{
    double mu = axis_mu(x, 0.2);
    double sin_o = sqrt(1.0 - mu * mu);
    const int rows = 256, columns = 64;
    memset(out, 0, 4 * sizeof *out);
    for (int i = 0; i < rows; i++)
        for (int j = 0; j < columns; j++) {
            double t = (i + 0.5) / rows;
            double cos_i = t * t, sin_i = sqrt(1.0 - cos_i * cos_i);
            double phi = PI * (j + 0.5) / columns;
            double cos2_d = 0.5 * (1.0 + cos_i * mu + sin_i * sin_o * cos(phi));
            double measure = 2.0 * cos_i * 2.0 * t / (rows * columns); // cos / pi
            for (int r = 0; r < 3; r++) {
                double f90 = r * 0.5 * cos2_d;
                double f = (1.0 + (f90 - 1.0) * schlick_weight(cos_i)) *
                           (1.0 + (f90 - 1.0) * schlick_weight(mu));
                out[r] += measure * 1.25 * (f * (1.0 / (cos_i + mu) - 0.5) + 0.5);
            }
            out[3] += measure * PI * schlick_weight(sqrt(cos2_d));
        }
}
