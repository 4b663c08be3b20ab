// Tests the renderer's samplers on the device with extreme dimensions, sample counts and seeds
// (docs/verification.md, C37 to C39).
#include "check/sampler.h"

#include "check/case_list.h"
#include "check/embedded_scene.h"
#include "check/path_items.h"
#include "render/frame.h"
#include <math.h>
#include <string.h>

#include "check_sampler.spv.h"

// --- kernels -------------------------------------------------------------------------------------

static bool create_kernel(struct renderer *r, const struct sampler_run *run,
                          struct gpu_kernel *kernel, struct err *err)
{
    uint32_t constants[CONSTANT_CHECK_ROUTINE + 1];
    memcpy(constants, &r->specialization, 4 * CONSTANT_COUNT);
    constants[CONSTANT_SAMPLER] = run->sampler;
    constants[CONSTANT_HALVES] = run->halves;
    constants[CONSTANT_FILTER] = run->filter;
    constants[CONSTANT_PIXEL_SAMPLING] = run->pixel_sampling;
    constants[CONSTANT_CHECK_ROUTINE] = run->routine;
    const struct gpu_kernel_params params = {.name = "check_sampler",
                                             .spirv = check_sampler_spirv,
                                             .spirv_bytes = sizeof check_sampler_spirv,
                                             .constants = constants,
                                             .constant_count = CONSTANT_CHECK_ROUTINE + 1};
    return gpu_kernel_create(r->gpu, &params, kernel, err);
}

bool sampler_run(struct renderer *r, const struct sampler_run *run, union draw *draws,
                 uint32_t count, struct err *err)
{
    struct gpu_kernel kernel = {0};
    r->frame.seed = run->seed;
    r->frame.samples = run->samples;
    r->frame.filter_radius = run->filter_radius;
    r->frame.pixel_strata = run->pixel_strata;
    bool ok = create_kernel(r, run, &kernel, err) && frame_upload(r, err) &&
              path_items_run(r, &kernel, draws, count, sizeof *draws, err);
    gpu_kernel_finish(r->gpu, &kernel);
    return ok;
}

// --- statistics ---------------------------------------------------------------------------------

double chi_square_deviate(const uint32_t *counts, const double *expected, uint32_t cells)
{
    double statistic = 0.0;
    for (uint32_t i = 0; i < cells; i++) {
        double difference = counts[i] - expected[i];
        statistic += difference * difference / expected[i];
    }
    double freedom = cells - 1, spread = 2.0 / (9.0 * freedom);
    return (cbrt(statistic / freedom) - (1.0 - spread)) / sqrt(spread);
}

double draws_correlation(const union draw *first, const union draw *second, uint32_t count, int c)
{
    double products = 0.0, squares[2] = {0.0, 0.0};
    for (uint32_t i = 0; i < count; i++) {
        double a = (double)first[i].u[c] - 0.5, b = (double)second[i].u[c] - 0.5;
        products += a * b;
        squares[0] += a * a;
        squares[1] += b * b;
    }
    return products / sqrt(squares[0] * squares[1]);
}

bool draw_is_uniform(float u)
{
    return u >= 0.0f && u < 1.0f && u * 0x1p24f == floorf(u * 0x1p24f);
}

// --- measurements --------------------------------------------------------------------------------

// The samplers that are tested: the default, one with independent random numbers, and one that
// stratifies over a planned number of samples.
static const uint32_t samplers[] = {SAMPLER_SOBOL, SAMPLER_PCG, SAMPLER_STRATIFIED};
enum { SAMPLERS = sizeof samplers / sizeof samplers[0] };

#define PAIRS (1u << 16)
#define DRAWS (2u * PAIRS)

typedef bool (*judge_fn)(struct renderer *r, struct sampler_run *run, union draw *draws,
                         double *worst, struct err *err);

// Counts the results that no uniform number can have (draw_is_uniform()), for extreme dimensions,
// pixels and samples up to 2^32 - 2.
static bool count_outside(struct renderer *r, struct sampler_run *run, union draw *draws,
                          double *worst, struct err *err)
{
    static const uint32_t extremes[] = {0, 1, 2, 1024, 1025, 0x7fffffff, 0x80000000, 0xfffffffe};
    run->seed = 0xffffffff;
    for (uint32_t i = 0; i < 512; i++)
        draws[i] = (union draw){
            .pixel = extremes[i % 8], .sample = extremes[i / 8 % 8], .dimension = extremes[i / 64]};
    if (!sampler_run(r, run, draws, 512, err))
        return false;
    for (uint32_t i = 0; i < 4 * 512; i++)
        *worst += !draw_is_uniform(draws[i / 4].u[i % 4]);
    return true;
}

// Updates *worst with the correlation of two lists, in units of 1 / sqrt(n), if it is greater.
static void keep_correlation(const union draw *a, const union draw *b, double *worst)
{
    for (int c = 0; c < 4; c++)
        *worst = fmax(*worst, fabs(draws_correlation(a, b, PAIRS, c)) * sqrt(PAIRS));
}

// Correlates the numbers of dimension 3 in each pixel with those 1,024 and 2^31 dimensions later.
static bool correlate_dimensions(struct renderer *r, struct sampler_run *run, union draw *draws,
                                 double *worst, struct err *err)
{
    static const uint32_t further[] = {1024, 0x80000000};
    for (uint32_t k = 0; k < 2; k++) {
        for (uint32_t i = 0; i < DRAWS; i++)
            draws[i] = (union draw){.pixel = 2 * (i % PAIRS),
                                    .sample = 5,
                                    .dimension = 3 + (i < PAIRS ? 0 : further[k])};
        if (!sampler_run(r, run, draws, DRAWS, err))
            return false;
        keep_correlation(draws, draws + PAIRS, worst);
    }
    return true;
}

