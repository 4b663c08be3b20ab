// Tests the BSDFs, as rendered and uploaded, over the grid of their parameters: samples against the
// stated densities, and both against the reference in double precision.
#include "bsdf_trial.h"

enum { CAPACITY = 2048 };
static struct configuration grid[CAPACITY];
static struct material materials[CAPACITY];

static void take_materials(uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        grid[i].material.name = grid[i].name;
        materials[i] = grid[i].material;
    }
}

// --- figures -------------------------------------------------------------------------------------

struct figures {
    uint32_t count, ill_conditioned;
    double least_p, closure, weight_error, reference_error, delta_error, albedo;
};

static void gather(struct figures *f, const struct trial *t)
{
    if (f->count++ == 0)
        f->least_p = 1;
    f->least_p = fmin(f->least_p, t->chi_p);
    f->closure = fmax(f->closure, t->closure);
    f->weight_error = fmax(f->weight_error, t->weight_error);
    f->reference_error = fmax(f->reference_error, t->reference_error);
    f->delta_error = fmax(f->delta_error, t->delta_error);
    f->ill_conditioned += t->ill_conditioned;
    for (int c = 0; c < 3; c++)
        f->albedo = fmax(f->albedo, t->albedo[c]);
}

static void print_figures(const struct figures figures[MATERIAL_MODEL_COUNT], double significance)
{
    printf("  %-12s %5s %9s %9s %9s %9s %9s %8s %8s\n", "model", "count", "least p", "|int-1|",
           "weight", "reference", "delta", "albedo", "ill-cond");
    for (uint32_t m = 0; m < MATERIAL_MODEL_COUNT; m++) {
        const struct figures *f = &figures[m];
        if (f->count > 0)
            printf("  %-12s %5u %9.2g %9.1e %9.1e %9.1e %9.1e %8.5f %8u\n", material_model_names[m],
                   f->count, f->least_p, f->closure, f->weight_error, f->reference_error,
                   f->delta_error, f->albedo, f->ill_conditioned);
    }
    printf("  limit of p: %.2g (family error 1 %%)\n", significance);
}

// Selects among the first `count` configurations of the grid.
typedef bool (*choice_fn)(const struct material *material);

static bool is_principled(const struct material *material)
{
    return material->model == MATERIAL_PRINCIPLED;
}

static bool is_other(const struct material *material)
{
    return !is_principled(material);
}

static bool is_any(const struct material *material)
{
    return material != NULL;
}

static bool draws_normals(const struct material *m)
{
    bool has_model = m->model == MATERIAL_PRINCIPLED || m->model == MATERIAL_DIELECTRIC ||
                     m->model == MATERIAL_CONDUCTOR || m->model == MATERIAL_MICROFACET;
    return has_model && m->roughness > 0.005f;
}

static bool refracts(const struct material *m)
{
    return material_has_inside(m) && m->ior != 1.0f;
}

// Moves every nth selected configuration to the front. Returns their number.
static uint32_t keep_some(uint32_t count, choice_fn is_chosen, uint32_t nth)
{
    uint32_t chosen = 0, kept = 0;
    for (uint32_t i = 0; i < count; i++)
        if (is_chosen(&grid[i].material) && chosen++ % nth == 0)
            grid[kept++] = grid[i];
    return kept;
}

static void print_trial(const struct configuration *c, const struct trial *t)
{
    printf("  %s: p %.2g (%u), int %.6f + %.6f + %.6f, closure %.1e +- %.1e, weight %.1e, "
           "reference %.1e (%u ill), albedo %.5f, nodes %u, unresolved %u\n",
           c->name, t->chi_p, t->chi_degrees, t->integral, t->delta_probability, t->absorbed,
           t->closure, t->closure_error, t->weight_error, t->reference_error, t->ill_conditioned,
           t->albedo[0], t->nodes, t->unresolved);
}

// LAMPYRIS_BSDF_ONLY is a part of the names of configurations to run; with LAMPYRIS_BSDF_VERBOSE
// each is printed.
static void run_trials(uint32_t count, choice_fn is_chosen, struct bsdf_choices choices)
{
    static struct bsdf_device device;
    struct trial_params params = {
        .samples = 1 << 18, .replicates = 8, .replicate_samples = 1 << 15, .compared = 20000};
    struct figures figures[MATERIAL_MODEL_COUNT] = {{0}};
    uint32_t chosen = 0;
    const char *only = getenv("LAMPYRIS_BSDF_ONLY");
    for (uint32_t i = 0; i < count; i++)
        chosen += is_chosen(&grid[i].material);
    params.significance = 1 - pow(0.99, 0.5 / chosen); // Sidak 1967, for two tests per
                                                       // configuration
    take_materials(count);
    if (!bsdf_device_open_with(&device, materials, count, choices))
        return;
    for (uint32_t i = 0; i < count; i++) {
        struct trial trial;
        grid[i].choices = choices;
        if (!is_chosen(&grid[i].material) || (only && !strstr(grid[i].name, only)))
            continue;
        if (!trial_run(&device, &grid[i], i, &params, &trial)) {
            CHECK(false, "%s: could not run", grid[i].name);
            break;
        }
        trial_check(&grid[i], &params, &trial);
        gather(&figures[grid[i].material.model], &trial);
        if (getenv("LAMPYRIS_BSDF_VERBOSE"))
            print_trial(&grid[i], &trial);
    }
    printf("  %u configurations\n", chosen);
    print_figures(figures, params.significance);
    bsdf_device_close(&device);
}

