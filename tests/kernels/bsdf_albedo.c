#include "bsdf_albedo.h"

#include "render/tables/albedo_tables.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

static double float_at(uint32_t word, uint32_t component)
{
    float value;
    memcpy(&value, &albedo_tables[word][component], sizeof value);
    return (double)value;
}

static double axis_mu(double mu, double scale)
{
    return sqrt(mu * (1 + scale) / (mu + scale));
}

static double axis_alpha(double alpha)
{
    return fmin(fmax((pow(alpha, 0.25) - 0.1) / 0.9, 0), 1);
}

// Returns the cell of a coordinate in [0, 1], and the fraction within the cell.
static uint32_t find_cell(double at, uint32_t cells, double *fraction)
{
    double position = fmin(fmax(at, 0), 1) * cells, corner = fmin(floor(position), cells - 1.0);
    *fraction = position - corner;
    return (uint32_t)corner;
}

static double mix(double a, double b, double w)
{
    return a + (b - a) * w;
}

static double quad(uint32_t first, uint32_t width, uint32_t height, double x, double y)
{
    double u, v;
    uint32_t i = find_cell(x, width, &u), j = find_cell(y, height, &v);
    uint32_t word = first + j * width + i;
    return mix(mix(float_at(word, 0), float_at(word, 1), u),
               mix(float_at(word, 2), float_at(word, 3), u), v);
}

// Interpolates a table with eight values of 16 bits per cell.
static double cube(uint32_t first, const uint32_t size[3], const double at[3])
{
    uint32_t cell[3];
    double w[3], corner[8];
    for (int a = 0; a < 3; a++)
        cell[a] = find_cell(at[a], size[a], &w[a]);
    const uint32_t *word = albedo_tables[first + (cell[2] * size[1] + cell[1]) * size[0] + cell[0]];
    for (int c = 0; c < 8; c++)
        corner[c] = (word[c / 2] >> (16 * (c & 1)) & 0xffff) * (ALBEDO_HIGHEST / 65535.0);
    double low = mix(mix(corner[0], corner[1], w[0]), mix(corner[2], corner[3], w[0]), w[1]);
    double high = mix(mix(corner[4], corner[5], w[0]), mix(corner[6], corner[7], w[0]), w[1]);
    return fmin(1, mix(low, high, w[2]));
}

double table_ggx(double mu, double alpha)
{
    return fmin(1, quad(ALBEDO_GGX, ALBEDO_GGX_MU, ALBEDO_GGX_ALPHA, axis_mu(mu, alpha),
                        axis_alpha(alpha)));
}

double table_schlick(double mu, double alpha)
{
    return quad(ALBEDO_SCHLICK, ALBEDO_SCHLICK_MU, ALBEDO_SCHLICK_ALPHA, axis_mu(mu, alpha + 0.2),
                axis_alpha(alpha));
}

double table_charlie(double mu, double roughness)
{
    return quad(ALBEDO_CHARLIE, ALBEDO_CHARLIE_MU, ALBEDO_CHARLIE_ROUGHNESS, axis_mu(mu, roughness),
                (roughness - 0.1) / 0.9);
}

double table_coat(double mu, double gloss)
{
    return quad(ALBEDO_COAT, ALBEDO_COAT_MU, ALBEDO_COAT_GLOSS, axis_mu(mu, 0.25), gloss);
}

double table_coat_exact(double mu, double gloss)
{
    return quad(ALBEDO_COAT_EXACT, ALBEDO_COAT_MU, ALBEDO_COAT_GLOSS, axis_mu(mu, 0.25), gloss);
}

static double diffuse(double mu, uint32_t component)
{
    double u;
    uint32_t i = find_cell(axis_mu(mu, 0.2), ALBEDO_DIFFUSE_MU, &u);
    return mix(float_at(ALBEDO_DIFFUSE + i, component), float_at(ALBEDO_DIFFUSE + i + 1, component),
               u);
}

double table_below(double mu, double roughness)
{
    return diffuse(mu, 0) + roughness * (diffuse(mu, 1) + roughness * diffuse(mu, 2));
}

