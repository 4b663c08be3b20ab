// Tests the BSDFs alone (docs/verification.md, A). It runs the renderer's own routines for wide,
// reciprocal lobes.
#include "check/bsdf.h"

#include "check/case_list.h"
#include "check/driver.h"
#include "check/embedded_scene.h"
#include "check/path_items.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "check_bsdf.spv.h"

#define ITEMS (1u << 16) // items per material
#define ETA 1.5f // index of refraction; the medium outside has no effect on opaque materials

_Static_assert(sizeof(union bsdf_item) == sizeof(struct gpu_path), "they share a buffer");

// --- kernels -------------------------------------------------------------------------------------

static bool create_kernel(struct renderer *r, uint32_t material, uint32_t routine,
                          struct gpu_kernel *kernel, struct err *err)
{
    uint32_t constants[CONSTANT_CHECK_ROUTINE + 1];
    memcpy(constants, &r->specialization, 4 * CONSTANT_COUNT);
    // The kernel writes to buffers that it also reads.
    constants[CONSTANT_FEATURES] &= ~FEATURE_TEXEL_STATE;
    constants[CONSTANT_LOBES] =
        r->specialization.class_lobes[material_class(&r->scene->materials[material])];
    constants[CONSTANT_CHECK_ROUTINE] = routine;
    const struct gpu_kernel_params params = {.name = "check_bsdf",
                                             .spirv = check_bsdf_spirv,
                                             .spirv_bytes = sizeof check_bsdf_spirv,
                                             .constants = constants,
                                             .constant_count = CONSTANT_CHECK_ROUTINE + 1};
    return gpu_kernel_create(r->gpu, &params, kernel, err);
}

// Replaces ITEMS items, all of one material, by the output of a routine.
static bool run_items(struct renderer *r, uint32_t material, uint32_t routine,
                      union bsdf_item *items, struct err *err)
{
    struct gpu_kernel kernel = {0};
    bool ok = create_kernel(r, material, routine, &kernel, err) &&
              path_items_run(r, &kernel, items, ITEMS, sizeof *items, err);
    gpu_kernel_finish(r->gpu, &kernel);
    return ok;
}

// --- directions --------------------------------------------------------------------------------

static double unit(uint64_t *state)
{
    return driver_random(state) * 0x1p-32;
}

static void set_direction(double z, double turns, float out[3])
{
    double radius = sqrt(1.0 - z * z);
    out[0] = (float)(radius * cos(2.0 * M_PI * turns));
    out[1] = (float)(radius * sin(2.0 * M_PI * turns));
    out[2] = (float)z;
}

// Generates a direction at most 84 degrees from the normal, where the rounding of directions has no
// effect.
static void random_direction(uint64_t *state, float out[3])
{
    double z = 0.1 + 0.9 * unit(state);
    set_direction(z, unit(state), out);
}

static void fill_samples(uint64_t *state, uint32_t material, const float wo[3],
                         union bsdf_item *items)
{
    for (uint32_t i = 0; i < ITEMS; i++) {
        items[i] = (union bsdf_item){.in = {.material = material, .eta = ETA}};
        if (wo)
            memcpy(items[i].in.wo, wo, sizeof items[i].in.wo);
        else
            random_direction(state, items[i].in.wo);
        for (int k = 0; k < 4; k++)
            items[i].in.u[k] = (float)(driver_random(state) >> 8) * 0x1p-24f;
    }
}

// --- measurements --------------------------------------------------------------------------------

// Measures the greatest deviation of one material from a property that its BSDF must have.
typedef bool (*measure_fn)(struct renderer *r, uint32_t material, union bsdf_item *items,
                           double *off, struct err *err);

