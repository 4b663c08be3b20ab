#include "bsdf_grid.h"

#include "bsdf_covering.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

// --- axes ----------------------------------------------------------------------------------------

static const double roughnesses[] = {0, 1e-4, 0.01, 0.03, 0.1, 0.3, 0.7, 1};
static const double few_roughnesses[] = {0, 0.01, 0.1, 0.3, 1};
static const double iors[] = {1, 1.0001, 1.33, 1.5, 2.42, 4};
static const double angles[] = {0, 30, 60, 80, 89, 89.9, 89.99};
static const double thirds[] = {0, 0.5, 1};
static const double switches[] = {0, 1};
static const double coats[] = {0, 1, 2, 3}; // gloss 0 and 1; GGX with roughness .01 and .5
static const double exponents[] = {0, 1, 32, 1e3, 1e5};
static const double kinds3[] = {0, 1, 2}, kinds5[] = {0, 1, 2, 3, 4};
static const double maskings[] = {0, 1, 2, 3, 4, 5, 6};
_Static_assert(sizeof maskings / sizeof *maskings == MASKING_COUNT, "all are tested");

enum axis {
    AXIS_ANGLE,
    AXIS_ROUGHNESS,
    AXIS_IOR,
    AXIS_INSIDE,
    AXIS_ALBEDO,
    AXIS_METALLIC,
    AXIS_TRANSMISSION,
    AXIS_ANISOTROPIC,
    AXIS_CLEARCOAT,
    AXIS_COAT,
    AXIS_SHEEN,
    AXIS_CHARLIE,
    AXIS_SUBSURFACE,
    AXIS_THIN,
    AXIS_COMPENSATE,
    AXIS_SEPARABLE,
    AXIS_TINT,
    AXIS_SPECULAR,
    AXIS_TINT_EACH,
    AXIS_THROUGH, // diffuse transmission
    AXIS_LAYERS,
    AXIS_MODEL,
    AXIS_EXPONENT,
    AXIS_DISTRIBUTION,
    AXIS_MASKING,
    AXIS_EXACT,
    AXIS_UNCOUPLED,
    AXIS_MIXED,
    AXIS_EXACT_COAT,
    AXIS_COUNT
};

struct axis_values {
    enum axis axis;
    const double *values;
    uint32_t count;
};
#define VALUES(axis, values)                                                                       \
    {                                                                                              \
        axis, values, sizeof values / sizeof *values                                               \
    }

struct group {
    const char *name;
    struct axis_values axes[COVERING_MAX_AXES];
    uint32_t axis_count;
};

static const uint32_t simple_models[] = {MATERIAL_LAMBERT, MATERIAL_MIRROR, MATERIAL_CONDUCTOR,
                                         MATERIAL_PHONG, MATERIAL_BLINN_PHONG};

