// Tests properties of the renderer's BSDFs other than their distributions: the same bits for any
// set of compiled lobes, extreme uniforms, reciprocity, and conservation of energy.
#include "bsdf_means.h"

enum { CAPACITY = 512 };
static struct configuration grid[CAPACITY];
static struct material materials[CAPACITY];

static bool open_grid(struct bsdf_device *device, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        grid[i].material.name = grid[i].name;
        materials[i] = grid[i].material;
    }
    return bsdf_device_open(device, materials, count);
}

static union bsdf_item item_of(uint32_t number)
{
    const struct configuration *c = &grid[number];
    union bsdf_item item = {.in = {.material = number + 1, .eta = c->eta}};
    memcpy(item.in.wo, c->wo, sizeof item.in.wo);
    return item;
}

// --- the whole grid ------------------------------------------------------------------------------

// Draws a sample and, from its output, evaluates its direction.
TEST(same_bits)
{
    enum { SAMPLES = 2000 };
    static union bsdf_item items[BSDF_LOBES_CHOICES][SAMPLES];
    static struct bsdf_device device;
    struct random random = {41};
    uint32_t count = grid_covering(grid, CAPACITY), differing = 0;
    if (!open_grid(&device, count))
        return;
    for (uint32_t i = 0; i < count; i++) {
        for (uint32_t k = 0; k < SAMPLES; k++) {
            items[0][k] = item_of(i);
            for (int c = 0; c < 4; c++)
                items[0][k].in.u[c] = (float)(random_u32(&random) >> 8) * 0x1p-24f;
        }
        memcpy(items[1], items[0], sizeof items[0]);
        for (int lobes = 0; lobes < BSDF_LOBES_CHOICES; lobes++)
            if (!bsdf_run(&device, BSDF_ROUTINE_SAMPLE, lobes, &grid[i].material, items[lobes],
                          SAMPLES))
                return;
        uint32_t here = 0;
        for (uint32_t k = 0; k < SAMPLES; k++)
            here += memcmp(&items[0][k], &items[1][k], sizeof items[0][k]) != 0;
        // Only lavapipe is known to compile the same expression to the same operations.
        CHECK(here == 0 || !device.setup.gpu.info.is_cpu, "%s: %u of %d samples differ",
              grid[i].name, here, SAMPLES);
        differing += here;
    }
    printf("  %u configurations, %u samples differ\n", count, differing);
    bsdf_device_close(&device);
}

TEST(extreme_uniforms)
{
    static const float extremes[] = {0, 0x1p-32f, 1 - 0x1p-24f};
    enum { SAMPLES = 81 };
    union bsdf_item items[SAMPLES];
    static struct bsdf_device device;
    uint32_t count = grid_covering(grid, CAPACITY), accepted = 0;
    if (!open_grid(&device, count))
        return;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t bad = 0;
        for (uint32_t k = 0; k < SAMPLES; k++) {
            items[k] = item_of(i);
            for (uint32_t c = 0, rest = k; c < 4; c++, rest /= 3)
                items[k].in.u[c] = extremes[rest % 3];
        }
        if (!bsdf_run(&device, BSDF_ROUTINE_SAMPLE, BSDF_LOBES_CLASS, &grid[i].material, items,
                      SAMPLES))
            return;
        for (uint32_t k = 0; k < SAMPLES; k++) {
            const union bsdf_item *s = &items[k];
            bool finite = isfinite(s->sample.pdf);
            for (int c = 0; c < 3; c++)
                finite = finite && isfinite(s->sample.wi[c]) && isfinite(s->sample.weight[c]) &&
                         isfinite(s->sample.eval[c]) && s->sample.weight[c] >= 0;
            bool valid = s->sample.flags & BSDF_VALID, delta = s->sample.flags & BSDF_SPECULAR;
            bad += !finite || (valid && !delta && !(s->sample.pdf > 0));
            accepted += valid;
        }
        CHECK(bad == 0, "%s: %u of %d", grid[i].name, bad, SAMPLES);
    }
    printf("  %u configurations, %u samples accepted\n", count, accepted);
    bsdf_device_close(&device);
}