// Correlates the numbers of each seed with those of the previous seed.
static bool correlate_seeds(struct renderer *r, struct sampler_run *run, union draw *draws,
                            double *worst, struct err *err)
{
    static const uint32_t seeds[] = {0, 1, 2, 0x80000000, 0xfffffffe, 0xffffffff};
    for (uint32_t k = 0; k < 6; k++) {
        memcpy(draws + PAIRS, draws, PAIRS * sizeof *draws);
        run->seed = seeds[k];
        for (uint32_t i = 0; i < PAIRS; i++)
            draws[i] = (union draw){.pixel = i, .sample = 5, .dimension = 3};
        if (!sampler_run(r, run, draws, PAIRS, err))
            return false;
        if (k > 0)
            keep_correlation(draws, draws + PAIRS, worst);
    }
    return true;
}

// Counts the first two components in 16 x 16 cells, over all pixels and their first 37 or 3
// samples. Computes the greatest normal deviate of the counts.
static bool count_cells(struct renderer *r, struct sampler_run *run, union draw *draws,
                        double *worst, struct err *err)
{
    enum { CELLS = 256 };
    static const uint32_t planned[] = {3, 37};
    for (uint32_t k = 0; k < 2; k++) {
        uint32_t counts[CELLS] = {0}, samples = planned[k], total = DRAWS / samples * samples;
        double expected[CELLS];
        run->samples = samples;
        for (uint32_t i = 0; i < total; i++)
            draws[i] = (union draw){.pixel = i / samples, .sample = i % samples, .dimension = 7};
        if (!sampler_run(r, run, draws, total, err))
            return false;
        for (uint32_t i = 0; i < total; i++)
            counts[(int)(draws[i].u[0] * 16.0f) * 16 + (int)(draws[i].u[1] * 16.0f)]++;
        for (int i = 0; i < CELLS; i++)
            expected[i] = (double)total / CELLS;
        *worst = fmax(*worst, chi_square_deviate(counts, expected, CELLS));
    }
    return true;
}

// --- the cases ----------------------------------------------------------------------------------

struct sampler_check {
    judge_fn judge;
    double most;
    const char *unit;
};

static bool judge_samplers(const struct sampler_check *s, struct renderer *r, union draw *draws,
                           struct check_result *result, struct err *err)
{
    double worst = -1.0;
    uint32_t of = 0;
    for (uint32_t i = 0; i < SAMPLERS; i++) {
        struct sampler_run run = {.sampler = samplers[i], .samples = 64};
        double found = 0.0;
        if (!s->judge(r, &run, draws, &found, err))
            return false;
        if (!(found <= worst)) {
            worst = found;
            of = samplers[i];
        }
    }
    return check_seen(result, worst <= s->most, "at most %.3g%s, of %s", worst, s->unit,
                      sampler_names[of]);
}

static bool run_samplers(const struct check *check, const struct check_case *this_case,
                         struct check_result *result, struct err *err)
{
    const struct scene_override overrides[] = {{"film.width", "512"}, {"film.height", "512"}, {0}};
    struct arena arena = {0};
    struct scene scene;
    struct renderer renderer = {0};
    union draw *draws = arena_alloc(&arena, DRAWS, sizeof *draws);
    if (!draws)
        return err_memory(err, "draws", DRAWS * sizeof *draws);
    bool ok = embedded_scene_load("sky.json", overrides, &scene, err);
    if (ok) {
        const struct renderer_params params = {
            .gpu = check->gpu, .scene = &scene, .wave = 65536, .progress = check->progress};
        ok = renderer_create(&params, &renderer, err) &&
             judge_samplers(this_case->data, &renderer, draws, result, err);
        renderer_finish(&renderer);
        scene_finish(&scene);
    }
    arena_finish(&arena);
    return ok;
}

#define SAMPLERS_ARE(...)                                                                          \
    .run = run_samplers, .data = &(const struct sampler_check)                                     \
    {                                                                                              \
        __VA_ARGS__                                                                                \
    }

// The limits permit few false alarms: the probability that any of 24 or 60 correlations exceeds 4 /
// sqrt(n) is 0.2 or 0.4 %, and that any of 6 deviates exceeds 4.5 is 2e-5.
static const struct check_case cases[] = {
    {"C37 dimensions up to 2^32", "multiples of 2^-24 in [0, 1)",
     SAMPLERS_ARE(count_outside, 0.0, " that are not")},
    {"C37 1024 and 2^31 dimensions further", "correlations below 4 / sqrt(n)",
     SAMPLERS_ARE(correlate_dimensions, 4.0, " / sqrt(n)")},
    {"C38 3 and 37 samples", "equal counts in 16 x 16 cells, by chi-square within 4.5 deviations",
     SAMPLERS_ARE(count_cells, 4.5, " deviations")},
    {"C39 seeds 0 to 2^32 - 1", "correlations below 4 / sqrt(n)",
     SAMPLERS_ARE(correlate_seeds, 4.0, " / sqrt(n)")},
};

CHECK_GROUP(check_samplers, "samplers", "random numbers of extreme dimensions, counts and seeds",
            cases);
