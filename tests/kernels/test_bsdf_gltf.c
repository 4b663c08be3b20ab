// Tests materials of glTF files against the specification: appendix B of glTF 2.0 ("BRDF
// Implementation") and KHR_materials_specular, KHR_materials_ior, KHR_materials_clearcoat and
// KHR_materials_sheen are written in double precision from their formulas, and compared with the
// renderer's BSDFs. Where docs/gltf.md documents a difference, the reference here has it, too, and
// its size is bounded.
#include "bsdf_means.h"
#include "bsdf_optics.h"

enum { CAPACITY = 512 };
static struct configuration grid[CAPACITY];
static struct material materials[CAPACITY];
static struct bsdf_device device;

static bool open_grid(uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        grid[i].material.name = grid[i].name;
        materials[i] = grid[i].material;
    }
    return bsdf_device_open(&device, materials, count);
}

// Adds the material that the loader makes from {"pbrMetallicRoughness": …} without extensions.
static struct configuration *add(uint32_t *count, double metallic, double roughness, double degrees)
{
    struct configuration *c = &grid[(*count)++];
    *c = (struct configuration){.angle = degrees, .eta = 1.5f};
    struct material *m = &c->material;
    material_init(m);
    m->model = MATERIAL_PRINCIPLED;
    m->flags |= MATERIAL_GLTF_LAYERS | MATERIAL_TINT_EACH;
    m->metallic = (float)metallic;
    m->roughness = (float)roughness;
    static const float base[3] = {0.9f, 0.5f, 0.1f};
    memcpy(m->base_color, base, sizeof base);
    c->wo[0] = (float)sin(degrees * M_PI / 180);
    c->wo[2] = (float)cos(degrees * M_PI / 180);
    snprintf(c->name, sizeof c->name, "metallic %g, roughness %g, %g degrees", metallic, roughness,
             degrees);
    return c;
}

static void make_white(struct material *m)
{
    for (int c = 0; c < 3; c++)
        m->base_color[c] = 1;
}

// --- the specification ---------------------------------------------------------------------------

// Appendix B, "Specular BRDF": D times the visibility of the height-correlated Smith function.
static double specular_brdf(double alpha, const double l[3], const double v[3], const double h[3])
{
    double a2 = alpha * alpha, n_h = h[2] * h[2] * (a2 - 1) + 1;
    double d = a2 / (M_PI * n_h * n_h);
    double visibility =
        0.5 / (v[2] * sqrt(a2 + (1 - a2) * l[2] * l[2]) + l[2] * sqrt(a2 + (1 - a2) * v[2] * v[2]));
    return visibility * d;
}

static double max_value(const double f[3])
{
    return fmax(f[0], fmax(f[1], f[2]));
}

// "Fresnel" with KHR_materials_ior and KHR_materials_specular: Schlick's curve from f0 to f90 or,
// as the appendix recommends for accuracy, the full equations, shifted to begin at f0.
static void dielectric_fresnel(const struct material *m, double v_h, bool exact, double out[3])
{
    double ior = (double)m->ior, index = (1 - ior) / (1 + ior) * ((1 - ior) / (1 + ior));
    for (int c = 0; c < 3; c++) {
        double f0 = fmin(index * (double)m->specular_color[c], 1), f = optics_schlick(f0, v_h);
        double full = optics_fresnel(fmin(v_h, 1), ior);
        if (exact)
            f = fmin(1, fmax(0, full + (f0 - index) * (1 - full) / (1 - index)));
        out[c] = (double)m->specular_weight * f;
    }
}

// material = mix(dielectric_brdf, metal_brdf, metallic), times N.L. fresnel_mix weights the base
// not by the reflectance of the microfacet halfway but by the albedo of the layer as a whole, after
// Kulla and Conty, whom the appendix cites for this.
static void appendix_b(const struct material *m, const double v[3], const double l[3],
                       const double *albedo, bool exact, double out[3])
{
    double h[3], v_h = optics_half_reflected(v, l, h), fresnel[3];
    double alpha = (double)m->roughness * (double)m->roughness, metallic = (double)m->metallic;
    double specular = specular_brdf(alpha, l, v, h);
    dielectric_fresnel(m, v_h, exact, fresnel);
    double weight = 1 - max_value(albedo);
    for (int c = 0; c < 3; c++) {
        double base = (double)m->base_color[c];
        double dielectric = fresnel[c] * specular + weight * base / M_PI;
        double metal = optics_schlick(base, v_h) * specular;
        out[c] = ((1 - metallic) * dielectric + metallic * metal) * l[2];
    }
}