// --- reciprocity ---------------------------------------------------------------------------------
// Not reciprocal, by docs/materials.md and docs/materials-classical.md: what lies below a layer
// that takes its albedo at wo alone (S under fibres, C under the coat, K the diffuse part under the
// interface, B the diffuse part under Burley's sheen), and energy compensation. Each lobe without
// them is, and is tested here.

static struct configuration *add(uint32_t *count, const char *name, uint32_t model)
{
    struct configuration *c = &grid[(*count)++];
    *c = (struct configuration){.eta = 1.5f, .wo = {0, 0, 1}};
    material_init(&c->material);
    c->material.model = model;
    c->material.flags = 0;
    snprintf(c->name, sizeof c->name, "%s", name);
    return c;
}

static void set(float color[3], float r, float g, float b)
{
    color[0] = r;
    color[1] = g;
    color[2] = b;
}

// A black material without an interface, to which a single lobe is added.
static struct configuration *add_bare(uint32_t *count, const char *name)
{
    struct configuration *c = add(count, name, MATERIAL_PRINCIPLED);
    set(c->material.base_color, 0, 0, 0);
    c->material.specular_weight = 0;
    return c;
}

static uint32_t reciprocal_materials(void)
{
    static const float roughnesses[] = {0.01f, 0.1f, 0.3f, 1};
    uint32_t count = 0;
    add(&count, "diffuse", MATERIAL_LAMBERT);
    for (int i = 0; i < 4; i++) {
        float r = roughnesses[i];
        struct configuration *c = add(&count, "metal, anisotropic", MATERIAL_PRINCIPLED);
        c->material.metallic = 1;
        c->material.roughness = r;
        c->material.anisotropic = 0.7f;
        c->material.anisotropic_rotation = 0.2f;
        c = add(&count, "glass", MATERIAL_PRINCIPLED);
        c->material.transmission = 1;
        c->material.roughness = r;
        c = add(&count, "glass, from inside", MATERIAL_PRINCIPLED);
        c->material.transmission = 1;
        c->material.roughness = r;
        c->eta = 1 / 1.5f;
        c = add(&count, "thin sheet, separable", MATERIAL_PRINCIPLED);
        c->material.transmission = 1;
        c->material.roughness = r;
        c->material.flags = MATERIAL_THIN | MATERIAL_SEPARABLE;
        c = add(&count, "dielectric", MATERIAL_DIELECTRIC);
        c->material.roughness = r;
        c->eta = 1.33f;
        c = add(&count, "thin dielectric", MATERIAL_DIELECTRIC);
        c->material.roughness = r;
        c->material.flags = MATERIAL_THIN;
        c = add(&count, "conductor", MATERIAL_CONDUCTOR);
        c->material.roughness = r;
        c = add_bare(&count, "coat, GGX");
        c->material.clearcoat = 1;
        c->material.flags = MATERIAL_COAT_GGX;
        c->material.clearcoat_roughness = r;
        c = add_bare(&count, "coat, GTR1");
        c->material.clearcoat = 1;
        c->material.clearcoat_gloss = 1 - r;
        c = add_bare(&count, "coat, exact Fresnel");
        c->material.clearcoat = 1;
        c->material.flags = MATERIAL_EXACT_COAT | (i % 2 ? MATERIAL_COAT_GGX : 0);
        c->material.clearcoat_roughness = r;
        c->material.clearcoat_gloss = 1 - r;
        c = add(&count, "mixed Fresnel, black below", MATERIAL_PRINCIPLED);
        set(c->material.base_color, 0, 0, 0);
        set(c->material.specular_color, 0.9f, 0.5f, 0.1f);
        c->material.roughness = r;
        c->material.metallic = 0.5f;
        c->material.flags = MATERIAL_MIXED_FRESNEL;
        c = add_bare(&count, "fibres");
        set(c->material.sheen_color, 0.9f, 0.5f, 0.1f);
        c->material.sheen_roughness = r;
        c = add_bare(&count, "diffuse of the principled model");
        set(c->material.base_color, 0.9f, 0.5f, 0.1f);
        c->material.roughness = r;
        c->material.subsurface = 0.5f;
        for (uint32_t kind = 0; kind < DISTRIBUTION_COUNT * MASKING_COUNT; kind++) {
            c = add(&count, "microfacet", MATERIAL_MICROFACET);
            c->material.roughness = r;
            c->material.flags = kind % DISTRIBUTION_COUNT << MATERIAL_DISTRIBUTION_SHIFT |
                                kind / DISTRIBUTION_COUNT << MATERIAL_MASKING_SHIFT;
        }
        c = add(&count, "microfacet over an uncoupled base", MATERIAL_MICROFACET);
        c->material.roughness = r;
        c->material.flags = MATERIAL_UNCOUPLED;
        c = add(&count, "phong", MATERIAL_PHONG);
        c->material.exponent = 10 / (r * r);
        set(c->material.specular_color, 0.4f, 0.4f, 0.4f);
        c = add(&count, "blinn_phong", MATERIAL_BLINN_PHONG);
        c->material.exponent = 10 / (r * r);
        set(c->material.specular_color, 0.4f, 0.4f, 0.4f);
    }
    struct configuration *c = add_bare(&count, "sheen");
    c->material.sheen = 1;
    return count;
}

