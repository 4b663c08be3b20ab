// Tests the renderer's samplers (lib/sampler.glsl) on the device: ranges, strata and elementary
// intervals exactly; uniformity, scrambling and independence by statistics.
#include "metrics/metrics.h"
#include "sampler_fixture.h"

enum { SOBOL_DIMENSIONS = 4 };

static union draw draws[SAMPLER_ITEMS];

static bool draw_all(struct sampler_setup *s, uint32_t count)
{
    return sampler_uniforms(s, draws, count);
}

// --- all samplers --------------------------------------------------------------------------------

static const uint32_t extremes[] = {0, 1, 2, 1024, 1025, 0x7fffffff, 0x80000000, 0xfffffffe};
enum { EXTREMES = sizeof extremes / sizeof *extremes };

static void fill_extremes(void)
{
    struct random random = {41};
    for (uint32_t i = 0; i < SAMPLER_ITEMS; i++) {
        bool any = i >= EXTREMES * EXTREMES * EXTREMES;
        draws[i] = (union draw){
            .pixel = any ? random_u32(&random) : extremes[i % EXTREMES],
            .sample = any ? random_u32(&random) : extremes[i / EXTREMES % EXTREMES],
            .dimension = any ? random_u32(&random) : extremes[i / EXTREMES / EXTREMES % EXTREMES],
        };
    }
}

// All numbers are multiples of 2^-24 in [0, 1), for any pixel, sample, dimension number (beyond
// those of any path), seed and planned number.
TEST(in_range)
{
    static const uint32_t plans[] = {0, 1, 2, 37, 1u << 24, 0xffffffff};
    static struct sampler_setup s;
    OPEN_SAMPLER(&s, 1000, 3);
    for (s.sampler = 0; sampler_names[s.sampler]; s.sampler++) {
        uint32_t bad = 0;
        for (int plan = 0; plan < 6; plan++) {
            s.samples = plans[plan];
            s.seed = plan % 2 ? 0xffffffff : 0;
            s.halves = s.samples && plan % 3 ? HALVES_CONTIGUOUS : HALVES_INDEPENDENT;
            fill_extremes();
            if (!draw_all(&s, SAMPLER_ITEMS))
                break;
            for (uint32_t i = 0; i < SAMPLER_ITEMS; i++)
                for (int c = 0; c < 4; c++)
                    bad += !draw_is_uniform(draws[i].u[c]);
        }
        CHECK(bad == 0, "%s: %u", sampler_names[s.sampler], bad);
    }
    sampler_close(&s);
}

// Computes chi-square of 16 x 16 cells and of every component's 256 strata, over all pixels and the
// first samples: the deviates of three pairs and four components.
static bool find_deviates(struct sampler_setup *s, uint32_t samples, double deviates[7])
{
    enum { CELLS = 256 };
    static const int pairs[3][2] = {{0, 1}, {1, 2}, {2, 3}};
    uint32_t counts[3][CELLS] = {0}, lines[4][CELLS] = {0};
    uint32_t total = SAMPLER_ITEMS / samples * samples;
    double expected[CELLS];
    for (uint32_t i = 0; i < total; i++)
        draws[i] = (union draw){.pixel = i / samples, .sample = i % samples, .dimension = 7};
    if (!draw_all(s, total))
        return false;
    for (uint32_t i = 0; i < total; i++) {
        const float *u = draws[i].u;
        for (int p = 0; p < 3; p++)
            counts[p][(int)(u[pairs[p][0]] * 16) * 16 + (int)(u[pairs[p][1]] * 16)]++;
        for (int c = 0; c < 4; c++)
            lines[c][(int)(u[c] * CELLS)]++;
    }
    for (int i = 0; i < CELLS; i++)
        expected[i] = (double)total / CELLS;
    for (int i = 0; i < 7; i++)
        deviates[i] = chi_square_deviate(i < 3 ? counts[i] : lines[i - 3], expected, CELLS);
    return true;
}

// With a number of samples that is neither a power of two nor a square, samplers are still
// unbiased. The probability of an error is 1e-4 for all together.
#define DEVIATE_MAX 4.5

