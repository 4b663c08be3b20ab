// Tests parts of the renderer's BSDFs against closed forms, tabulated values and quadrature in
// double precision.
#include "bsdf_albedo.h"
#include "bsdf_means.h"
#include "bsdf_optics.h"

// Tables are raised to be above the truth between their nodes: too small an albedo would make a
// layer return more light than it receives, too large a one loses a little.
#define TABLE_BELOW 1e-3
#define TABLE_ABOVE 1e-2

static struct bsdf_device device;
static struct configuration plate[32];

// A white conductor: |F - 1| <= 4e-7 for the index (0.001, 100) at normal incidence.
static void make_plate(struct configuration *c, double alpha, double mu, uint32_t flags)
{
    *c = (struct configuration){.eta = 1.5f};
    material_init(&c->material);
    c->material.model = MATERIAL_CONDUCTOR;
    c->material.flags = flags;
    c->material.roughness = (float)sqrt(alpha);
    for (int i = 0; i < 3; i++) {
        c->material.conductor_eta[i] = 1e-3f;
        c->material.conductor_k[i] = 100;
    }
    c->wo[0] = (float)sqrt(1 - mu * mu);
    c->wo[2] = (float)mu;
}

static bool open_plates(uint32_t count)
{
    static struct material materials[32];
    for (uint32_t i = 0; i < count; i++) {
        plate[i].material.name = "plate";
        materials[i] = plate[i].material;
    }
    return bsdf_device_open(&device, materials, count);
}

// --- albedo --------------------------------------------------------------------------------------

// The expected albedos were computed by quadrature in double precision; 1 - ln 2 for alpha 1 at
// normal incidence is exact.
TEST(ggx_albedo)
{
    static const double alphas[4] = {0.1, 0.25, 0.5, 1}, mus[4] = {1, 0.70710678, 0.5, 0.1};
    static const double expected[4][4] = {{0.98831, 0.98169, 0.96920, 0.88345},
                                          {0.91581, 0.88624, 0.85726, 0.89162},
                                          {0.68785, 0.68277, 0.69825, 0.86011},
                                          {0.30685, 0.37677, 0.45069, 0.76021}};
    double worst = 0;
    for (int i = 0; i < 16; i++)
        make_plate(&plate[i], alphas[i / 4], mus[i % 4], 0);
    make_plate(&plate[16], 1, 0.1, MATERIAL_SEPARABLE);
    if (!open_plates(17))
        return;
    for (uint32_t i = 0; i < 17; i++) {
        struct bsdf_means means;
        if (!bsdf_measure(&device, &plate[i], i, 8, 1 << 16, &means))
            return;
        double truth = i < 16 ? expected[i / 4][i % 4] : 0.5579;
        double error = fabs(means.albedo[0] - truth);
        CHECK(error <= 5e-4, "alpha %g, mu %g%s: %.5f +- %.5f instead of %.5f",
              i < 16 ? alphas[i / 4] : 1, i < 16 ? mus[i % 4] : 0.1, i < 16 ? "" : ", separable",
              means.albedo[0], means.albedo_error[0], truth);
        worst = fmax(worst, error);
    }
    printf("  GGX without compensation: within %.2g\n", worst);
    bsdf_device_close(&device);
}

// --- Fresnel -------------------------------------------------------------------------------------