// Returns the directional albedo of the dielectric's specular layer, by the midpoint rule over
// visible normals.
static void layer_albedo(const struct material *m, const double v[3], bool exact, double out[3])
{
    enum { STEPS = 160 };
    double alpha = (double)m->roughness * (double)m->roughness;
    struct chart chart = {.kind = CHART_NORMALS,
                          .wo = {v[0], v[1], v[2]},
                          .alpha = {{alpha, alpha}},
                          .lobes = 1,
                          .turn = {1, 0}};
    out[0] = out[1] = out[2] = 0;
    for (int i = 0; i < STEPS * STEPS; i++) {
        double h[3], l[3], f[3], phi = (i % STEPS + 0.5) / STEPS * M_PI;
        double measure = chart_normal(&chart, (i / STEPS + 0.5) / STEPS, phi, h);
        double v_h = optics_dot(v, h);
        for (int c = 0; c < 3; c++)
            l[c] = 2 * v_h * h[c] - v[c];
        if (!(v_h > 0) || !(l[2] > 0))
            continue;
        dielectric_fresnel(m, v_h, exact, f);
        // dl = 4 v.h dh
        double part = specular_brdf(alpha, l, v, h) * l[2] * 4 * v_h * measure;
        for (int c = 0; c < 3; c++)
            out[c] += f[c] * part * 2 * M_PI / STEPS / STEPS;
    }
}

// --- the shipped BSDFs against it ----------------------------------------------------------------

enum { DIRECTIONS = 400 };

static void fill_directions(uint32_t number, union bsdf_item *items)
{
    struct random random = {number + 7};
    for (uint32_t k = 0; k < DIRECTIONS; k++) {
        double z = random_between(&random, 0.02, 1), phi = random_between(&random, 0, 2 * M_PI);
        items[k] = (union bsdf_item){.in = {.material = number + 1, .eta = grid[number].eta}};
        memcpy(items[k].in.wo, grid[number].wo, sizeof items[k].in.wo);
        items[k].in.wi[0] = (float)(sqrt(1 - z * z) * cos(phi));
        items[k].in.wi[1] = (float)(sqrt(1 - z * z) * sin(phi));
        items[k].in.wi[2] = (float)z;
    }
}

// Returns the greatest relative difference between the renderer's BSDF and the reference.
static double compare(uint32_t number, const double *albedo, bool exact)
{
    static union bsdf_item items[DIRECTIONS], outputs[DIRECTIONS];
    const struct material *m = &grid[number].material;
    double v[3], worst = 0;
    fill_directions(number, items);
    memcpy(outputs, items, sizeof items);
    if (!bsdf_run(&device, BSDF_ROUTINE_EVAL, BSDF_LOBES_CLASS, m, outputs, DIRECTIONS))
        return NAN;
    chart_unit(grid[number].wo, v);
    for (uint32_t k = 0; k < DIRECTIONS; k++) {
        double l[3], f[3];
        chart_unit(items[k].in.wi, l);
        appendix_b(m, v, l, albedo, exact, f);
        for (int c = 0; c < 3; c++)
            worst = fmax(worst, fabs((double)outputs[k].eval.f[c] - f[c]) / (f[c] + 1e-4));
    }
    return worst;
}

// Metals without multiple scattering agree with the appendix exactly.
TEST(metals)
{
    static const double roughnesses[] = {0.15, 0.3, 0.6, 1}, angles[] = {0, 30, 60, 75, 85};
    uint32_t count = 0;
    double worst = 0;
    for (int i = 0; i < 20; i++)
        add(&count, 1, roughnesses[i % 4], angles[i / 4])->material.flags &= ~MATERIAL_COMPENSATE;
    if (!open_grid(count))
        return;
    for (uint32_t i = 0; i < count; i++) {
        double error = compare(i, (double[3]){0}, false);
        CHECK(error <= 1e-3, "%s: %.3g from appendix B", grid[i].name, error);
        worst = fmax(worst, error);
    }
    printf("  %u metals: within %.1e\n", count, worst);
    bsdf_device_close(&device);
}