// Makes both directions of a pair, with uniform cosines. In half of the pairs the second is the
// first one's reflection, within the roughness, so that highlights are tested.
static void make_pair(struct random *random, const struct configuration *c, bool through,
                      float a[3], float b[3])
{
    double z = random_between(random, 0.01, 1), phi = random_between(random, 0, 2 * M_PI);
    double sine = sqrt(1 - z * z), spread = (double)c->material.roughness;
    double v[3] = {sine * cos(phi), sine * sin(phi), z}, w[3] = {-v[0], -v[1], v[2]};
    if (random_unit(random) < 0.5)
        spread = 1;
    for (int i = 0; i < 3; i++)
        w[i] += spread * spread * random_between(random, -1, 1);
    w[2] = fmax(fabs(w[2]), 0.01);
    double norm = vec3_norm(w);
    if (through && !(c->material.flags & MATERIAL_THIN)) {
        // The direction is refracted as by a smooth surface, then spread in the same way.
        for (int i = 0; i < 2; i++)
            w[i] =
                norm * (-v[i] / (double)c->eta + spread * spread * random_between(random, -1, 1));
        double rest = 1 - (w[0] * w[0] + w[1] * w[1]) / (norm * norm);
        w[2] = norm * sqrt(fmax(rest, 1e-4));
        norm = vec3_norm(w);
    }
    for (int i = 0; i < 3; i++) {
        a[i] = (float)v[i];
        b[i] = (float)(w[i] / norm) * (i == 2 && through ? -1.0f : 1.0f);
    }
}

enum { PAIRS = 10000 };

// Fills the second half of `items` with wi and wo exchanged, seen from the other side if wi is
// there.
static void turn_around(const struct configuration *c, bool through, union bsdf_item *items)
{
    for (uint32_t k = 0; k < PAIRS; k++) {
        const union bsdf_item *from = &items[k];
        union bsdf_item *to = &items[PAIRS + k];
        float sign = through ? -1.0f : 1.0f;
        *to = *from;
        for (int i = 0; i < 3; i++) {
            to->in.wo[i] = from->in.wi[i] * (i == 2 ? sign : 1.0f);
            to->in.wi[i] = from->in.wo[i] * (i == 2 ? sign : 1.0f);
        }
        if (through && !(c->material.flags & MATERIAL_THIN))
            to->in.eta = 1 / from->in.eta;
    }
}

// Returns by which fraction rounding alone may change f: directions and products have errors of
// 2^-24. These change the slope of a half-vector by that over the length of wo + eta wi, in a lobe
// as wide as alpha; and they change the cosine beyond a microfacet, which is the root of a
// difference, by that over its square.
static double rounding_of(const struct configuration *c, const union bsdf_item *item)
{
    double alpha = (double)c->material.roughness * (double)c->material.roughness;
    double eta = (double)item->in.eta, wo[3], wi[3], h[3];
    for (int i = 0; i < 3; i++) {
        wo[i] = (double)item->in.wo[i];
        wi[i] = (double)item->in.wi[i];
        h[i] = wo[i] + eta * wi[i];
    }
    double norm = vec3_norm(h), cosine = fmin(fabs(vec3_dot(wo, h)), fabs(vec3_dot(wi, h))) / norm;
    return 8 * 0x1p-24 * (1 / (alpha * norm) + 1 / (cosine * cosine));
}