// Computes the mean over the cosine-weighted hemisphere, by the midpoint rule on the renderer's
// function: with c = c0 + (1 - c0) x^2 from the critical angle on, below which it must be 1.
TEST(mean_fresnel)
{
    static const double etas[5] = {1.0001, 1.5, 2, 4, 1 / 1.5};
    static const double expected[5] = {3.33e-5, 0.0917780, 0.1605966, 0.3666381, 0.5963458};
    enum { STEPS = 1 << 16 };
    static union bsdf_item items[STEPS];
    make_plate(&plate[0], 0.1, 1, 0);
    if (!open_plates(1))
        return;
    for (int e = 0; e < 5; e++) {
        double critical = etas[e] < 1 ? sqrt(1 - etas[e] * etas[e]) : 0;
        double sum = critical * critical, worst = 0;
        for (uint32_t i = 0; i < STEPS; i++) {
            double x = (i + 0.5) / STEPS, c = critical + (1 - critical) * x * x;
            items[i] = (union bsdf_item){.in = {.wo = {(float)c, (float)etas[e]}, .material = 1}};
        }
        static union bsdf_item outputs[STEPS];
        memcpy(outputs, items, sizeof items);
        if (!bsdf_run(&device, BSDF_ROUTINE_FRESNEL, BSDF_LOBES_CLASS, &plate[0].material, outputs,
                      STEPS))
            return;
        for (uint32_t i = 0; i < STEPS; i++) {
            double x = (i + 0.5) / STEPS, c = critical + (1 - critical) * x * x;
            double got = (double)outputs[i].out[0];
            double truth = optics_fresnel((double)items[i].in.wo[0], (double)items[i].in.wo[1]);
            sum += 2 * got * c * (1 - critical) * 2 * x / STEPS;
            // At the critical angle itself the slope is infinite.
            if (c > critical + 1e-5)
                worst = fmax(worst, fabs(got - truth) / truth);
        }
        CHECK(fabs(sum - expected[e]) <= 1e-5, "eta %g: %.7f instead of %.7f", etas[e], sum,
              expected[e]);
        CHECK(fabs(sum - optics_mean_fresnel(etas[e])) <= 1e-6, "eta %g: reference %.7f", etas[e],
              optics_mean_fresnel(etas[e]));
        CHECK(worst <= 1e-3, "eta %g: %.3g from the reference", etas[e], worst);
        printf("  eta %.5g: mean %.7f, off by %.1g; pointwise %.1g\n", etas[e], sum,
               fabs(sum - expected[e]), worst);
    }
    bsdf_device_close(&device);
}

// --- normals -------------------------------------------------------------------------------------

// Integrates over the hemisphere of normals in the coordinates of bsdf_cells.h, by the midpoint
// rule.
enum { ROWS = 512, COLUMNS = 512, NODES = ROWS * COLUMNS };
static union bsdf_item nodes[NODES], values[NODES];
static double angles[NODES];

static bool integrate_normals(const double wo[3], const double alpha[2], double *normals,
                              double *visible, double *coat)
{
    struct chart chart = {.kind = CHART_NORMALS, .lobes = 1, .turn = {1, 0}};
    memcpy(chart.wo, wo, sizeof chart.wo);
    memcpy(chart.alpha[0], alpha, sizeof chart.alpha[0]);
    for (int i = 0; i < NODES; i++) {
        double h[3], x = (i / COLUMNS + 0.5) / ROWS, phi = (i % COLUMNS + 0.5) / COLUMNS * 2 * M_PI;
        angles[i] = chart_normal(&chart, x, phi, h) / ROWS / COLUMNS * 2 * M_PI;
        nodes[i] = (union bsdf_item){.in = {.material = 1}};
        for (int c = 0; c < 3; c++) {
            nodes[i].in.wo[c] = (float)wo[c];
            nodes[i].in.wi[c] = (float)h[c];
        }
        nodes[i].in.u[0] = (float)alpha[0];
        nodes[i].in.u[1] = (float)alpha[1];
    }
    memcpy(values, nodes, sizeof nodes);
    if (!bsdf_run(&device, BSDF_ROUTINE_MICROFACET, BSDF_LOBES_ALL, &plate[0].material, values,
                  NODES))
        return false;
    *normals = *visible = *coat = 0;
    for (int i = 0; i < NODES; i++) {
        double z = (double)nodes[i].in.wi[2];
        *normals += (double)values[i].out[0] * z * angles[i];
        *visible += (double)values[i].out[1] * angles[i];
        *coat += (double)values[i].out[3] * z * angles[i];
    }
    return true;
}

