// The BSDFs, as shipped and as uploaded, over the grid of their parameters: what is drawn against
// what is said to be drawn, and both against the reference in double precision.
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

// Of the grid's first `count` configurations those that are chosen.
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

static void print_trial(const struct configuration *c, const struct trial *t)
{
    printf("  %s: p %.2g (%u), int %.6f + %.6f + %.6f, closure %.1e +- %.1e, weight %.1e, "
           "reference %.1e (%u ill), albedo %.5f, nodes %u, unresolved %u\n",
           c->name, t->chi_p, t->chi_degrees, t->integral, t->delta_probability, t->absorbed,
           t->closure, t->closure_error, t->weight_error, t->reference_error, t->ill_conditioned,
           t->albedo[0], t->nodes, t->unresolved);
}

// LAMPYRIS_BSDF_ONLY: a part of the names of those to run; LAMPYRIS_BSDF_VERBOSE: print each.
static void run_trials(uint32_t count, choice_fn is_chosen)
{
    static struct bsdf_device device;
    struct trial_params params = {
        .samples = 1 << 18, .replicates = 8, .replicate_samples = 1 << 15, .compared = 20000};
    struct figures figures[MATERIAL_MODEL_COUNT] = {{0}};
    uint32_t chosen = 0;
    const char *only = getenv("LAMPYRIS_BSDF_ONLY");
    for (uint32_t i = 0; i < count; i++)
        chosen += is_chosen(&grid[i].material);
    params.significance = 1 - pow(0.99, 0.5 / chosen); // Sidak 1967; two tests for each
    take_materials(count);
    if (!bsdf_device_open(&device, materials, count))
        return;
    for (uint32_t i = 0; i < count; i++) {
        struct trial trial;
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
    run_trials(grid_covering(grid, CAPACITY), is_principled);
}

TEST(others)
{
    run_trials(grid_covering(grid, CAPACITY), is_other);
}

TEST(random)
{
    run_trials(grid_random(grid, 2000, 2026), is_any);
}

// All of them by name: without one, the long one would run too.
TEST_MAIN(TEST_CASE(principled), TEST_CASE(others), TEST_CASE(random))