// Compares f(wo, wi) with f(wi, wo). The items are in pairs.
static bool measure_reciprocity(struct renderer *r, uint32_t material, union bsdf_item *items,
                                double *off, struct err *err)
{
    static float cosines[ITEMS];
    uint64_t state = material;
    for (uint32_t i = 0; i < ITEMS; i += 2) {
        float a[3], b[3];
        random_direction(&state, a);
        random_direction(&state, b);
        for (uint32_t k = 0; k < 2; k++) {
            items[i + k] = (union bsdf_item){.in = {.material = material, .eta = ETA}};
            memcpy(items[i + k].in.wo, k ? b : a, sizeof a);
            memcpy(items[i + k].in.wi, k ? a : b, sizeof a);
            cosines[i + k] = items[i + k].in.wi[2];
        }
    }
    if (!run_items(r, material, BSDF_ROUTINE_EVAL, items, err))
        return false;
    for (uint32_t i = 0; i < ITEMS; i += 2)
        for (int c = 0; c < 3; c++) {
            double f = (double)items[i].eval.f[c] / (double)cosines[i];
            double g = (double)items[i + 1].eval.f[c] / (double)cosines[i + 1];
            *off = fmax(*off, (fabs(f - g) - 1e-7) / fmax(fabs(f), 1e-7));
        }
    return true;
}

// Compares the weight of a sampled direction with f cos / pdf, evaluated for that direction, and
// compares the two pdfs. If wo is NULL, it is random.
static bool measure_samples_from(const float *wo, struct renderer *r, uint32_t material,
                                 union bsdf_item *items, double *off, struct err *err)
{
    uint64_t state = material;
    fill_samples(&state, material, wo, items);
    if (!run_items(r, material, BSDF_ROUTINE_SAMPLE, items, err))
        return false;
    *off = INFINITY; // the result if no direction could be sampled
    for (uint32_t i = 0; i < ITEMS; i++) {
        if (!(items[i].sample.flags & BSDF_VALID))
            continue;
        *off = isinf(*off) ? 0.0 : *off;
        double pdf = (double)items[i].sample.pdf;
        *off = fmax(*off, fabs((double)items[i].sample.eval_pdf / pdf - 1.0));
        for (int c = 0; c < 3; c++) {
            double weight = (double)items[i].sample.weight[c];
            *off = fmax(*off, (fabs((double)items[i].sample.eval[c] / pdf - weight) - 1e-7) /
                                  fmax(weight, 1e-7));
        }
    }
    return true;
}

static bool measure_samples(struct renderer *r, uint32_t material, union bsdf_item *items,
                            double *off, struct err *err)
{
    return measure_samples_from(NULL, r, material, items, off, err);
}

static const float looking[3] = {0.6f, 0.0f, 0.8f};

// Integrates the pdf over all directions by the midpoint rule, with 256 x 256 cells of equal solid
// angle, and adds the fraction of samples that were absorbed. The deviation is the difference of
// this sum from 1.
static bool measure_density(struct renderer *r, uint32_t material, union bsdf_item *items,
                            double *off, struct err *err)
{
    enum { SIDE = 256 };
    uint64_t state = material;
    double sum = 0.0;
    for (uint32_t i = 0; i < ITEMS; i++) {
        items[i] = (union bsdf_item){.in = {.material = material, .eta = ETA}};
        memcpy(items[i].in.wo, looking, sizeof looking);
        set_direction(2.0 * (i / SIDE + 0.5) / SIDE - 1.0, (i % SIDE + 0.5) / SIDE, items[i].in.wi);
    }
    if (!run_items(r, material, BSDF_ROUTINE_EVAL, items, err))
        return false;
    for (uint32_t i = 0; i < ITEMS; i++)
        sum += (double)items[i].eval.pdf * 4.0 * M_PI / ITEMS;
    fill_samples(&state, material, looking, items);
    if (!run_items(r, material, BSDF_ROUTINE_SAMPLE, items, err))
        return false;
    for (uint32_t i = 0; i < ITEMS; i++)
        sum += items[i].sample.flags & BSDF_VALID ? 0.0 : 1.0 / ITEMS;
    *off = fabs(sum - 1.0);
    return true;
}

// Measures by how much the reflected light exceeds the incident light, which has radiance 1 from
// all directions. The material must reflect some light.
static bool measure_energy_from(const float wo[3], struct renderer *r, uint32_t material,
                                union bsdf_item *items, double *off, struct err *err)
{
    uint64_t state = material;
    double sums[3] = {0};
    fill_samples(&state, material, wo, items);
    if (!run_items(r, material, BSDF_ROUTINE_SAMPLE, items, err))
        return false;
    for (uint32_t i = 0; i < ITEMS; i++)
        for (int c = 0; c < 3 && items[i].sample.flags & BSDF_VALID; c++)
            sums[c] += (double)items[i].sample.weight[c] / ITEMS;
    double most = fmax(sums[0], fmax(sums[1], sums[2]));
    *off = fmax(*off, most > 0.0 ? fmax(0.0, most - 1.0) : INFINITY);
    return true;
}

