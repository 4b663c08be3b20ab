// Tests equidistribution, exactly: elementary intervals of Sobol's sequence and strata. Also tests
// that the scrambling is as random as Owen's.
#include "sampler_fixture.h"

static union draw draws[SAMPLER_ITEMS];

// Counts, for 2^m points of two components, how often an elementary interval of area 2^-(m-t) does
// not contain 2^t points. Each shape has 2^i columns and 2^(m-t-i) rows.
static uint32_t count_uneven(const union draw *points, int m, int t, int x, int y)
{
    uint32_t uneven = 0;
    for (int i = 0; i <= m - t; i++) {
        static uint32_t counts[1 << 12];
        int j = m - t - i;
        memset(counts, 0, sizeof counts);
        for (uint32_t p = 0; p < 1u << m; p++)
            counts[(uint32_t)ldexpf(points[p].u[x], i) << j |
                   (uint32_t)ldexpf(points[p].u[y], j)]++;
        for (uint32_t cell = 0; cell < 1u << (m - t); cell++)
            uneven += counts[cell] != 1u << t;
    }
    return uneven;
}

// Fills a block of 2^m points; pixel, dimension number, half-sequence and block are random.
static void fill_block(struct random *random, uint32_t first, int m, bool contiguous)
{
    uint32_t pixel = random_u32(random), dimension = random_u32(random);
    uint32_t half = random_u32(random) & 1;
    uint32_t block = random_u32(random) >> (m + 2);
    for (uint32_t i = 0; i < 1u << m; i++) {
        uint32_t index = (block << m) + i;
        draws[first + i] = (union draw){.pixel = pixel,
                                        .sample = contiguous ? index : 2 * index + half,
                                        .dimension = dimension};
    }
}

// Components 0 and 1 are a (0,2)-sequence. Every other pair has the quality that follows from the
// degrees of its polynomials: t = sum of degree - 1 (Niederreiter 1988, theorem 1).
TEST(elementary_intervals)
{
    static const int degree[4] = {1, 1, 2, 3};
    enum { M_MAX = 12, BLOCKS = 16 };
    static struct sampler_setup s;
    struct random random = {42};
    OPEN_SAMPLER(&s, 512, 512);
    s.samples = 1u << 20;
    s.sampler = SAMPLER_SOBOL;
    for (int m = 0; m <= M_MAX; m++) {
        s.halves = m % 2 ? HALVES_CONTIGUOUS : HALVES_INDEPENDENT;
        s.seed = random_u32(&random);
        for (uint32_t b = 0; b < BLOCKS; b++)
            fill_block(&random, b << m, m, s.halves == HALVES_CONTIGUOUS);
        if (!sampler_uniforms(&s, draws, BLOCKS << m))
            break;
        for (uint32_t pair = 0; pair < BLOCKS * 16; pair++) {
            int x = (int)(pair / 4 % 4), y = (int)(pair % 4);
            int t = degree[x] + degree[y] - 2;
            if (x >= y || t > m)
                continue;
            uint32_t uneven = count_uneven(draws + ((size_t)(pair / 16) << m), m, t, x, y);
            CHECK(uneven == 0, "2^%d points, components %d and %d: %u intervals", m, x, y, uneven);
        }
    }
    sampler_close(&s);
}

// A blue-noise tile is one sequence, which blocks of pixels along the Z curve share.
TEST(blue_noise_blocks)
{
    enum { SIDE = 8, LOG_SAMPLES = 3, M = 6 + LOG_SAMPLES };
    static struct sampler_setup s;
    OPEN_SAMPLER(&s, 512, 512);
    s.sampler = SAMPLER_BLUE_NOISE;
    s.halves = HALVES_CONTIGUOUS;
    s.samples = 1u << LOG_SAMPLES;
    for (uint32_t corner = 0; corner < 16; corner++) {
        uint32_t at = 0;
        for (uint32_t y = 0; y < SIDE; y++)
            for (uint32_t x = 0; x < SIDE; x++)
                for (uint32_t i = 0; i < s.samples; i++)
                    draws[at++] = (union draw){.pixel = (corner % 4 * SIDE * 13 + y) * 512 +
                                                        (corner / 4 * SIDE * 9 + x),
                                               .sample = i,
                                               .dimension = corner};
        if (!sampler_uniforms(&s, draws, at))
            break;
        uint32_t uneven = count_uneven(draws, M, 0, 0, 1);
        CHECK(uneven == 0, "block %u: %u intervals", corner, uneven);
    }
    sampler_close(&s);
}

// --- strata --------------------------------------------------------------------------------------