double table_sheen(double mu)
{
    return diffuse(mu, 3);
}

double table_fresnel(double mu, double alpha, double eta)
{
    bool inside = eta < 1;
    double root_k = sqrt(fabs(eta * eta - 1)), x;
    double beyond = (mu - root_k) / (inside && mu > root_k ? 1 - root_k : root_k);
    if (inside)
        x = 0.5 + 0.5 * copysign(sqrt(fabs(beyond)), beyond);
    else
        x = axis_mu(mu, alpha + 0.6 * root_k / (1 + root_k));
    const uint32_t size[3] = {ALBEDO_FRESNEL_MU, ALBEDO_FRESNEL_ALPHA, ALBEDO_FRESNEL_ETA};
    const double at[3] = {x, axis_alpha(alpha), pow(fabs(eta - 1) / (eta + 1), 0.25)};
    return cube(ALBEDO_FRESNEL + (inside ? ALBEDO_FRESNEL_SIDE : 0), size, at);
}

// Returns a node, from 0 to 65535, of a table stored in runs of eight along the first axis.
static double runs(uint32_t first, const uint32_t size[3], const double at[3])
{
    double w[3], sum = 0;
    uint32_t cell[3], row = size[0] / ALBEDO_RUN;
    for (int a = 0; a < 3; a++)
        cell[a] = find_cell(at[a], size[a], &w[a]);
    for (uint32_t b = 0; b < 8; b++) {
        uint32_t place = cell[0] % ALBEDO_RUN + (b & 1);
        uint32_t n = ((cell[2] + (b >> 2)) * (size[1] + 1) + cell[1] + (b >> 1 & 1)) * row +
                     cell[0] / ALBEDO_RUN;
        uint32_t value = albedo_tables[first + n][place / 2] >> (16 * (place & 1)) & 0xffff;
        double weight = 1;
        for (int a = 0; a < 3; a++)
            weight *= b >> a & 1 ? w[a] : 1 - w[a];
        sum += weight * value;
    }
    return sum;
}

static double root_of_glass(double mu, double alpha, double eta, uint32_t first,
                            const uint32_t size[3])
{
    double root_k = sqrt(fabs(eta * eta - 1));
    double scale = eta < 1 ? alpha + 0.6 * root_k / (1 + root_k) : alpha;
    const double at[3] = {axis_mu(mu, scale), axis_alpha(alpha),
                          pow(fabs(eta - 1) / (eta + 1), 0.25)};
    return fmin(1, runs(first, size, at) * ALBEDO_HIGHEST / 65535);
}

double table_glass(double mu, double alpha, double eta)
{
    const uint32_t size[2][3] = {
        {ALBEDO_GLASS_MU, ALBEDO_GLASS_ALPHA, ALBEDO_GLASS_ETA},
        {ALBEDO_GLASS_INSIDE_MU, ALBEDO_GLASS_INSIDE_ALPHA, ALBEDO_GLASS_INSIDE_ETA}};
    double root =
        root_of_glass(mu, alpha, eta, eta < 1 ? ALBEDO_GLASS_INSIDE : ALBEDO_GLASS, size[eta < 1]);
    return root * root;
}

double table_clear(double mu, double alpha, double eta)
{
    const uint32_t size[3] = {ALBEDO_CLEAR_MU, ALBEDO_CLEAR_ALPHA, ALBEDO_CLEAR_ETA};
    double root =
        root_of_glass(mu, alpha, eta, ALBEDO_CLEAR + (eta < 1 ? ALBEDO_CLEAR_SIDE : 0), size);
    return root * root;
}

// --- anisotropic ---------------------------------------------------------------------------------

static double slices(uint32_t first, const uint32_t size[4], const double at[4])
{
    double w;
    uint32_t slice = size[0] * size[1] * size[2];
    first += find_cell(at[3], size[3], &w) * slice;
    return mix(cube(first, size, at), cube(first + slice, size, at), w);
}