// All other materials: Lambert's base, a single weight for all of its channels, the full Fresnel
// equations, and the base weighted by the layer's albedo.
TEST(dielectrics)
{
    static const double roughnesses[] = {0.15, 0.3, 0.6, 1}, angles[] = {0, 30, 60, 75, 85};
    static const double mixes[] = {0, 0.5}, speculars[] = {1, 0.5, 0};
    static const float iors[] = {1.5f, 1.33f, 2}, colors[2][3] = {{1, 1, 1}, {1, 0.4f, 3}};
    uint32_t count = 0;
    double worst = 0;
    for (int i = 0; i < 4 * 5 * 2 * 3; i++) {
        struct configuration *c =
            add(&count, mixes[i / 20 % 2], roughnesses[i % 4], angles[i / 4 % 5]);
        c->material.flags &= ~MATERIAL_COMPENSATE;
        c->material.specular_weight = (float)speculars[i / 40];
        c->material.ior = c->eta = iors[i % 3];
        memcpy(c->material.specular_color, colors[i / 2 % 2], sizeof colors[0]);
    }
    if (!open_grid(count))
        return;
    for (uint32_t i = 0; i < count; i++) {
        double v[3], albedo[3];
        chart_unit(grid[i].wo, v);
        layer_albedo(&grid[i].material, v, true, albedo);
        double error = compare(i, albedo, true);
        // Tables of albedos exceed the truth by up to .004.
        CHECK(error <= 0.006, "%s, specular %g: %.3g from appendix B", grid[i].name,
              (double)grid[i].material.specular_weight, error);
        worst = fmax(worst, error);
    }
    printf("  %u mixtures: within %.1e\n", count, worst);
    bsdf_device_close(&device);
}

// A white base without reflection is white at every angle and roughness, whether it is shaded as
// Lambertian or by the principled model. (Burley's is .971 at 0 degrees and .667 at 85, for
// roughness 0.)
TEST(lambert)
{
    static const double roughnesses[] = {0, 0.5, 1}, angles[] = {0, 45, 75, 85};
    uint32_t count = 0;
    for (int i = 0; i < 3 * 4 * 2; i++) {
        struct configuration *c = add(&count, 0, roughnesses[i % 3], angles[i / 3 % 4]);
        make_white(&c->material);
        c->material.specular_weight = i < 12 ? 0 : 1e-6f;
        uint32_t class = material_class(&c->material);
        CHECK(class == (i < 12 ? CLASS_DIFFUSE : CLASS_PRINCIPLED), "class %u", class);
    }
    if (!open_grid(count))
        return;
    for (uint32_t i = 0; i < count; i++) {
        double error = compare(i, (double[3]){0}, true);
        struct bsdf_means means;
        if (!bsdf_measure(&device, &grid[i], i, 2, 1 << 10, &means))
            return;
        CHECK(error <= 1e-3, "%s: %.3g from Lambert's", grid[i].name, error);
        CHECK(fabs(means.albedo[0] - 1) <= 1e-4, "%s: albedo %.5f", grid[i].name, means.albedo[0]);
    }
    bsdf_device_close(&device);
}