static double check_pairs(struct bsdf_device *device, uint32_t number, bool through,
                          struct random *random)
{
    static union bsdf_item items[2 * PAIRS], outputs[2 * PAIRS];
    const struct configuration *c = &grid[number];
    for (uint32_t k = 0; k < PAIRS; k++) {
        items[k] = item_of(number);
        make_pair(random, c, through, items[k].in.wo, items[k].in.wi);
    }
    turn_around(c, through, items);
    memcpy(outputs, items, sizeof items);
    if (!bsdf_run(device, BSDF_ROUTINE_EVAL, BSDF_LOBES_CLASS, &c->material, outputs, 2 * PAIRS))
        return NAN;
    double worst = 0, largest = 0;
    for (uint32_t k = 0; k < PAIRS; k++) {
        double cos_i = fabs((double)items[k].in.wi[2]), cos_o = (double)items[k].in.wo[2];
        // After rounding, the way back has a slightly different index, so the product is not
        // exactly 1.
        double scale = through && !(c->material.flags & MATERIAL_THIN)
                           ? (double)items[k].in.eta / (double)items[PAIRS + k].in.eta
                           : 1;
        for (int i = 0; i < 3; i++) {
            double there = (double)outputs[k].eval.f[i] / cos_i * scale;
            double back = (double)outputs[PAIRS + k].eval.f[i] / cos_o;
            double rounding = scale == 1 ? 0 : rounding_of(c, &items[k]) * fmax(there, back);
            double error = fabs(there - back) - 1e-7 - rounding;
            worst = fmax(worst, error / fmax(fabs(there), 1e-7));
            largest = fmax(largest, there);
        }
    }
    CHECK(largest > 0 || through, "%s: black", c->name);
    return worst;
}

TEST(reciprocity)
{
    static struct bsdf_device device;
    struct random random = {42};
    uint32_t count = reciprocal_materials();
    double worst = 0;
    if (!open_grid(&device, count))
        return;
    for (uint32_t i = 0; i < count; i++)
        for (int through = 0; through < 2; through++) {
            double error = check_pairs(&device, i, through, &random);
            CHECK(error <= 1e-4, "%s, roughness %g, eta %g%s: %.3g", grid[i].name,
                  (double)grid[i].material.roughness, (double)grid[i].eta,
                  through ? ", through" : "", error);
            worst = fmax(worst, error);
        }
    printf("  %u materials, %d pairs each: worst %.2g\n", count, 2 * PAIRS, worst);
    bsdf_device_close(&device);
}

// --- energy --------------------------------------------------------------------------------------

static void look_from(struct configuration *c, double degrees)
{
    double angle = degrees * M_PI / 180;
    c->angle = degrees;
    c->wo[0] = (float)(sin(angle) * cos(1.0));
    c->wo[1] = (float)(sin(angle) * sin(1.0));
    c->wo[2] = (float)cos(angle);
}

// White metals reflect all light if multiple scattering is compensated.
TEST(compensated)
{
    static const float roughnesses[] = {0.1f, 0.3f, 0.5f, 0.7f, 1}, anisotropies[] = {0, 0.5f, 1};
    static const double angles[] = {0, 30, 60, 80, 89};
    static struct bsdf_device device;
    uint32_t count = 0;
    double worst = 0;
    for (int i = 0; i < 5 * 5 * 4; i++) {
        bool conductor = i % 4 == 3;
        struct configuration *c = add(&count, conductor ? "conductor" : "metal",
                                      conductor ? MATERIAL_CONDUCTOR : MATERIAL_PRINCIPLED);
        c->material.flags = MATERIAL_COMPENSATE;
        c->material.metallic = 1;
        set(c->material.base_color, 1, 1, 1);
        set(c->material.conductor_eta, 1e-3f, 1e-3f, 1e-3f);
        set(c->material.conductor_k, 100, 100, 100);
        c->material.anisotropic = conductor ? 0 : anisotropies[i % 4];
        c->material.roughness = roughnesses[i / 4 % 5];
        look_from(c, angles[i / 20]);
    }
    if (!open_grid(&device, count))
        return;
    for (uint32_t i = 0; i < count; i++) {
        struct bsdf_means means;
        if (!bsdf_measure(&device, &grid[i], i, 4, 1 << 14, &means))
            return;
        double error = fabs(means.albedo[0] - 1);
        worst = fmax(worst, error);
        // The table of anisotropic albedos is too coarse at its corner.
        double bound = grid[i].material.anisotropic < 1 ? 0.01 : 0.015;
        CHECK(error <= bound, "%s, roughness %g, anisotropic %g, %g degrees: albedo %.5f +- %.5f",
              grid[i].name, (double)grid[i].material.roughness,
              (double)grid[i].material.anisotropic, grid[i].angle, means.albedo[0],
              means.albedo_error[0]);
    }
    printf("  %u white metals: |E - 1| at most %.2g\n", count, worst);
    bsdf_device_close(&device);
}