// The integral of D h.z must be 1 (within 1e-5), and so must that of the density of normals visible
// from wo, G1 D max(0, wo.h) / wo.z (Heitz 2014, eqs. 4 and 14). The latter is one half of the weak
// white furnace test; the other half is the Jacobian of reflection, which the closure of densities
// tests.
TEST(normals)
{
    static const double alphas[][2] = {{1e-4, 1e-4}, {1e-3, 1e-3}, {0.01, 0.01},   {0.1, 0.1},
                                       {0.5, 0.5},   {1, 1},       {0.0316, 1e-3}, {0.3, 0.03}};
    static const double tilts[] = {0, 30, 60, 80, 89, 89.9, 89.99};
    double worst_d = 0, worst_v = 0;
    make_plate(&plate[0], 0.1, 1, 0);
    if (!open_plates(1))
        return;
    for (size_t a = 0; a < sizeof alphas / sizeof *alphas; a++)
        for (size_t t = 0; t < sizeof tilts / sizeof *tilts; t++) {
            double tilt = tilts[t] * M_PI / 180, normals, visible, coat;
            const double wo[3] = {sin(tilt) * cos(1.0), sin(tilt) * sin(1.0), cos(tilt)};
            if (!integrate_normals(wo, alphas[a], &normals, &visible, &coat))
                return;
            CHECK(fabs(normals - 1) <= 1e-5, "alpha %g %g: D integrates to %.7f", alphas[a][0],
                  alphas[a][1], normals);
            CHECK(fabs(visible - 1) <= 1e-3, "alpha %g %g, %g degrees: weak furnace %.6f",
                  alphas[a][0], alphas[a][1], tilts[t], visible);
            worst_d = fmax(worst_d, fabs(normals - 1));
            worst_v = fmax(worst_v, fabs(visible - 1));
            if (alphas[a][0] == alphas[a][1] && alphas[a][0] >= 1e-3 && alphas[a][0] <= 0.1)
                CHECK(fabs(coat - 1) <= 1e-3, "GTR1 of alpha %g integrates to %.6f", alphas[a][0],
                      coat);
        }
    printf("  integral of D cos: 1 +- %.1g; weak furnace: 1 +- %.1g\n", worst_d, worst_v);
    bsdf_device_close(&device);
}

// --- tables --------------------------------------------------------------------------------------

enum integrand {
    E_GGX,
    E_SCHLICK,
    E_FRESNEL,
    E_CHARLIE,
    E_COAT,
    E_BELOW,
    E_SHEEN,
    E_COAT_EXACT,
    INTEGRANDS
};
static const char *const integrand_names[INTEGRANDS] = {
    "E1", "Schlick", "Fresnel", "Charlie", "coat", "subsurface", "sheen", "exact coat"};

struct point {
    double mu, alpha, eta, roughness;
    double anisotropic, phi; // azimuth of wo, only for interfaces that also refract
};

static double weight5(double cosine)
{
    return pow(1 - fmin(cosine, 1), 5);
}

static bool is_of_coat(enum integrand kind)
{
    return kind == E_COAT || kind == E_COAT_EXACT;
}

// Evaluates f cos of docs/materials.md, section by section.
static double evaluate(enum integrand kind, const struct point *p, const double wo[3],
                       const double wi[3])
{
    const double alpha[2] = {p->alpha, p->alpha}, quarter[2] = {0.25, 0.25};
    double h[3], cosine = optics_half_reflected(wo, wi, h), c_o = wo[2], c_i = wi[2];
    double sine2 = h[0] * h[0] + h[1] * h[1], f90 = p->roughness * cosine * cosine;
    double reflected = ggx_density(h, alpha) * ggx_masking_both(wo, wi, alpha, false) / (4 * c_o);
    double a = kind == E_CHARLIE ? p->roughness * p->roughness : 0.1 - 0.099 * p->roughness;
    double f_coat =
        kind == E_COAT ? optics_schlick(0.04, cosine) : optics_fresnel(fmin(cosine, 1), 1.5);
    switch (kind) {
    case E_GGX:
        return reflected;
    case E_SCHLICK:
        return reflected * weight5(cosine);
    case E_FRESNEL:
        return reflected * optics_fresnel(fmin(cosine, 1), p->eta);
    case E_CHARLIE:
        return (2 + 1 / a) * pow(sine2, 0.5 / a) / (2 * M_PI) * c_i / (4 * (c_o + c_i - c_o * c_i));
    case E_COAT:
    case E_COAT_EXACT:
        return 0.25 * f_coat * (a * a - 1) / (M_PI * log(a * a) * (a * a * h[2] * h[2] + sine2)) *
               ggx_masking(wo, quarter) * ggx_masking(wi, quarter) / (4 * c_o);
    case E_BELOW:
        return 1.25 / M_PI * c_i *
               ((1 + (f90 - 1) * weight5(c_o)) * (1 + (f90 - 1) * weight5(c_i)) *
                    (1 / (c_o + c_i) - 0.5) +
                0.5);
    default:
        return weight5(cosine) * c_i;
    }
}