static void check_unbiased(struct sampler_setup *s, uint32_t samples)
{
    double deviates[7];
    bool found = find_deviates(s, samples, deviates);
    for (int i = 0; i < 7 && found; i++)
        CHECK(deviates[i] <= DEVIATE_MAX, "%s, %u samples, %s %d: %.2f deviations",
              sampler_names[s->sampler], samples, i < 3 ? "pair" : "component", i < 3 ? i : i - 3,
              deviates[i]);
}

TEST(unbiased)
{
    static const uint32_t counts[] = {1, 3, 7, 37};
    static struct sampler_setup s;
    OPEN_SAMPLER(&s, 512, 512);
    for (s.sampler = 0; sampler_names[s.sampler]; s.sampler++) {
        if (s.sampler == SAMPLER_GRID) // its points are at fixed places
            continue;
        for (int i = 0; i < 4; i++) {
            s.samples = s.sampler == SAMPLER_SOBOL ? 64 : counts[i];
            check_unbiased(&s, counts[i]);
        }
    }
    sampler_close(&s);
}

// Returns the greatest of four chi-square deviates of the second eight digits of every component,
// over pixels.
static double digits_deviate(struct sampler_setup *s)
{
    enum { CELLS = 256 };
    uint32_t counts[4][CELLS] = {0};
    double expected[CELLS], worst = 0;
    for (uint32_t i = 0; i < SAMPLER_ITEMS; i++)
        draws[i] = (union draw){.pixel = i, .sample = 5, .dimension = 7};
    if (!draw_all(s, SAMPLER_ITEMS))
        return NAN;
    for (uint32_t i = 0; i < SAMPLER_ITEMS; i++)
        for (int c = 0; c < 4; c++)
            counts[c][(uint32_t)(draws[i].u[c] * 0x1p16f) % CELLS]++;
    for (int i = 0; i < CELLS; i++)
        expected[i] = (double)SAMPLER_ITEMS / CELLS;
    for (int c = 0; c < 4; c++)
        worst = fmax(worst, chi_square_deviate(counts[c], expected, CELLS));
    return worst;
}

TEST(fine_digits)
{
    static struct sampler_setup s;
    OPEN_SAMPLER(&s, 512, 512);
    s.samples = 64;
    for (s.sampler = 0; sampler_names[s.sampler]; s.sampler++) {
        double deviate = digits_deviate(&s);
        bool is_bad = s.sampler == SAMPLER_GRID || s.sampler == SAMPLER_SINE;
        printf("  %s: digits 9 to 16 are off by %.1f deviations\n", sampler_names[s.sampler],
               deviate);
        CHECK(is_bad || deviate <= DEVIATE_MAX, "%s: %.2f deviations", sampler_names[s.sampler],
              deviate);
    }
    sampler_close(&s);
}

// --- independence --------------------------------------------------------------------------------

enum { PAIRS = 1 << 16 };

struct variation {
    const char *name;
    uint32_t pixel, sample, dimension; // what is added to each number
};

static const struct variation variations[] = {
    {"next dimension", 0, 0, 1},
    {"dimension 1024 further", 0, 0, 1024},
    {"dimension 2^31 further", 0, 0, 0x80000000},
    {"next pixel", 1, 0, 0},
    {"next row", 512, 0, 0},
};

// Draws a sample of every second pixel and, next to it, the sample in which one number has changed.
static bool draw_variation(struct sampler_setup *s, const struct variation *variation)
{
    for (uint32_t i = 0; i < PAIRS; i++) {
        draws[i] = (union draw){.pixel = 2 * i, .sample = 5, .dimension = 3};
        draws[PAIRS + i] = draws[i];
        draws[PAIRS + i].pixel += variation->pixel;
        draws[PAIRS + i].dimension += variation->dimension;
    }
    return draw_all(s, 2 * PAIRS);
}

// Over pixels, which are hashed, draws that differ in a single number must not be correlated. The
// limit is 4 deviations; one of 120 exceeds it with a probability of 0.8 %.
#define CORRELATION_MAX (4 / sqrt(PAIRS))

