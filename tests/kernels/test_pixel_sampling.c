// Tests the renderer's lib/pixel_sampling.glsl: strata are filled in rounds, exactly. By
// statistics: every sample is uniform in its pixel, and the halves are independent.
#include "sampler_fixture.h"

static union draw draws[SAMPLER_ITEMS];

// Fills in samples first .. first + count - 1 of a pixel.
static void fill_pixel(uint32_t at, uint32_t pixel, uint32_t first, uint32_t step, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++)
        draws[at + i] = (union draw){.pixel = pixel, .sample = first + i * step};
}

static uint32_t stratum_of(const union draw *draw, uint32_t n)
{
    return (uint32_t)((double)draw->u[1] * n) * n + (uint32_t)((double)draw->u[0] * n);
}

// --- strata --------------------------------------------------------------------------------------

// Numbers have 24 bits: a centre has an error of at most one unit, and a point may be below its
// stratum's edge by less than one.
static bool is_centre(float u, uint32_t n)
{
    double place = (double)u * n - floor((double)u * n);
    return fabs(place - 0.5) <= n * 0x1p-24;
}

// Takes one half's samples in three rounds of n x n. Each round has every stratum once, and the
// second one in another order, if there is a choice.
static void check_rounds(struct sampler_setup *s, uint32_t half)
{
    const uint32_t n = s->pixel_strata, count = n * n, step = s->halves ? 1 : 2;
    uint32_t doubled = 0, uncentred = 0, repeated = 0;
    for (uint32_t round = 0; round < 3; round++)
        fill_pixel(round * count, 77 + n, half + round * count * step, step, count);
    if (!sampler_pixel_places(s, draws, 3 * count))
        return;
    for (uint32_t round = 0; round < 3; round++) {
        uint32_t seen[SETTINGS_STRATA_MAX * SETTINGS_STRATA_MAX] = {0};
        for (uint32_t i = 0; i < count; i++) {
            const union draw *draw = &draws[round * count + i];
            // The lower side of an edge that is between 24-bit numbers belongs to the stratum.
            union draw inside = *draw;
            for (int c = 0; c < 2; c++)
                inside.u[c] += 0x1p-25f;
            doubled += seen[stratum_of(&inside, n)]++ > 0;
            uncentred += !is_centre(draw->u[0], n) || !is_centre(draw->u[1], n);
            repeated += round == 1 && stratum_of(draw, n) == stratum_of(&draws[i], n);
        }
    }
    CHECK(doubled == 0, "%s, %u x %u: %u twice in a round", pixel_sampling_names[s->pixel_sampling],
          n, n, doubled);
    CHECK((uncentred == 0) == (s->pixel_sampling == PIXEL_SAMPLING_GRID),
          "%s, %u x %u: %u not at the centre", pixel_sampling_names[s->pixel_sampling], n, n,
          uncentred);
    CHECK(count < 9 || repeated < count / 2, "%u x %u: %u of the second round as in the first", n,
          n, repeated);
}

TEST(rounds)
{
    static struct sampler_setup s;
    OPEN_SAMPLER(&s, 512, 512);
    s.samples = 64;
    for (uint32_t n = 1; n <= SETTINGS_STRATA_MAX; n++) {
        for (uint32_t turn = 0; turn < 4; turn++) {
            s.pixel_strata = n;
            s.pixel_sampling = turn % 2 ? PIXEL_SAMPLING_GRID : PIXEL_SAMPLING_STRATIFIED;
            s.halves = turn / 2 ? HALVES_CONTIGUOUS : HALVES_INDEPENDENT;
            check_rounds(&s, 0);
            if (s.halves == HALVES_INDEPENDENT)
                check_rounds(&s, 1);
        }
    }
    sampler_close(&s);
}

// --- statistics ----------------------------------------------------------------------------------

static double deviate_of(const uint32_t *counts, uint32_t cells, uint32_t total)
{
    double expected[256];
    for (uint32_t i = 0; i < cells; i++)
        expected[i] = (double)total / cells;
    return chi_square_deviate(counts, expected, cells);
}