// Integrates by the midpoint rule in a chart by half-vectors, which ends at the horizon.
static double integrate(enum integrand kind, const struct point *p)
{
    enum { STEPS = 200 };
    double scale = kind <= E_FRESNEL ? p->alpha : is_of_coat(kind) ? 0.1 - 0.099 * p->roughness : 1;
    struct chart chart = {.kind = CHART_REFLECT,
                          .wo = {sqrt(1 - p->mu * p->mu), 0, p->mu},
                          .alpha = {{scale, scale}},
                          .lobes = 1,
                          .turn = {1, 0}};
    double sum = 0;
    for (int j = 0; j < STEPS; j++) {
        // the other half mirrors this one
        double phi = (j + 0.5) / STEPS * M_PI, end = chart_end(&chart, phi);
        for (int i = 0; i < STEPS; i++) {
            double wi[3], jacobian;
            if (chart_direction(&chart, end * (i + 0.5) / STEPS, phi, wi, &jacobian))
                sum += evaluate(kind, p, chart.wo, wi) * jacobian * end;
        }
    }
    return sum * 2 * M_PI / STEPS / STEPS;
}

static double look_up(enum integrand kind, const struct point *p)
{
    switch (kind) {
    case E_GGX:
        return table_ggx(p->mu, p->alpha);
    case E_SCHLICK:
        return table_ggx(p->mu, p->alpha) * table_schlick(p->mu, p->alpha);
    case E_FRESNEL:
        return table_ggx(p->mu, p->alpha) * table_fresnel(p->mu, p->alpha, p->eta);
    case E_CHARLIE:
        return table_charlie(p->mu, p->roughness);
    case E_COAT:
        return table_coat(p->mu, p->roughness);
    case E_COAT_EXACT:
        return table_coat_exact(p->mu, p->roughness);
    case E_BELOW:
        return table_below(p->mu, p->roughness);
    default:
        return table_sheen(p->mu);
    }
}

// The nodes were raised so that the tables are above the truth between them. Checks this, and
// measures by how much.
TEST(albedo_tables)
{
    enum { POINTS = 40 };
    struct random random = {44};
    for (int kind = 0; kind < INTEGRANDS; kind++) {
        double most = 0, least = 0;
        for (int i = 0; i < POINTS; i++) {
            struct point p = {.mu = random_between(&random, 0.02, 1),
                              .alpha = pow(random_between(&random, 0.1, 1), 4),
                              .eta = random_between(&random, 1.1, 3),
                              .roughness = random_between(&random, 0.1, 1)};
            if (i & 1)
                p.eta = 1 / p.eta;
            double error = look_up((enum integrand)kind, &p) - integrate((enum integrand)kind, &p);
            most = fmax(most, error);
            least = fmin(least, error);
            CHECK(error >= -TABLE_BELOW && error <= TABLE_ABOVE,
                  "%s of mu %.4f, alpha %.5f, eta %.3f, roughness %.3f: %.5f off",
                  integrand_names[kind], p.mu, p.alpha, p.eta, p.roughness, error);
        }
        printf("  table of %-10s %+.1e to %+.1e\n", integrand_names[kind], least, most);
    }
}

// Integrates the light that an interface sends to both sides over the normals visible from wo, by
// the midpoint rule, with Fresnel's equations and the masking of the other direction.
static double integrate_glass(const struct point *p, bool is_clear, int steps)
{
    double aspect = sqrt(1 - 0.9 * p->anisotropic), sine = sqrt(1 - p->mu * p->mu);
    const double alpha[2] = {p->alpha / aspect, p->alpha * aspect};
    struct chart chart = {.kind = CHART_NORMALS,
                          .wo = {sine * cos(p->phi), sine * sin(p->phi), p->mu},
                          .alpha = {{alpha[0], alpha[1]}},
                          .lobes = 1,
                          .turn = {1, 0}};
    double sum = 0, circle = p->anisotropic > 0 ? 2 * M_PI : M_PI; // otherwise the other half
                                                                   // mirrors this one
    for (int i = 0; i < steps * steps; i++) {
        double h[3], phi = (i % steps + 0.5) / steps * circle;
        double measure = chart_normal(&chart, (i / steps + 0.5) / steps, phi, h);
        double cosine = optics_dot(chart.wo, h), beyond = optics_cos_refracted(cosine, p->eta);
        double f = beyond == 0 ? 1 : is_clear ? 0 : optics_fresnel(fmin(cosine, 1), p->eta);
        double over[3], under[3];
        for (int c = 0; c < 3; c++) {
            over[c] = 2 * cosine * h[c] - chart.wo[c];
            under[c] = (cosine / p->eta - beyond) * h[c] - chart.wo[c] / p->eta;
        }
        double part = over[2] > 0 ? f * ggx_masking_both(chart.wo, over, alpha, false) /
                                        ggx_masking(chart.wo, alpha)
                                  : 0;
        part += under[2] < 0 ? (1 - f) * ggx_masking(under, alpha) : 0;
        if (cosine > 0)
            sum += part * ggx_visible_density(chart.wo, h, alpha) * measure;
    }
    return sum * 2 * M_PI / steps / steps;
}

