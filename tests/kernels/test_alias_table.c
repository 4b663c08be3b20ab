// The alias table gives every entry its exact probability.
#include "kernel_fixture.h"
#include "render/tables/alias_table.h"

// Returns the probability of each of `count` entries; all bins are equally likely.
static double *marginals(const struct alias_bin *bins, uint32_t count)
{
    double *out = calloc(count, sizeof *out);
    for (uint32_t i = 0; out && i < count; i++) {
        double own = (double)bins[i].threshold;
        out[i] += own / count;
        out[bins[i].alias] += (1 - own) / count;
    }
    return out;
}

// Thresholds are rounded to single precision, by at most 2^-25 of a bin for each bin that
// contributes to an entry's probability. There are about as many such bins as the probability is
// worth.
static void check_table(const char *name, const double *weights, uint32_t count)
{
    struct arena arena = {0};
    struct alias_bin *bins = ARENA_NEW(&arena, struct alias_bin, count);
    REQUIRE(bins && alias_table_build(weights, count, &arena, bins), "out of memory");
    double sum = 0, worst = 0, worst_relative = 0;
    uint32_t bad_bins = 0, zeros_chosen = 0;
    for (uint32_t i = 0; i < count; i++) {
        sum += weights[i];
        bad_bins += !(bins[i].threshold >= 0 && bins[i].threshold <= 1) || bins[i].alias >= count;
    }
    REQUIRE(bad_bins == 0, "%s: %u bins out of range", name, bad_bins);
    double *chosen = marginals(bins, count);
    REQUIRE(chosen, "out of memory");
    for (uint32_t i = 0; i < count; i++) {
        double wanted = weights[i] / sum, error = fabs(chosen[i] - wanted);
        worst = fmax(worst, error);
        if (weights[i] > 0)
            worst_relative = fmax(worst_relative, error / wanted);
        zeros_chosen += !(weights[i] > 0) && chosen[i] > 0;
    }
    printf("  %-24s %8u entries: off by %.2g at most, relative %.2g\n", name, count, worst,
           worst_relative);
    CHECK(worst <= 1e-7, "%s: %g", name, worst);
    CHECK(worst_relative <= 2e-7, "%s: %g of an entry's probability", name, worst_relative);
    CHECK(zeros_chosen == 0, "%s: %u entries without weight are chosen", name, zeros_chosen);
    free(chosen);
    arena_finish(&arena);
}

TEST(hand_values)
{
    check_table("one", (const double[]){3}, 1);
    check_table("equal", (const double[]){1, 1, 1, 1}, 4);
    check_table("1 to 3", (const double[]){1, 2, 3}, 3);
    check_table("zeros", (const double[]){0, 5, 0, 0, 2, 0}, 6);
    check_table("only the last", (const double[]){0, 0, 0, 7}, 4);
    // The weights differ as much as single precision permits; even smaller ones are never chosen.
    check_table("tiny and huge", (const double[]){1e-30, 1e6, 1}, 3);
}

TEST(random_weights)
{
    static const uint32_t counts[] = {2, 17, 1000, 1000000};
    struct random random = {21};
    for (int i = 0; i < 4; i++) {
        double *weights = calloc(counts[i], sizeof *weights);
        REQUIRE(weights, "out of memory");
        // The weights span 12 orders of magnitude; a quarter of them is zero, but not the first
        // one.
        for (uint32_t w = 0; w < counts[i]; w++)
            weights[w] =
                w > 0 && random_u32(&random) % 4 == 0 ? 0 : pow(10, random_between(&random, -9, 3));
        check_table("random", weights, counts[i]);
        free(weights);
    }
}

// A million lights, one of them bright (docs/verification.md, C16).
TEST(one_of_a_million)
{
    enum { COUNT = 1000000 };
    double *weights = calloc(COUNT, sizeof *weights);
    REQUIRE(weights, "out of memory");
    for (uint32_t i = 0; i < COUNT; i++)
        weights[i] = 1e-6;
    weights[123456] = 1e6;
    check_table("one of a million", weights, COUNT);
    for (uint32_t i = 0; i < COUNT; i++)
        weights[i] = i == 654321 ? 1 : 0;
    check_table("the only one", weights, COUNT);
    free(weights);
}

TEST_MAIN(TEST_CASE(hand_values), TEST_CASE(random_weights), TEST_CASE(one_of_a_million))