enum { GROUP_PRINCIPLED, GROUP_DIELECTRIC, GROUP_MICROFACET, GROUP_SIMPLE, GROUPS };
static const struct group groups[GROUPS] = {
    [GROUP_PRINCIPLED] = {"principled",
                          {VALUES(AXIS_ANGLE, angles),
                           VALUES(AXIS_ROUGHNESS, roughnesses),
                           VALUES(AXIS_IOR, iors),
                           VALUES(AXIS_INSIDE, switches),
                           VALUES(AXIS_ALBEDO, thirds),
                           VALUES(AXIS_METALLIC, thirds),
                           VALUES(AXIS_TRANSMISSION, thirds),
                           VALUES(AXIS_ANISOTROPIC, thirds),
                           VALUES(AXIS_CLEARCOAT, switches),
                           VALUES(AXIS_COAT, coats),
                           VALUES(AXIS_SHEEN, switches),
                           VALUES(AXIS_CHARLIE, switches),
                           VALUES(AXIS_SUBSURFACE, thirds),
                           VALUES(AXIS_THIN, switches),
                           VALUES(AXIS_COMPENSATE, switches),
                           VALUES(AXIS_SEPARABLE, switches),
                           VALUES(AXIS_TINT, switches),
                           VALUES(AXIS_SPECULAR, thirds),
                           VALUES(AXIS_TINT_EACH, switches),
                           VALUES(AXIS_THROUGH, thirds),
                           VALUES(AXIS_LAYERS, switches),
                           VALUES(AXIS_MIXED, switches),
                           VALUES(AXIS_EXACT_COAT, switches)},
                          23},
    [GROUP_DIELECTRIC] = {"dielectric",
                          {VALUES(AXIS_ANGLE, angles), VALUES(AXIS_ROUGHNESS, roughnesses),
                           VALUES(AXIS_IOR, iors), VALUES(AXIS_INSIDE, switches),
                           VALUES(AXIS_THIN, switches), VALUES(AXIS_SEPARABLE, switches)},
                          6},
    [GROUP_MICROFACET] = {"microfacet",
                          {VALUES(AXIS_ANGLE, angles), VALUES(AXIS_ROUGHNESS, few_roughnesses),
                           VALUES(AXIS_ALBEDO, thirds), VALUES(AXIS_SPECULAR, thirds),
                           VALUES(AXIS_DISTRIBUTION, kinds3), VALUES(AXIS_MASKING, maskings),
                           VALUES(AXIS_EXACT, switches), VALUES(AXIS_INSIDE, switches),
                           VALUES(AXIS_SEPARABLE, switches), VALUES(AXIS_UNCOUPLED, switches)},
                          10},
    [GROUP_SIMPLE] = {"simple",
                      {VALUES(AXIS_ANGLE, angles), VALUES(AXIS_MODEL, kinds5),
                       VALUES(AXIS_ROUGHNESS, few_roughnesses), VALUES(AXIS_ALBEDO, thirds),
                       VALUES(AXIS_SPECULAR, thirds), VALUES(AXIS_EXPONENT, exponents),
                       VALUES(AXIS_SEPARABLE, switches), VALUES(AXIS_INSIDE, switches)},
                      8},
};

// --- one configuration ---------------------------------------------------------------------------

// Sets a colour from one value, with different channels: white, black, or in between.
static void set_color(float color[3], double value)
{
    static const double spread[3] = {0, -0.3, 0.3};
    for (int c = 0; c < 3; c++)
        color[c] = (float)(value + spread[c] * 4 * value * (1 - value));
}

static void set_flag(struct material *m, uint32_t flag, double value)
{
    m->flags = value >= 0.5 ? m->flags | flag : m->flags & ~flag;
}

static void set_principled(struct material *m, const double *v)
{
    m->metallic = (float)v[AXIS_METALLIC];
    m->transmission = (float)v[AXIS_TRANSMISSION];
    m->anisotropic = (float)v[AXIS_ANISOTROPIC];
    m->anisotropic_rotation = m->anisotropic > 0 ? 0.11f : 0.0f;
    m->clearcoat = (float)v[AXIS_CLEARCOAT];
    set_flag(m, MATERIAL_COAT_GGX, v[AXIS_COAT] >= 2);
    m->clearcoat_gloss = v[AXIS_COAT] < 0.5 ? 0.0f : 1.0f;
    m->clearcoat_roughness = v[AXIS_COAT] < 2.5 ? 0.01f : 0.5f;
    m->sheen = (float)v[AXIS_SHEEN];
    m->sheen_tint = (float)v[AXIS_TINT];
    m->specular_tint = (float)v[AXIS_TINT];
    set_color(m->sheen_color, v[AXIS_CHARLIE]);
    m->sheen_roughness = (float)v[AXIS_SUBSURFACE]; // shares an axis
    m->subsurface = (float)v[AXIS_SUBSURFACE];
    m->specular = (float)v[AXIS_SPECULAR];
    m->specular_weight = v[AXIS_SPECULAR] > 0.9 ? 0.75f : 1.0f;
    m->diffuse_transmission = m->flags & MATERIAL_THIN ? (float)v[AXIS_THROUGH] : 0.0f;
    set_flag(m, MATERIAL_TINT_EACH, v[AXIS_TINT_EACH]);
    set_flag(m, MATERIAL_GLTF_LAYERS, v[AXIS_LAYERS]);
    set_flag(m, MATERIAL_MIXED_FRESNEL, v[AXIS_MIXED]);
    set_flag(m, MATERIAL_EXACT_COAT, v[AXIS_EXACT_COAT]);
}