// White rough glass loses no light, seen from both sides, however similar the indices are. Neither
// does glass whose reflection is scaled or tinted.
static struct configuration *add_glass(uint32_t *count, uint32_t model, float roughness, float eta,
                                       double degrees)
{
    struct configuration *c = add(count, "glass", model);
    c->material.flags = MATERIAL_COMPENSATE;
    c->material.transmission = 1;
    set(c->material.base_color, 1, 1, 1);
    c->material.roughness = roughness;
    c->eta = eta;
    look_from(c, degrees);
    return c;
}

static uint32_t white_glasses(void)
{
    static const float roughnesses[] = {0.1f, 0.3f, 0.5f, 0.7f, 1};
    static const float indices[] = {1.0001f, 1.01f, 1.1f, 1.33f, 1.5f, 2.42f, 4};
    static const double angles[] = {0, 30, 60, 80};
    uint32_t count = 0;
    for (int i = 0; i < 5 * 7 * 2 * 4; i++) {
        float eta = i & 1 ? 1 / indices[i / 2 % 7] : indices[i / 2 % 7];
        uint32_t model = i % 3 == 0 ? MATERIAL_PRINCIPLED : MATERIAL_DIELECTRIC;
        add_glass(&count, model, roughnesses[i / 14 % 5], eta, angles[i / 70]);
    }
    for (int i = 0; i < 5 * 4 * 4; i++) {
        float roughness = roughnesses[i / 4 % 5];
        double degrees = angles[i / 20];
        struct configuration *c =
            add_glass(&count, MATERIAL_PRINCIPLED, roughness, i & 1 ? 1 / 1.5f : 1.5f, degrees);
        c->material.specular_weight = i & 2 ? 0 : 0.5f;
        set(c->material.specular_color, 1, 0.5f, 8);
    }
    for (int i = 0; i < 5 * 2; i++) {
        struct configuration *c =
            add_glass(&count, i & 1 ? MATERIAL_PRINCIPLED : MATERIAL_DIELECTRIC, roughnesses[i / 2],
                      1.5f, 60);
        c->material.flags |= MATERIAL_THIN;
    }
    return count;
}

TEST(compensated_glass)
{
    static struct bsdf_device device;
    uint32_t count = white_glasses();
    double worst = 0, least = 1, most = 1;
    if (!open_grid(&device, count))
        return;
    for (uint32_t i = 0; i < count; i++) {
        struct bsdf_means means;
        if (!bsdf_measure(&device, &grid[i], i, 4, 1 << 13, &means))
            return;
        // Tables have larger errors if the reflection differs from Fresnel's equations.
        double bound = grid[i].material.specular_weight < 1 ? 0.004 : 0.002;
        for (int c = 0; c < 3; c++) {
            double error = fabs(means.albedo[c] - 1) - 3 * means.albedo_error[c];
            CHECK(error <= bound, "%s, roughness %g, eta %g, %g degrees: albedo %.5f +- %.5f",
                  grid[i].name, (double)grid[i].material.roughness, (double)grid[i].eta,
                  grid[i].angle, means.albedo[c], means.albedo_error[c]);
            worst = fmax(worst, error);
            least = fmin(least, means.albedo[c]);
            most = fmax(most, means.albedo[c]);
        }
        if (getenv("LAMPYRIS_BSDF_VERBOSE"))
            printf("  %s roughness %g eta %g at %g: %.4f\n", grid[i].name,
                   (double)grid[i].material.roughness, (double)grid[i].eta, grid[i].angle,
                   means.albedo[0]);
    }
    printf("  %u white rough glasses: albedo %.4f to %.4f, beyond 3 sigma off by %.2g\n", count,
           least, most, worst);
    bsdf_device_close(&device);
}