// Over pixels, any sample must be uniform in 16 x 16 cells, although 4 x 4 strata are not full. The
// probability of an error is 1e-4 for all together.
TEST(unbiased)
{
    static const uint32_t samples[] = {0, 1, 5, 37, 0xfffffffe};
    static const uint32_t kinds[] = {PIXEL_SAMPLING_RANDOM, PIXEL_SAMPLING_STRATIFIED};
    static struct sampler_setup s;
    OPEN_SAMPLER(&s, 512, 512);
    s.pixel_strata = 4;
    for (int k = 0; k < 10; k++) {
        uint32_t counts[256] = {0}, outside = 0;
        s.pixel_sampling = kinds[k % 2];
        for (uint32_t i = 0; i < SAMPLER_ITEMS; i++)
            fill_pixel(i, i, samples[k / 2], 1, 1);
        if (!sampler_pixel_places(&s, draws, SAMPLER_ITEMS))
            break;
        for (uint32_t i = 0; i < SAMPLER_ITEMS; i++) {
            const float *u = draws[i].u;
            outside += !(u[0] >= 0 && u[0] < 1 && u[1] >= 0 && u[1] < 1);
            counts[stratum_of(&draws[i], 16) & 255]++;
        }
        double deviate = deviate_of(counts, 256, SAMPLER_ITEMS);
        CHECK(outside == 0, "%u outside of [0, 1)", outside);
        CHECK(deviate <= 4.3, "%s, sample %u: %.2f deviations",
              pixel_sampling_names[s.pixel_sampling], samples[k / 2], deviate);
    }
    sampler_close(&s);
}

// Returns the chi-square deviate, over pixels, of 16 x 16 pairs of strata for two samples.
static double deviate_of_pairs(struct sampler_setup *s, uint32_t first, uint32_t second)
{
    enum { PIXELS = SAMPLER_ITEMS / 2 };
    uint32_t counts[256] = {0};
    for (uint32_t i = 0; i < PIXELS; i++) {
        fill_pixel(2 * i, i, first, 1, 1);
        fill_pixel(2 * i + 1, i, second, 1, 1);
    }
    if (!sampler_pixel_places(s, draws, 2 * PIXELS))
        return INFINITY;
    for (uint32_t i = 0; i < PIXELS; i++)
        counts[(stratum_of(&draws[2 * i], 4) * 16 + stratum_of(&draws[2 * i + 1], 4)) & 255]++;
    return deviate_of(counts, 256, PIXELS);
}

// Samples of different halves are independent. Those of one half in the same round are not, because
// they never share a stratum; nor are those of contiguous halves.
TEST(halves)
{
    static struct sampler_setup s;
    OPEN_SAMPLER(&s, 512, 512);
    s.samples = 64;
    s.pixel_strata = 4;
    for (int k = 0; k < 2; k++) {
        s.pixel_sampling = k ? PIXEL_SAMPLING_GRID : PIXEL_SAMPLING_STRATIFIED;
        s.halves = HALVES_INDEPENDENT;
        double apart = fmax(deviate_of_pairs(&s, 0, 1), deviate_of_pairs(&s, 4, 31));
        double rounds = deviate_of_pairs(&s, 2, 2 * 16 + 2), round = deviate_of_pairs(&s, 0, 2);
        s.halves = HALVES_CONTIGUOUS;
        double contiguous = deviate_of_pairs(&s, 0, 1);
        CHECK(apart <= 4.3, "different halves: %.2f deviations", apart);
        CHECK(rounds <= 4.3, "different rounds: %.2f deviations", rounds);
        CHECK(round > 10 && contiguous > 10, "one round: %.2f and %.2f deviations", round,
              contiguous);
    }
    sampler_close(&s);
}

TEST_MAIN(TEST_CASE(rounds), TEST_CASE(unbiased), TEST_CASE(halves))