TEST(independent)
{
    static struct sampler_setup s;
    OPEN_SAMPLER(&s, 512, 512);
    s.samples = 64;
    for (s.sampler = 0; sampler_names[s.sampler]; s.sampler++) {
        // A blue-noise sampler correlates nearby pixels on purpose.
        int most = s.sampler == SAMPLER_BLUE_NOISE ? 3 : 5;
        // Larger differences exceed what the argument of the sine can distinguish, see sine_is_bad.
        most = s.sampler == SAMPLER_SINE ? 2 : most;
        for (int v = 0; v < most; v++) {
            if (!draw_variation(&s, &variations[v]))
                break;
            for (int c = 0; c < 4; c++) {
                double r = draws_correlation(draws, draws + PAIRS, PAIRS, c);
                CHECK(fabs(r) < CORRELATION_MAX, "%s, %s, component %d: %g",
                      sampler_names[s.sampler], variations[v].name, c, r);
            }
        }
    }
    sampler_close(&s);
}

// Compares seeds 0, 1, 2, 2^31, 2^32 - 2 and 2^32 - 1 with each other, and numbers of ranges that a
// path uses together, by cells, because dependent numbers need not be correlated. A pair of
// components has 255 degrees of freedom. Of 3 * 3 * 4 * 4 * 2 pairs none exceeds 6 standard
// deviations with a probability above 0.999 (including chi-square's skewness).
TEST(ranges_are_independent)
{
    enum { CELLS = 16, FIRST = 3 };
    static const uint32_t ranges[] = {DIMENSIONS_OF_LIGHT_PATHS, DIMENSIONS_OF_PIXELS,
                                      DIMENSIONS_OF_ALL_LIGHTS};
    static const unsigned samplers[] = {SAMPLER_PCG, SAMPLER_LCG};
    static struct sampler_setup s;
    OPEN_SAMPLER(&s, 512, 512);
    for (int k = 0; k < 2 * FIRST * FIRST; k++) {
        const uint32_t dimension = (uint32_t)k % FIRST, range = ranges[k / FIRST % FIRST];
        s.sampler = samplers[k / (FIRST * FIRST)];
        for (uint32_t i = 0; i < PAIRS; i++) {
            draws[i] = (union draw){.pixel = 137, .sample = i, .dimension = dimension};
            draws[PAIRS + i] = draws[i];
            draws[PAIRS + i].dimension += range;
        }
        if (!draw_all(&s, 2 * PAIRS))
            break;
        for (int pair = 0; pair < 16; pair++) {
            double cells[CELLS * CELLS] = {0}, chi = 0.0;
            const double expected = (double)PAIRS / (CELLS * CELLS);
            for (uint32_t i = 0; i < PAIRS; i++)
                cells[(int)(draws[i].u[pair / 4] * CELLS) * CELLS +
                      (int)(draws[PAIRS + i].u[pair % 4] * CELLS)]++;
            for (int cell = 0; cell < CELLS * CELLS; cell++)
                chi += pow(cells[cell] - expected, 2.0) / expected;
            CHECK((chi - 255.0) / sqrt(2.0 * 255.0) < 6.0, "%s, %u and %u further, pair %d: %g",
                  sampler_names[s.sampler], dimension, range, pair, chi);
        }
    }
    sampler_close(&s);
}

TEST(seeds)
{
    static const uint32_t seeds[] = {0, 1, 2, 0x80000000, 0xfffffffe, 0xffffffff};
    static union draw kept[6][PAIRS];
    static struct sampler_setup s;
    OPEN_SAMPLER(&s, 512, 512);
    s.samples = 64;
    for (s.sampler = 0; sampler_names[s.sampler]; s.sampler++) {
        for (int k = 0; k < 6 && s.sampler != SAMPLER_SINE; k++) {
            s.seed = seeds[k];
            for (uint32_t i = 0; i < PAIRS; i++)
                draws[i] = (union draw){.pixel = i, .sample = 5, .dimension = 3};
            if (!draw_all(&s, PAIRS))
                break;
            memcpy(kept[k], draws, sizeof kept[k]);
        }
        for (int pair = 0; pair < 36; pair++) {
            int a = pair / 6, b = pair % 6;
            if (a >= b || s.sampler == SAMPLER_SINE)
                continue;
            memcpy(draws, kept[a], sizeof kept[a]);
            memcpy(draws + PAIRS, kept[b], sizeof kept[b]);
            double r = draws_correlation(draws, draws + PAIRS, PAIRS, 0);
            // A blue-noise picture is one sequence of 2^16 points for each tile of 2^16 pixels. Its
            // correlation with another is that of two sequences, and smaller than this.
            CHECK(fabs(r) < 4 / sqrt(PAIRS), "%s, seeds %u and %u: %g", sampler_names[s.sampler],
                  seeds[a], seeds[b], r);
        }
    }
    sampler_close(&s);
}