// Glass that is anisotropic, that has a film, or both, loses no light either.
static uint32_t special_glasses(void)
{
    static const float roughnesses[] = {0.3f, 0.5f, 0.7f, 1};
    static const float anisotropies[] = {0, 0.3f, 0.9f, 0.3f, 0.9f};
    static const float indices[] = {1.5f, 1 / 1.5f, 4, 1 / 4.0f};
    static const double angles[] = {0, 30, 60, 80};
    uint32_t count = 0;
    for (int i = 0; i < 4 * 4 * 4 * 5; i++) {
        int kind = i / 64;
        struct configuration *c = add_glass(&count, MATERIAL_PRINCIPLED, roughnesses[i % 4],
                                            indices[i / 4 % 4], angles[i / 16 % 4]);
        c->material.anisotropic = anisotropies[kind];
        c->material.anisotropic_rotation = 0.06f * (float)(i % 7);
        c->material.iridescence = kind == 1 || kind == 2 ? 0 : 1;
        c->material.film_ior = 1.3f + 0.1f * (float)(i % 5);
        c->material.film_thickness = 150 + 70 * (float)(i % 11);
        c->material.ior = c->eta < 1 ? 1 / c->eta : c->eta;
    }
    return count;
}

// By construction the mean of the channels of these samples is white. A film gives the channels
// different albedos, which are known only approximately, and less accurately if it reflects more.
TEST(compensated_special_glass)
{
    static struct bsdf_device device;
    uint32_t count = special_glasses();
    double least = 1, most = 1, worst = 0;
    if (!open_grid(&device, count))
        return;
    for (uint32_t i = 0; i < count; i++) {
        const struct material *m = &grid[i].material;
        struct bsdf_means means;
        if (!bsdf_measure(&device, &grid[i], i, 4, 1 << 13, &means))
            return;
        double bound = m->iridescence == 0 ? 1e-3 : grid[i].eta < 3 ? 0.01 : 0.025, mean = 0;
        for (int c = 0; c < 3; c++) {
            CHECK(fabs(means.albedo[c] - 1) <= bound + 3 * means.albedo_error[c],
                  "roughness %g, anisotropic %g, film %g, eta %g, %g degrees: albedo %.5f +- %.5f",
                  (double)m->roughness, (double)m->anisotropic, (double)m->iridescence,
                  (double)grid[i].eta, grid[i].angle, means.albedo[c], means.albedo_error[c]);
            least = fmin(least, means.albedo[c]);
            most = fmax(most, means.albedo[c]);
            mean += means.albedo[c] / 3;
        }
        worst = fmax(worst, fabs(mean - 1));
        CHECK(fabs(mean - 1) <= 2e-3, "%g in the mean", mean);
    }
    printf("  %u anisotropic or filmed glasses: albedo %.4f to %.4f, in the mean 1 +- %.2g\n",
           count, least, most, worst);
    bsdf_device_close(&device);
}