// Sets the index of refraction of gold, of a silver-like metal or of an absorbing insulator, for
// each channel.
static void set_metal(struct material *m, double kind)
{
    static const float eta[3][3] = {{0.14f, 0.37f, 1.44f}, {0.05f, 0.06f, 0.05f}, {2, 1.5f, 1.2f}};
    static const float k[3][3] = {{3.98f, 2.38f, 1.6f}, {4.2f, 3.5f, 2.6f}, {0, 0.1f, 0.01f}};
    int i = (int)(2 * kind + 0.5);
    memcpy(m->conductor_eta, eta[i], sizeof m->conductor_eta);
    memcpy(m->conductor_k, k[i], sizeof m->conductor_k);
}

// Sets a direction with any azimuth, except for narrow lobes near the horizon: then it is along x,
// so that rounding does not affect the direction across, in which such lobes are narrow.
static void set_direction(struct configuration *c, double degrees, uint32_t number)
{
    // the golden angle
    double angle = degrees * M_PI / 180, azimuth = 2.399963229728653 * (number + 1);
    const struct material *m = &c->material;
    bool narrow_coat =
        m->clearcoat > 0 && (m->clearcoat_roughness < 0.1f || m->clearcoat_gloss > 0.5f);
    if ((m->roughness < 0.2f || narrow_coat) && degrees >= 89)
        azimuth = 0;
    c->angle = degrees;
    c->wo[0] = (float)(sin(angle) * cos(azimuth));
    c->wo[1] = (float)(sin(angle) * sin(azimuth));
    c->wo[2] = (float)cos(angle);
}

static const char *model_of(int group, const double *v, uint32_t *model)
{
    static const uint32_t by_group[] = {MATERIAL_PRINCIPLED, MATERIAL_DIELECTRIC,
                                        MATERIAL_MICROFACET, 0};
    *model = group == GROUP_SIMPLE ? simple_models[(int)(v[AXIS_MODEL] + 0.5)] : by_group[group];
    return material_model_names[*model];
}

static void describe(struct configuration *c, const struct material *m, const char *model)
{
    int length = snprintf(c->name, sizeof c->name, "%s r%g eta%g at%g", model, (double)m->roughness,
                          (double)c->eta, c->angle);
    size_t at = (size_t)length;
    if (m->model == MATERIAL_PRINCIPLED)
        length =
            snprintf(c->name + at, sizeof c->name - at,
                     " c%g m%g t%g a%g cc%g sh%g ch%g ss%g sp%g dt%g", (double)m->base_color[0],
                     (double)m->metallic, (double)m->transmission, (double)m->anisotropic,
                     (double)m->clearcoat, (double)m->sheen, (double)m->sheen_color[0],
                     (double)m->subsurface, (double)m->specular, (double)m->diffuse_transmission);
    else
        length =
            snprintf(c->name + at, sizeof c->name - at, " c%g s%g n%g", (double)m->base_color[0],
                     (double)m->specular_color[0], (double)m->exponent);
    at += (size_t)length;
    if (at < sizeof c->name)
        snprintf(c->name + at, sizeof c->name - at, " flags %x", m->flags);
}

static void configure(struct configuration *c, int group, const double *v, uint32_t number)
{
    struct material *m = &c->material;
    *c = (struct configuration){0};
    material_init(m);
    const char *model = model_of(group, v, &m->model);
    m->roughness = (float)v[AXIS_ROUGHNESS];
    m->ior = (float)v[AXIS_IOR];
    c->eta = v[AXIS_INSIDE] >= 0.5 ? 1 / m->ior : m->ior;
    set_color(m->base_color, v[AXIS_ALBEDO]);
    set_flag(m, MATERIAL_THIN, v[AXIS_THIN]);
    set_flag(m, MATERIAL_SEPARABLE, v[AXIS_SEPARABLE]);
    set_flag(m, MATERIAL_COMPENSATE, v[AXIS_COMPENSATE]);
    set_flag(m, MATERIAL_EXACT_FRESNEL, v[AXIS_EXACT]);
    set_flag(m, MATERIAL_UNCOUPLED, v[AXIS_UNCOUPLED]);
    m->exponent = (float)v[AXIS_EXPONENT];
    set_color(m->specular_color, v[AXIS_SPECULAR]);
    set_metal(m, v[AXIS_ALBEDO]);
    m->flags |= (uint32_t)v[AXIS_DISTRIBUTION] << MATERIAL_DISTRIBUTION_SHIFT;
    m->flags |= (uint32_t)v[AXIS_MASKING] << MATERIAL_MASKING_SHIFT;
    if (m->model == MATERIAL_PRINCIPLED)
        set_principled(m, v);
    set_direction(c, v[AXIS_ANGLE], number);
    describe(c, m, model);
    m->name = c->name;
}