// --- tests ---------------------------------------------------------------------------------------

TEST(principled)
{
    run_trials(grid_covering(grid, CAPACITY), is_principled, (struct bsdf_choices){0});
}

TEST(others)
{
    run_trials(grid_covering(grid, CAPACITY), is_other, (struct bsdf_choices){0});
}

// Settings that change the sampling, or the scaling by refraction, are tested on a part of the grid
// where they have an effect.
TEST(drawn_normals)
{
    run_trials(keep_some(grid_covering(grid, CAPACITY), draws_normals, 12), is_any,
               (struct bsdf_choices){.normals = NORMALS_NDF});
}

TEST(unscaled)
{
    run_trials(keep_some(grid_covering(grid, CAPACITY), refracts, 12), is_any,
               (struct bsdf_choices){.unscaled = true});
}

// The mean and the variance of a sample's weight, which is the contribution of a path under
// constant light 1.
struct weights {
    double mean, variance, greatest;
};

static bool weigh(struct bsdf_device *device, uint32_t number, struct weights *out)
{
    enum { SAMPLES = 1 << 16 };
    static union bsdf_item items[SAMPLES];
    struct random random = {43};
    double sum = 0, squares = 0;
    for (uint32_t k = 0; k < SAMPLES; k++) {
        items[k] = (union bsdf_item){.in = {.material = number + 1, .eta = grid[number].eta}};
        memcpy(items[k].in.wo, grid[number].wo, sizeof items[k].in.wo);
        for (int c = 0; c < 4; c++)
            items[k].in.u[c] = (float)(random_u32(&random) >> 8) * 0x1p-24f;
    }
    if (!bsdf_run(device, BSDF_ROUTINE_SAMPLE, BSDF_LOBES_CLASS, &grid[number].material, items,
                  SAMPLES))
        return false;
    *out = (struct weights){0};
    for (uint32_t k = 0; k < SAMPLES; k++) {
        double weight = items[k].sample.flags & BSDF_VALID ? (double)items[k].sample.weight[0] : 0;
        sum += weight;
        squares += weight * weight;
        out->greatest = fmax(out->greatest, weight);
    }
    out->mean = sum / SAMPLES;
    out->variance = (squares - sum * out->mean) / (SAMPLES - 1);
    return true;
}

static uint32_t white_microfacets(void)
{
    static const float roughnesses[] = {0.1f, 0.3f, 0.5f, 0.7f, 1}, cosines[] = {1, 0.5f, 0.1f};
    uint32_t count = 0;
    for (int i = 0; i < 15; i++) {
        struct configuration *c = &grid[count++];
        *c = (struct configuration){.eta = 1.5f};
        material_init(&c->material);
        c->material.model = MATERIAL_MICROFACET;
        c->material.roughness = roughnesses[i % 5];
        for (int k = 0; k < 3; k++) {
            c->material.base_color[k] = 0;
            c->material.specular_color[k] = 1;
        }
        c->wo[0] = sqrtf(1 - cosines[i / 5] * cosines[i / 5]);
        c->wo[2] = cosines[i / 5];
    }
    return count;
}

// Both ways of sampling normals have the same mean. Sampling visible normals has less variance and
// weights of at most 1. Prints the table of docs/materials.md.
TEST(normals_variance)
{
    static struct bsdf_device device;
    static struct weights weights[2][16];
    uint32_t count = white_microfacets();
    take_materials(count);
    for (uint32_t normals = NORMALS_VISIBLE; normals <= NORMALS_NDF; normals++) {
        if (!bsdf_device_open_with(&device, materials, count,
                                   (struct bsdf_choices){.normals = normals}))
            return;
        for (uint32_t i = 0; i < count; i++)
            if (!weigh(&device, i, &weights[normals][i]))
                return;
        bsdf_device_close(&device);
    }
    for (uint32_t i = 0; i < count; i++) {
        const struct weights *v = &weights[NORMALS_VISIBLE][i], *d = &weights[NORMALS_NDF][i];
        double roughness = (double)grid[i].material.roughness, cosine = (double)grid[i].wo[2];
        printf("  roughness %.1f, cosine %.1f: mean %.4f, %.4f; variance %.2g, %.2g; greatest "
               "%.3g, %.3g\n",
               roughness, cosine, v->mean, d->mean, v->variance, d->variance, v->greatest,
               d->greatest);
        double error = sqrt((v->variance + d->variance) / (1 << 16));
        CHECK(fabs(v->mean - d->mean) <= 4.5 * error, "means %.5f and %.5f, +- %.5f", v->mean,
              d->mean, error);
        // From above all normals are visible, so both ways are the same.
        CHECK(cosine < 1 ? v->variance < d->variance : fabs(v->variance / d->variance - 1) <= 1e-3,
              "%.3g and %.3g", v->variance, d->variance);
        CHECK(v->greatest <= 1.00001, "a weight of %.6f", v->greatest);
    }
}

TEST(choices_long)
{
    run_trials(keep_some(grid_covering(grid, CAPACITY), draws_normals, 1), is_any,
               (struct bsdf_choices){.normals = NORMALS_NDF, .unscaled = true});
}

TEST(random)
{
    run_trials(grid_random(grid, 2000, 2026), is_any, (struct bsdf_choices){0});
}

// The cases are named, because otherwise the long one would run, too.
TEST_MAIN(TEST_CASE(principled), TEST_CASE(others), TEST_CASE(drawn_normals), TEST_CASE(unscaled),
          TEST_CASE(normals_variance), TEST_CASE(choices_long), TEST_CASE(random))