// As the index approaches 1 from either side, rough glass approaches its limit: no interface,
// through which all light goes straight on.
TEST(matched_glass)
{
    static const float distances[] = {1e-3f, 1e-4f, 1e-5f, 0};
    enum { SAMPLES = 1 << 14 };
    static union bsdf_item items[SAMPLES];
    static struct bsdf_device device;
    struct random random = {45};
    uint32_t count = 0;
    for (int i = 0; i < 4 * 2 * 2 * 2; i++) {
        float eta = i & 1 ? 1 / (1 + distances[i / 8]) : 1 + distances[i / 8];
        add_glass(&count, i & 2 ? MATERIAL_PRINCIPLED : MATERIAL_DIELECTRIC, 0.7f, eta,
                  i & 4 ? 60 : 30);
    }
    if (!open_grid(&device, count))
        return;
    for (uint32_t i = 0; i < count; i++) {
        for (uint32_t k = 0; k < SAMPLES; k++) {
            items[k] = item_of(i);
            for (int c = 0; c < 4; c++)
                items[k].in.u[c] = (float)(random_u32(&random) >> 8) * 0x1p-24f;
        }
        if (!bsdf_run(&device, BSDF_ROUTINE_SAMPLE, BSDF_LOBES_CLASS, &grid[i].material, items,
                      SAMPLES))
            return;
        double moment[3] = {0}, distance = (double)distances[i / 8];
        for (uint32_t k = 0; k < SAMPLES; k++)
            for (int c = 0; c < 3 && items[k].sample.flags & BSDF_VALID; c++)
                moment[c] += (double)items[k].sample.weight[0] * (double)items[k].sample.wi[c];
        double worst = 0;
        for (int c = 0; c < 3; c++)
            worst = fmax(worst, fabs(moment[c] / SAMPLES + (double)grid[i].wo[c]));
        CHECK(worst <= 0.003 + 4 * distance, "eta %g, %g degrees: light comes from %.4f beside",
              (double)grid[i].eta, grid[i].angle, worst);
    }
    bsdf_device_close(&device);
}

// Smooth glass splits light without loss: a sample carries all of it, whichever way it goes.
TEST(smooth_glass)
{
    static const float indices[] = {1, 1.0001f, 1.33f, 1.5f, 2.42f, 4};
    static const double angles[] = {0, 30, 60, 80, 89, 89.9, 89.99};
    enum { SAMPLES = 1024 };
    static union bsdf_item items[SAMPLES];
    static struct bsdf_device device;
    struct random random = {43};
    uint32_t count = 0, through = 0;
    double worst = 0;
    for (int i = 0; i < 6 * 7 * 8; i++) {
        struct configuration *c = i & 1 ? add(&count, "glass", MATERIAL_PRINCIPLED)
                                        : add(&count, "dielectric", MATERIAL_DIELECTRIC);
        c->material.flags = i & 2 ? MATERIAL_THIN : 0u;
        c->material.roughness = 0;
        c->material.transmission = 1;
        set(c->material.base_color, 1, 1, 1);
        c->eta = i & 4 ? 1 / indices[i / 8 % 6] : indices[i / 8 % 6];
        look_from(c, angles[i / 48]);
    }
    if (!open_grid(&device, count))
        return;
    for (uint32_t i = 0; i < count; i++) {
        for (uint32_t k = 0; k < SAMPLES; k++) {
            items[k] = item_of(i);
            for (int c = 0; c < 4; c++)
                items[k].in.u[c] = (float)(random_u32(&random) >> 8) * 0x1p-24f;
        }
        if (!bsdf_run(&device, BSDF_ROUTINE_SAMPLE, BSDF_LOBES_CLASS, &grid[i].material, items,
                      SAMPLES))
            return;
        double here = 0, eta = (double)grid[i].eta;
        for (uint32_t k = 0; k < SAMPLES; k++) {
            bool transmitted = items[k].sample.flags & BSDF_TRANSMITTED;
            bool bends = transmitted && !(grid[i].material.flags & MATERIAL_THIN);
            bool good = items[k].sample.flags & BSDF_VALID && items[k].sample.flags & BSDF_SPECULAR;
            double energy = (double)items[k].sample.weight[0] * (bends ? eta * eta : 1);
            here = fmax(here, good ? fabs(energy - 1) : INFINITY);
            through += transmitted;
        }
        CHECK(here <= 1e-6, "%s, flags %x, eta %g, %g degrees: %.3g", grid[i].name,
              grid[i].material.flags, eta, grid[i].angle, here);
        worst = fmax(worst, here);
    }
    CHECK(through > 0, "nothing went through");
    printf("  %u panes and balls: |R + T - 1| at most %.2g\n", count, worst);
    bsdf_device_close(&device);
}

TEST_MAIN(TEST_CASE(same_bits), TEST_CASE(extreme_uniforms), TEST_CASE(reciprocity),
          TEST_CASE(compensated), TEST_CASE(compensated_glass),
          TEST_CASE(compensated_special_glass), TEST_CASE(matched_glass), TEST_CASE(smooth_glass))