// Fractions of sines clearly fail the tests that all other samplers pass. A product of 43758 and a
// sine has steps of up to 2^-8, and a large argument has steps beyond a whole period: then
// neighbours, and seeds, have the same numbers.
TEST(sine_is_bad)
{
    static const uint32_t seeds[] = {0xfffffffe, 0xffffffff};
    static struct sampler_setup s;
    uint32_t same = 0;
    OPEN_SAMPLER(&s, 512, 512);
    s.sampler = SAMPLER_SINE;
    s.samples = 64;
    double deviate = digits_deviate(&s);
    CHECK(deviate > 10 * DEVIATE_MAX, "digits: %.2f deviations", deviate);
    for (uint32_t i = 0; i < PAIRS; i++)
        draws[i] = draws[PAIRS + i] =
            (union draw){.pixel = i % 512 + i / 512 % 128 * 512, .sample = 5, .dimension = 3};
    for (int k = 0; k < 2; k++) {
        s.seed = seeds[k];
        if (!draw_all(&s, 2 * PAIRS))
            break;
        for (uint32_t i = 1; i < PAIRS; i++)
            same += memcmp(&draws[i], &draws[i - 1], sizeof *draws) == 0;
    }
    printf("  sine: %u of %u neighbours have the same four numbers\n", same, 2 * PAIRS - 2);
    CHECK(same > PAIRS, "seeds 2^32 - 2 and 2^32 - 1: %u the same", same);
    sampler_close(&s);
}

// Dimension numbers are padded: over the samples of one pixel, components of different numbers must
// not be correlated. Both are shuffled within blocks of 2, 4, 8, ... points, so where digits k of
// the two are compared, 2^k points belong together. In total, the variance of the correlation is
// 9/7 of that of independent samples. Of 992 pairs one exceeds 5.5 with a probability of 0.1 %.
// Dimension numbers are up to 2^31.
TEST(padded)
{
    enum { COUNT = 4096, NUMBERS = 32 };
    static struct sampler_setup s;
    double worst = 0;
    OPEN_SAMPLER(&s, 512, 512);
    for (uint32_t n = 0; n < NUMBERS; n++)
        for (uint32_t i = 0; i < COUNT; i++)
            draws[n * COUNT + i] =
                (union draw){.pixel = 99, .sample = 2 * i, .dimension = n < 16 ? n : 1u << n | n};
    if (draw_all(&s, NUMBERS * COUNT)) {
        for (uint32_t pair = 0; pair < NUMBERS * NUMBERS; pair++) {
            uint32_t a = pair / NUMBERS, b = pair % NUMBERS;
            double product = 0;
            for (uint32_t i = 0; i < COUNT && a != b; i++)
                product += ((double)draws[a * COUNT + i].u[pair % 4] - 0.5) *
                           ((double)draws[b * COUNT + i].u[pair / 4 % 4] - 0.5);
            worst = fmax(worst, fabs(product) * 12 / sqrt(COUNT));
        }
        printf("  largest correlation of %d pairs: %.2f / sqrt(n)\n", NUMBERS * (NUMBERS - 1),
               worst);
        CHECK(worst <= 5.5, "%g", worst);
    }
    sampler_close(&s);
}

TEST_MAIN(TEST_CASE(in_range), TEST_CASE(unbiased), TEST_CASE(fine_digits), TEST_CASE(independent),
          TEST_CASE(ranges_are_independent), TEST_CASE(seeds), TEST_CASE(padded),
          TEST_CASE(sine_is_bad))