// The error is relative, because the light that single scattering leaves is divided by it.
TEST(glass_tables)
{
    enum { POINTS = 60 };
    struct random random = {46};
    for (int is_clear = 0; is_clear < 2; is_clear++) {
        double most = 0, least = 0;
        for (int i = 0; i < POINTS; i++) {
            double distance = pow(10, random_between(&random, -5, 0.4));
            struct point p = {.mu = random_between(&random, 0.1, 1),
                              .alpha = pow(random_between(&random, 0.2, 1), 2),
                              .eta = i & 1 ? 1 / (1 + distance) : 1 + distance};
            double truth = integrate_glass(&p, is_clear, 160);
            double error =
                (is_clear ? table_clear(p.mu, p.alpha, p.eta) : table_glass(p.mu, p.alpha, p.eta)) /
                    truth -
                1;
            most = fmax(most, error);
            least = fmin(least, error);
            CHECK(fabs(error) <= (is_clear ? 0.01 : 0.004),
                  "%s, mu %.4f, alpha %.5f, eta %.6f: %.5f off", is_clear ? "clear" : "glass", p.mu,
                  p.alpha, p.eta, error);
        }
        printf("  table of %s: %+.1e to %+.1e\n", is_clear ? "clear" : "glass", least, most);
    }
}

// Anisotropic interfaces. The table is coarse, so highly anisotropic, very rough interfaces have
// errors of several per cent in some directions.
TEST(turned_glass_table)
{
    enum { POINTS = 200 };
    static const double bounds[2][2] = {{0.01, 0.03}, {0.025, 0.1}},
                        means[2][2] = {{0.001, 0.005}, {0.002, 0.015}};
    double most[2][2] = {{0}}, sum[2][2] = {{0}};
    struct random random = {48};
    for (int i = 0; i < POINTS; i++) {
        double distance = pow(10, random_between(&random, -4, 0.4));
        bool narrow = i & 2, rough = i & 4;
        struct point p = {.mu = random_between(&random, 0.1, 1),
                          .phi = random_between(&random, 0, M_PI / 2),
                          .eta = i & 1 ? 1 / (1 + distance) : 1 + distance,
                          .roughness = random_between(&random, rough ? 0.6 : 0.15, rough ? 1 : 0.6),
                          .anisotropic =
                              random_between(&random, narrow ? 0.6 : 0.01, narrow ? 1 : 0.6)};
        p.alpha = p.roughness * p.roughness;
        double aspect = sqrt(1 - 0.9 * p.anisotropic), sine = sqrt(1 - p.mu * p.mu);
        const double alpha[2] = {p.alpha / aspect, p.alpha * aspect};
        const double wo[3] = {sine * cos(p.phi), sine * sin(p.phi), p.mu};
        double error = table_turned_glass(wo, p.roughness, p.anisotropic, alpha, p.eta, false) /
                           integrate_glass(&p, false, 128) -
                       1;
        most[narrow][rough] = fmax(most[narrow][rough], fabs(error));
        sum[narrow][rough] += error * 4 / POINTS;
        CHECK(fabs(error) <= bounds[narrow][rough],
              "mu %.4f, azimuth %.4f, roughness %.3f, anisotropic %.3f, eta %.6f: %.5f off", p.mu,
              p.phi, p.roughness, p.anisotropic, p.eta, error);
    }
    for (int i = 0; i < 4; i++) {
        CHECK(fabs(sum[i / 2][i % 2]) <= means[i / 2][i % 2], "%.5f off in the mean",
              sum[i / 2][i % 2]);
        printf("  anisotropic %s, roughness %s: %+.1e in the mean, at most %.1e\n",
               i / 2 ? "above 0.6" : "below 0.6", i % 2 ? "above 0.6" : "below 0.6",
               sum[i / 2][i % 2], most[i / 2][i % 2]);
    }
}

// --- closed balls --------------------------------------------------------------------------------

enum { BALL_ANGLES = 24 };