// The mu axis has the scale alpha_o + `more`.
static void turned_axes(const double wo[3], double roughness, double anisotropic,
                        const double alpha[2], double more, double at[4])
{
    double x = fabs(wo[0]), y = fabs(wo[1]), sine = hypot(x, y);
    double alpha_o = sine > 0 ? hypot(alpha[0] * x, alpha[1] * y) / sine : alpha[0];
    at[0] = axis_mu(wo[2], alpha_o + more);
    at[1] = (roughness - 0.01) / 0.99;
    at[2] = log(1 - 0.9 * anisotropic) / log(0.1);
    at[3] = sine > 0 ? atan2(y * sqrt(alpha[1]), x * sqrt(alpha[0])) / (M_PI / 2) : 0;
}

double table_turned(const double wo[3], double roughness, double anisotropic, const double alpha[2])
{
    const uint32_t size[4] = {ALBEDO_TURNED_MU, ALBEDO_TURNED_ROUGHNESS, ALBEDO_TURNED_ASPECT,
                              ALBEDO_TURNED_AZIMUTH};
    double at[4];
    turned_axes(wo, roughness, anisotropic, alpha, 0, at);
    return slices(ALBEDO_TURNED, size, at);
}

double table_turned_cosine(const double wo[3], double roughness, double anisotropic,
                           const double alpha[2])
{
    const uint32_t size[4] = {ALBEDO_SINE_MU, ALBEDO_SINE_ROUGHNESS, ALBEDO_SINE_ASPECT,
                              ALBEDO_SINE_AZIMUTH};
    double at[4];
    turned_axes(wo, roughness, anisotropic, alpha, 0.2, at);
    return 1 - slices(ALBEDO_SINE, size, at);
}

double table_turned_glass(const double wo[3], double roughness, double anisotropic,
                          const double alpha[2], double eta, bool is_clear)
{
    const uint32_t size[3] = {ALBEDO_TURNED_GLASS_MU, ALBEDO_TURNED_GLASS_ROUGHNESS,
                              ALBEDO_TURNED_GLASS_ASPECT};
    const uint32_t azimuths = ALBEDO_TURNED_GLASS_AZIMUTH, etas = ALBEDO_TURNED_GLASS_ETA;
    double root_k = sqrt(fabs(eta * eta - 1)), at[4], u, v, value[2][2];
    turned_axes(wo, roughness, anisotropic, alpha, eta < 1 ? 0.6 * root_k / (1 + root_k) : 0, at);
    double least = ALBEDO_TURNED_GLASS_ROUGHNESS_LEAST, mu = wo[2];
    at[1] = (roughness - least) / (1 - least);
    double z = pow(fabs(eta - 1) / (eta + 1), 0.25) / ALBEDO_TURNED_GLASS_ETA_LAST;
    uint32_t azimuth = find_cell(at[3], azimuths, &u), slice = find_cell(z, etas, &v);
    for (uint32_t i = 0; i < 4; i++) {
        uint32_t n = (slice + i / 2) * (azimuths + 1) + azimuth + i % 2;
        value[i / 2][i % 2] = runs(ALBEDO_TURNED_GLASS + (eta < 1 ? ALBEDO_TURNED_GLASS_SIDE : 0) +
                                       n * ALBEDO_TURNED_GLASS_SLICE,
                                   size, at);
    }
    double log_of =
        mix(mix(value[0][0], value[0][1], u), mix(value[1][0], value[1][1], u), v) / 65535;
    double sine2 = wo[0] * wo[0] + wo[1] * wo[1], both = alpha[0] * alpha[0] + alpha[1] * alpha[1];
    double x = alpha[0] * wo[0], y = alpha[1] * wo[1];
    double along = sine2 > 0 ? (x * x + y * y) / sine2 : alpha[0] * alpha[0];
    double variance = along + mu * mu * (both / 2 - along);
    double stand_in = sqrt(variance) / pow(1 + variance * variance, 0.25);
    double isotropic = is_clear ? table_clear(mu, stand_in, eta) : table_glass(mu, stand_in, eta);
    return fmin(1, isotropic * exp((2 * log_of - 1) * ALBEDO_TURNED_GLASS_LOG));
}