// The albedo of white dielectrics is 1 here. That of the sample implementation, which the appendix
// says "breaks energy conservation", is the same from above and exceeds 1 at grazing angles.
TEST(albedo)
{
    static const double roughnesses[] = {0.25, 0.5, 1}, angles[] = {0, 30, 60, 75, 85};
    uint32_t count = 0;
    for (int i = 0; i < 15; i++)
        make_white(&add(&count, 0, roughnesses[i / 5], angles[i % 5])->material);
    if (!open_grid(count))
        return;
    printf("  %-40s %8s %8s\n", "white dielectric", "shipped", "sample");
    for (uint32_t i = 0; i < count; i++) {
        struct bsdf_means means;
        double v[3], layer[3], base = 0, h[3], f[3];
        enum { STEPS = 128 };
        if (!bsdf_measure(&device, &grid[i], i, 4, 1 << 13, &means))
            return;
        chart_unit(grid[i].wo, v);
        layer_albedo(&grid[i].material, v, false, layer);
        for (int k = 0; k < STEPS * STEPS; k++) {
            double z = sqrt((k / STEPS + 0.5) / STEPS), phi = (k % STEPS + 0.5) / STEPS * M_PI;
            const double l[3] = {sqrt(1 - z * z) * cos(phi), sqrt(1 - z * z) * sin(phi), z};
            dielectric_fresnel(&grid[i].material, optics_half_reflected(v, l, h), false, f);
            base += (1 - f[0]) / STEPS / STEPS;
        }
        printf("  %-40s %8.4f %8.4f\n", grid[i].name, means.albedo[0], layer[0] + base);
        CHECK(fabs(means.albedo[0] - 1) <= 0.006, "%s: albedo %.4f", grid[i].name, means.albedo[0]);
        CHECK(grid[i].angle > 30 || fabs(means.albedo[0] - layer[0] - base) <= 0.035,
              "%s: %.4f instead of %.4f", grid[i].name, means.albedo[0], layer[0] + base);
    }
    bsdf_device_close(&device);
}

// KHR_materials_sheen: "clearcoat is layered on top of sheen", so that its highlight is not dimmed.
// KHR_materials_specular: coloured reflection does not change the colour of the base.
TEST(layers)
{
    static union bsdf_item items[2];
    uint32_t count = 0;
    for (int i = 0; i < 2; i++) {
        struct material *m = &add(&count, 0, 1, 60)->material;
        m->flags |= MATERIAL_COAT_GGX;
        m->clearcoat = 1;
        m->clearcoat_roughness = 0.3f;
        m->sheen_roughness = 0.5f;
        m->sheen_color[0] = i == 0 ? 0.9f : 0.0f;
    }
    struct configuration *red = add(&count, 0, 1, 60);
    red->material.specular_color[0] = 10;
    make_white(&red->material);
    if (!open_grid(count))
        return;
    for (uint32_t i = 0; i < 2; i++) {
        items[i] = (union bsdf_item){.in = {.material = i + 1, .eta = 1.5f}};
        memcpy(items[i].in.wo, grid[i].wo, sizeof grid[i].wo);
        items[i].in.wi[0] = -grid[i].wo[0];
        items[i].in.wi[2] = grid[i].wo[2];
    }
    // In the highlight all other light is small.
    for (uint32_t i = 0; i < 2; i++)
        if (!bsdf_run(&device, BSDF_ROUTINE_EVAL, BSDF_LOBES_CLASS, &grid[i].material, &items[i],
                      1))
            return;
    double with = (double)items[0].eval.f[0], without = (double)items[1].eval.f[0];
    CHECK(with / without > 0.95, "the coat over fibres: %.4f, without them %.4f", with, without);

    // Far from the highlight the base is the same in all channels.
    union bsdf_item item = {.in = {.material = 3, .eta = 1.5f}};
    memcpy(item.in.wo, red->wo, sizeof red->wo);
    item.in.wi[0] = 0.6f;
    item.in.wi[2] = 0.8f;
    double v[3], albedo[3], f[3];
    const double l[3] = {0.6, 0, 0.8};
    chart_unit(red->wo, v);
    layer_albedo(&red->material, v, true, albedo);
    appendix_b(&red->material, v, l, albedo, true, f);
    if (!bsdf_run(&device, BSDF_ROUTINE_EVAL, BSDF_LOBES_CLASS, &red->material, &item, 1))
        return;
    for (int c = 0; c < 3; c++)
        CHECK(fabs((double)item.eval.f[c] - f[c]) <= 0.01 * f[c],
              "channel %d: %.5f instead of %.5f", c, (double)item.eval.f[c], f[c]);
    bsdf_device_close(&device);
}

TEST_MAIN(TEST_CASE(metals), TEST_CASE(dielectrics), TEST_CASE(lambert), TEST_CASE(albedo),
          TEST_CASE(layers))