static bool measure_energy(struct renderer *r, uint32_t material, union bsdf_item *items,
                           double *off, struct err *err)
{
    return measure_energy_from(looking, r, material, items, off, err);
}

// Measures the excess energy from directions 89.9 and 89.99 degrees from the normal.
static bool measure_grazing_energy(struct renderer *r, uint32_t material, union bsdf_item *items,
                                   double *off, struct err *err)
{
    static const double degrees[] = {0.1, 0.01}; // angles above the surface
    bool ok = true;
    for (int i = 0; ok && i < 2; i++) {
        float wo[3];
        set_direction(sin(degrees[i] * M_PI / 180.0), 0.125, wo);
        ok = measure_energy_from(wo, r, material, items, off, err);
    }
    return ok;
}

// Does what measure_samples() does, for a direction 89.99 degrees from the normal.
static bool measure_grazing_samples(struct renderer *r, uint32_t material, union bsdf_item *items,
                                    double *off, struct err *err)
{
    float wo[3];
    set_direction(sin(0.01 * M_PI / 180.0), 0.125, wo);
    return measure_samples_from(wo, r, material, items, off, err);
}

// --- the cases ---------------------------------------------------------------------------------

struct bsdf_check {
    measure_fn measure;
    double most;
};

static bool measure_all(const struct bsdf_check *b, struct renderer *r, union bsdf_item *items,
                        struct check_result *result, struct err *err)
{
    double worst = -1.0;
    const char *name = "";
    for (uint32_t m = 0; m < r->scene->material_count; m++) {
        double off = 0.0;
        if (!b->measure(r, m, items, &off, err))
            return false;
        if (!(off <= worst)) {
            worst = off;
            name = r->scene->materials[m].name;
        }
    }
    return check_seen(result, worst <= b->most, "at most %.1e, for %s", worst, name);
}

static bool run_bsdf(const struct check *check, const struct check_case *this_case,
                     struct check_result *result, struct err *err)
{
    struct arena arena = {0};
    struct scene scene;
    struct renderer renderer = {0};
    union bsdf_item *items = ARENA_NEW(&arena, union bsdf_item, ITEMS);
    if (!items)
        return err_memory(err, "directions", ITEMS * sizeof *items);
    bool ok = embedded_scene_load("bsdf.json", NULL, &scene, err);
    if (ok) {
        const struct renderer_params params = {.gpu = check->gpu, .scene = &scene, .wave = ITEMS};
        ok = renderer_create(&params, &renderer, err) &&
             measure_all(this_case->data, &renderer, items, result, err);
        renderer_finish(&renderer);
        scene_finish(&scene);
    }
    arena_finish(&arena);
    return ok;
}

#define BSDF(...)                                                                                  \
    .run = run_bsdf, .data = &(const struct bsdf_check)                                            \
    {                                                                                              \
        __VA_ARGS__                                                                                \
    }

static const struct check_case cases[] = {
    {"A2 densities", "the pdf and the absorbed fraction integrate to 1, within 4e-3",
     BSDF(measure_density, 4e-3)},
    {"A3 samples beside values", "weight = f cos / pdf, within 1e-4", BSDF(measure_samples, 1e-4)},
    {"A4 reciprocity", "f(wo, wi) = f(wi, wo), within 1e-4", BSDF(measure_reciprocity, 1e-4)},
    {"A9 white furnace", "at most all of the incident light, within 4e-3",
     BSDF(measure_energy, 4e-3)},
    {"C19 white furnace, seen at 89.9 and 89.99 degrees",
     "at most all of the incident light, within 4e-3", BSDF(measure_grazing_energy, 4e-3)},
    {"C19 samples, seen at 89.99 degrees", "weight = f cos / pdf, within 1e-2",
     BSDF(measure_grazing_samples, 1e-2)},
};

CHECK_GROUP(check_bsdf, "bsdf", "the BSDFs alone, for five materials", cases);