// Every stratum of a component, and every cell of a pair, contains at most one point. Without
// jitter the points are at the centres of the strata.
static void check_strata(const struct sampler_setup *s, uint32_t count)
{
    static uint32_t line[1 << 12], cell[1 << 12];
    uint32_t columns = (uint32_t)ceil(sqrt(count)), rows = (count + columns - 1) / columns;
    uint32_t strata = columns * rows, doubled = 0, off = 0;
    for (int c = 0; c < 4; c++) {
        memset(line, 0, sizeof line);
        memset(cell, 0, sizeof cell);
        for (uint32_t i = 0; i < count; i++) {
            const float *u = draws[i].u;
            double place = (double)u[c] * strata;
            doubled += line[(uint32_t)place]++ > 0;
            if (c % 2 == 0)
                doubled += cell[(uint32_t)(u[c + 1] * (float)rows) * columns +
                                (uint32_t)(u[c] * (float)columns)]++ > 0;
            off += fabs(place - floor(place) - 0.5) > 1e-3;
        }
    }
    CHECK(doubled == 0, "%s, %u samples: %u in the same strata", sampler_names[s->sampler], count,
          doubled);
    CHECK((off == 0) == (s->sampler == SAMPLER_GRID), "%s, %u samples: %u not at the centre",
          sampler_names[s->sampler], count, off);
}

TEST(strata)
{
    static const uint32_t counts[] = {1, 2, 3, 16, 17, 37, 1000};
    static struct sampler_setup s;
    OPEN_SAMPLER(&s, 512, 512);
    s.halves = HALVES_CONTIGUOUS;
    for (int k = 0; k < 14; k++) {
        s.sampler = k < 7 ? SAMPLER_STRATIFIED : SAMPLER_GRID;
        s.samples = counts[k % 7];
        // The second set of samples exceeds the plan, and has strata of its own.
        for (uint32_t first = 0; first < 2 * s.samples; first += s.samples) {
            for (uint32_t i = 0; i < s.samples; i++)
                draws[i] = (union draw){.pixel = 77, .sample = first + i, .dimension = 5};
            if (!sampler_uniforms(&s, draws, s.samples))
                break;
            check_strata(&s, s.samples);
        }
    }
    sampler_close(&s);
}

// --- scrambling ----------------------------------------------------------------------------------

// Takes the first three digits of four successive points, in any order: with Owen's scrambling each
// of the 2^7 outcomes (the quarters of the first two points, and all third digits) is equally
// likely. This is a chi-square test over pixels for each component, at 1e-5.
static void check_scrambling(int component, uint32_t pixels)
{
    enum { CELLS = 8 * 16 };
    uint32_t counts[CELLS] = {0}, impossible = 0;
    double expected[CELLS];
    for (uint32_t p = 0; p < pixels; p++) {
        uint32_t quarters = 0, thirds = 0, seen = 0, digits[4];
        for (int i = 0; i < 4; i++) {
            digits[i] = (uint32_t)(draws[4 * p + (uint32_t)i].u[component] * 8);
            seen |= 1u << digits[i] / 2;
            thirds |= (digits[i] & 1) << digits[i] / 2;
        }
        // The quarter of point 0, and the part of the other half in which point 1 is.
        quarters = digits[0] / 2 * 2 + (digits[1] / 2 & 1);
        impossible += seen != 15;
        counts[quarters * 16 + thirds]++;
    }
    for (int i = 0; i < CELLS; i++)
        expected[i] = (double)pixels / CELLS;
    double deviate = chi_square_deviate(counts, expected, CELLS);
    printf("  component %d: %.2f deviations\n", component, deviate);
    CHECK(impossible == 0, "component %d: %u not in four quarters", component, impossible);
    CHECK(deviate <= 4.3, "component %d: %.2f deviations", component, deviate);
}

TEST(scrambling)
{
    enum { PIXELS = SAMPLER_ITEMS / 4 };
    static struct sampler_setup s;
    OPEN_SAMPLER(&s, 512, 512);
    s.sampler = SAMPLER_SOBOL;
    s.halves = HALVES_CONTIGUOUS;
    s.samples = 4;
    for (uint32_t i = 0; i < SAMPLER_ITEMS; i++)
        draws[i] = (union draw){.pixel = i / 4, .sample = i % 4, .dimension = 2};
    if (sampler_uniforms(&s, draws, SAMPLER_ITEMS))
        for (int c = 0; c < 2; c++) // for other components four points need not be in four quarters
            check_scrambling(c, PIXELS);
    sampler_close(&s);
}

TEST_MAIN(TEST_CASE(elementary_intervals), TEST_CASE(blue_noise_blocks), TEST_CASE(strata),
          TEST_CASE(scrambling))