static void defaults(double *v)
{
    memset(v, 0, AXIS_COUNT * sizeof *v);
    v[AXIS_IOR] = 1.5;
    v[AXIS_ALBEDO] = 1;
    v[AXIS_COMPENSATE] = 1;
    v[AXIS_SPECULAR] = 0.5;
    v[AXIS_EXPONENT] = 32;
}

// --- the covering array and the corners ----------------------------------------------------------

static uint32_t cover_group(int group, struct configuration *out, uint32_t capacity)
{
    static uint8_t rows[512][COVERING_MAX_AXES];
    const struct group *g = &groups[group];
    uint8_t counts[COVERING_MAX_AXES];
    for (uint32_t a = 0; a < g->axis_count; a++)
        counts[a] = (uint8_t)g->axes[a].count;
    uint32_t count = covering_build(counts, g->axis_count, rows, 512);
    count = count < capacity ? count : capacity;
    for (uint32_t i = 0; i < count; i++) {
        double v[AXIS_COUNT];
        defaults(v);
        for (uint32_t a = 0; a < g->axis_count; a++)
            v[g->axes[a].axis] = g->axes[a].values[rows[i][a]];
        configure(&out[i], group, v, i);
    }
    return count;
}

// Adds the smoothest and roughest materials, seen along the normal and near the horizon: opaque,
// metal and glass.
static uint32_t corners(struct configuration *out, uint32_t capacity)
{
    static const double ends[2] = {0.01, 1}, directions[2] = {0, 89.99};
    uint32_t count = 0;
    for (int i = 0; i < 16 && count < capacity; i++) {
        double v[AXIS_COUNT];
        defaults(v);
        v[AXIS_ROUGHNESS] = ends[i & 1];
        v[AXIS_ANGLE] = directions[i >> 1 & 1];
        v[AXIS_METALLIC] = i >> 2 == 1;
        v[AXIS_TRANSMISSION] = i >> 2 >= 2;
        v[AXIS_INSIDE] = i >> 2 == 3;
        configure(&out[count++], GROUP_PRINCIPLED, v, (uint32_t)i);
    }
    return count;
}

uint32_t grid_covering(struct configuration *out, uint32_t capacity)
{
    uint32_t count = 0;
    for (int group = 0; group < GROUPS; group++)
        count += cover_group(group, out + count, capacity - count);
    return count + corners(out + count, capacity - count);
}

// --- random points -------------------------------------------------------------------------------

static double next_random(uint64_t *state)
{
    *state = *state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(*state >> 11) * 0x1p-53;
}

// Returns whether an axis has values between those listed; kinds and switches have none.
static bool is_continuous(enum axis axis)
{
    static const enum axis kinds[] = {
        AXIS_INSIDE,    AXIS_COAT,  AXIS_THIN,         AXIS_COMPENSATE, AXIS_MODEL,
        AXIS_SEPARABLE, AXIS_EXACT, AXIS_DISTRIBUTION, AXIS_MASKING,    AXIS_TINT_EACH,
        AXIS_LAYERS,    AXIS_IOR,   AXIS_UNCOUPLED,    AXIS_MIXED,      AXIS_EXACT_COAT};
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
        if (axis == kinds[i])
            return false;
    return true;
}