// A ball of white rough glass, and the fraction of light that each hit of its surface keeps.
struct ball {
    double eta, alpha;
    double kept[2][BALL_ANGLES]; // truth over table at mu, from outside and from inside
};

static void make_ball(struct ball *ball, double ior, double roughness)
{
    *ball = (struct ball){.eta = ior, .alpha = roughness * roughness};
    for (int i = 0; i < 2 * BALL_ANGLES; i++) {
        struct point p = {
            .mu = (i / 2 + 0.5) / BALL_ANGLES, .alpha = ball->alpha, .eta = i & 1 ? 1 / ior : ior};
        ball->kept[i & 1][i / 2] =
            integrate_glass(&p, false, 64) / table_glass(p.mu, p.alpha, p.eta);
    }
}

// Simulates one attempt to scatter at the interface, with mu the cosine of wo. It succeeds with the
// probability that light of a visible normal reaches wi. Returns the cosine of wi, negative on the
// other side, or 0 if it fails.
static double try_interface(double mu, double alpha, double eta, struct random *random)
{
    const double alphas[2] = {alpha, alpha}, wo[3] = {sqrt(1 - mu * mu), 0, mu};
    double stretched[3] = {alpha * wo[0], 0, mu}, wi[3], h[3];
    optics_normalize(stretched);
    // Dupuy and Benyoub 2023: reflected about visible normals, a direction is uniformly distributed
    // in a spherical cap.
    double height = 1 - random_unit(random) * (1 + stretched[2]);
    double phi = random_between(random, 0, 2 * M_PI), radius = sqrt(1 - height * height);
    h[0] = alpha * (radius * cos(phi) + stretched[0]);
    h[1] = alpha * radius * sin(phi);
    h[2] = height + stretched[2];
    optics_normalize(h);
    double cosine = optics_dot(wo, h), beyond = optics_cos_refracted(cosine, eta);
    bool reflects = random_unit(random) < optics_fresnel(fmin(cosine, 1), eta);
    for (int c = 0; c < 3; c++)
        wi[c] = reflects ? 2 * cosine * h[c] - wo[c] : (cosine / eta - beyond) * h[c] - wo[c] / eta;
    if (!(cosine > 0) || !(reflects ? wi[2] > 0 : wi[2] < 0))
        return 0;
    double unshadowed = ggx_masking_both(wo, wi, alphas, false) / ggx_masking(wo, alphas);
    return random_unit(random) < unshadowed ? wi[2] : 0;
}

// Returns the contribution of a path from a point of the ball under constant light 1. It scatters
// again and again, with the weight that an exact table would give: no loss. A chord of a ball meets
// the surface at the same cosine at both ends.
static double follow_ball(const struct ball *ball, struct random *random)
{
    double mu = sqrt(1 - random_unit(random)), carried = 1;
    for (bool inside = false;;) {
        carried *= ball->kept[inside][(int)fmin(BALL_ANGLES * mu, BALL_ANGLES - 1)];
        double cosine = 0;
        while (cosine == 0)
            cosine = try_interface(mu, ball->alpha, inside ? 1 / ball->eta : ball->eta, random);
        inside ^= cosine < 0;
        mu = fabs(cosine);
        if (!inside)
            return carried;
    }
}

// Small errors of the table accumulate along paths inside, which have twenty hits or more.
TEST(closed_balls)
{
    static const double iors[] = {1.33, 1.5, 2.42, 4}, roughnesses[] = {0.3, 0.5, 0.7, 1};
    enum { PATHS = 1000 };
    struct random random = {47};
    for (int i = 0; i < 16; i++) {
        struct ball ball;
        make_ball(&ball, iors[i / 4], roughnesses[i % 4]);
        double sum = 0;
        for (int k = 0; k < PATHS; k++)
            sum += follow_ball(&ball, &random) / PATHS;
        double bound = iors[i / 4] > 3 ? 0.02 : 0.01;
        CHECK(fabs(sum - 1) <= bound, "a ball of index %g and roughness %g in light 1: %.4f",
              iors[i / 4], roughnesses[i % 4], sum);
        printf("%s%.4f%s", i % 4 ? " " : "  balls: ", sum, i % 4 == 3 ? "\n" : "");
    }
}

TEST_MAIN(TEST_CASE(ggx_albedo), TEST_CASE(mean_fresnel), TEST_CASE(normals),
          TEST_CASE(albedo_tables), TEST_CASE(glass_tables), TEST_CASE(turned_glass_table),
          TEST_CASE(closed_balls))
