// Tests where renders with an error limit end, with synthetic noise of known error: they may not
// end above the limit more often than promised, nor much later than necessary.
#include "metrics/metrics.h"
#include "random.h"
#include "test.h"

enum { SIDE = 32, PIXELS = SIDE * SIDE };

// Returns a sample with mean 1.
typedef double (*noise_fn)(uint64_t *random);

static double exponential_noise(uint64_t *random)
{
    return -log(random_uniform(random));
}

static double spike_noise(uint64_t *random) // the variance is 49
{
    return random_uniform(random) <= 0.02 ? 50 : 0;
}

static double rare_spike_noise(uint64_t *random) // the variance is 199
{
    return random_uniform(random) <= 0.005 ? 200 : 0;
}

// Returns values of at least .8 with P(x > v) = (.8 / v)^5. The fourth moment is finite, the fifth
// is not.
static double pareto_noise(uint64_t *random)
{
    return 0.8 * pow(random_uniform(random), -0.2);
}

// A grey image with the same true value everywhere, as its samples accumulate.
struct run {
    uint64_t random;
    double sum[2][PIXELS]; // sums of each half
    uint64_t samples;
};

static void run_begin(struct run *run, uint64_t seed)
{
    memset(run, 0, sizeof *run);
    run->random = seed;
}

static void run_to(struct run *run, uint64_t samples, noise_fn noise)
{
    for (; run->samples < samples; run->samples += 2)
        for (int i = 0; i < 2 * PIXELS; i++)
            run->sum[i % 2][i / 2] += noise(&run->random);
}

// Returns the local relMSE of the image; the local mean is 1 everywhere.
static double run_error(const struct run *run)
{
    double sum = 0, weight = 1 / (double)run->samples;
    for (int i = 0; i < PIXELS; i++) {
        double off = (run->sum[0][i] + run->sum[1][i]) * weight - 1;
        sum += off * off;
    }
    return sum / PIXELS / (1 + METRICS_RELMSE_EPSILON);
}

static double run_bound(const struct run *run)
{
    static float halves[2][PIXELS][3];
    for (int h = 0; h < 2; h++)
        for (int i = 0; i < PIXELS; i++)
            for (int c = 0; c < 3; c++)
                halves[h][i][c] = (float)(run->sum[h][i] * 2 / (double)run->samples);
    const struct half_error_params params = {
        .half_a = (const float(*)[3])halves[0],
        .half_b = (const float(*)[3])halves[1],
        .width = SIDE,
        .height = SIDE,
        .samples = run->samples,
        .confidence = LOOKS_CONFIDENCE,
    };
    struct half_error error;
    CHECK(metrics_half_error(&params, &error));
    return error.at_most;
}

static uint32_t run_to_error(struct run *run, double limit, noise_fn noise)
{
    uint32_t looks = 1;
    run_to(run, looks_first(0, 2), noise);
    for (double bound; (bound = run_bound(run)) >= limit; looks++)
        run_to(run, looks_next(run->samples, bound / limit, 2), noise);
    return looks;
}

static int by_value(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

// The limit is the error that each run has after `hindsight` samples, so it could have ended there.
static void check_runs(const char *name, noise_fn noise, uint64_t hindsight, double ratio_most)
{
    enum { RUNS = 200, PROMISED = RUNS / 20 };
    static struct run run;
    double ratios[RUNS], looks = 0;
    int wrong = 0;
    for (int i = 0; i < RUNS; i++) {
        uint64_t seed = UINT64_C(1000003) * ((uint64_t)i + 1);
        run_begin(&run, seed);
        run_to(&run, hindsight, noise);
        double limit = run_error(&run);
        run_begin(&run, seed);
        looks += run_to_error(&run, limit, noise);
        wrong += run_error(&run) > limit;
        ratios[i] = (double)run.samples / (double)hindsight;
    }
    qsort(ratios, RUNS, sizeof *ratios, by_value);
    printf("     %s, %d: %d of %d end too early, at %.2f times the samples in the median, after "
           "%.1f looks\n",
           name, (int)hindsight, wrong, RUNS, ratios[RUNS / 2], looks / RUNS);
    CHECK(wrong <= PROMISED, "%s: %d of %d", name, wrong, RUNS);
    CHECK(ratios[RUNS / 2] <= ratio_most, "%s: %g", name, ratios[RUNS / 2]);
}

TEST(renders_end_below_the_error_and_soon)
{
    check_runs("exponential noise", exponential_noise, 16, 1.3);
    check_runs("exponential noise", exponential_noise, 64, 1.3);
    check_runs("spikes", spike_noise, 64, 1.3);
    // A third of the pixels have a spike. It is not known which of them are light and which are
    // noise.
    check_runs("rare spikes", rare_spike_noise, 64, 1.7);
    check_runs("heavy tails", pareto_noise, 64, 1.3);
}

TEST(looks_are_where_the_bound_may_be_low_enough)
{
    CHECK(looks_first(0, 2) == 2 && looks_first(7, 2) == 8 && looks_first(0, 16) == 16);
    // at most double the samples
    CHECK(looks_next(2, 100, 2) == 4 && looks_next(64, INFINITY, 2) == 128);
    CHECK(looks_next(64, 1.5, 2) == 84);  // 64 x 1.5^(2/3) = 83.9
    CHECK(looks_next(64, 1, 2) == 68);    // at least a sixteenth more
    CHECK(looks_next(2, 1.001, 2) == 4);  // the next even number
    CHECK(looks_next(64, 1.5, 16) == 96); // whole rounds
    CHECK(looks_next(UINT64_C(1) << 40, 1, 2) == (UINT64_C(1) << 40) + (UINT64_C(1) << 36));
}

TEST_MAIN(TEST_CASE(renders_end_below_the_error_and_soon),
          TEST_CASE(looks_are_where_the_bound_may_be_low_enough))