uint32_t grid_random(struct configuration *out, uint32_t count, uint64_t seed)
{
    // Half of the points use the principled model.
    static const int group_of[8] = {0, 0, 0, 0, 1, 1, 2, 3};
    for (uint32_t i = 0; i < count; i++) {
        const struct group *g = &groups[group_of[i % 8]];
        double v[AXIS_COUNT];
        defaults(v);
        for (uint32_t a = 0; a < g->axis_count; a++) {
            const struct axis_values *axis = &g->axes[a];
            uint32_t at = (uint32_t)(next_random(&seed) * axis->count);
            v[axis->axis] = axis->values[at];
            if (is_continuous(axis->axis) && at + 1 < axis->count && next_random(&seed) < 0.5)
                v[axis->axis] += next_random(&seed) * (axis->values[at + 1] - axis->values[at]);
        }
        configure(&out[i], group_of[i % 8], v, i);
    }
    return count;
}

// --- charts --------------------------------------------------------------------------------------

static void add_lobe(struct chart *chart, double x, double y)
{
    chart->alpha[chart->lobes][0] = fmax(x, SMALLEST_SCALE);
    chart->alpha[chart->lobes++][1] = fmax(y, SMALLEST_SCALE);
}

static void add_principled_lobes(const struct material *m, struct chart *chart)
{
    double aspect = sqrt(1 - 0.9 * (double)m->anisotropic);
    double alpha = (double)m->roughness * (double)m->roughness;
    double turn = 2 * M_PI * (double)m->anisotropic_rotation;
    add_lobe(chart, alpha / aspect, alpha * aspect);
    chart->turn[0] = cos(turn);
    chart->turn[1] = sin(turn);
    if (m->clearcoat > 0) {
        double coat = m->flags & MATERIAL_COAT_GGX
                          ? (double)m->clearcoat_roughness * (double)m->clearcoat_roughness
                          : 0.1 - 0.099 * (double)m->clearcoat_gloss;
        add_lobe(chart, coat, coat);
    }
}

// Returns tan(theta / 2) of the angle theta at which cos^n is 1 / e, where n is the power of the
// cosine of theta (Phong), or of theta / 2, the half-vector's angle (Blinn-Phong).
static double scale_of_power(const struct material *m)
{
    double n = fmax((double)m->exponent, 1);
    return fmin(1, m->model == MATERIAL_PHONG ? sqrt(1 / (2 * n)) : sqrt(2 / n));
}

void grid_charts(const struct configuration *configuration, struct chart charts[SIDES])
{
    const struct material *m = &configuration->material;
    struct chart chart = {.eta = (double)configuration->eta, .turn = {1, 0}};
    chart_unit(configuration->wo, chart.wo);
    if (m->model == MATERIAL_PRINCIPLED)
        add_principled_lobes(m, &chart);
    else if (m->model == MATERIAL_PHONG || m->model == MATERIAL_BLINN_PHONG)
        add_lobe(&chart, scale_of_power(m), scale_of_power(m));
    else
        add_lobe(&chart, (double)m->roughness * (double)m->roughness,
                 (double)m->roughness * (double)m->roughness);
    double narrowest = 1;
    for (int i = 0; i < chart.lobes; i++)
        narrowest = fmin(narrowest, fmin(chart.alpha[i][0], chart.alpha[i][1]));

    // Half-vectors are used if the lobes are narrow, or if grazing directions make them narrow.
    bool by_half = narrowest < 0.05 || configuration->angle > 80;
    charts[0] = charts[1] = chart;
    charts[1].below = true;
    charts[0].kind = by_half ? CHART_REFLECT : CHART_SPHERE;
    if (m->model == MATERIAL_LAMBERT || m->model == MATERIAL_MIRROR)
        charts[0].kind = CHART_SPHERE;
    if (m->model == MATERIAL_PHONG)
        charts[0].kind = CHART_MIRROR;
    charts[1].kind = charts[0].kind;
    bool refracts = (m->model == MATERIAL_DIELECTRIC || m->model == MATERIAL_PRINCIPLED) &&
                    !(m->flags & MATERIAL_THIN) && configuration->eta != 1.0f;
    if (refracts && (by_half || fabs(chart.eta - 1) < 0.2))
        charts[1].kind = CHART_REFRACT;
}

bool grid_gains(const struct configuration *configuration)
{
    uint32_t flags = configuration->material.flags;
    uint32_t masking = flags >> MATERIAL_MASKING_SHIFT & 7u;
    return configuration->material.model == MATERIAL_MICROFACET &&
           (flags & MATERIAL_UNCOUPLED || masking == MASKING_RATIONAL_UNBOUNDED);
}
