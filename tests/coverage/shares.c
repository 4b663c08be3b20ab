#include "shares.h"

#include <math.h>

static const double significance = 0.001;

// Returns the probability that at most `held` of `cases` independent events of probability `p`
// occur.
static double chance_of_at_most(uint32_t held, uint32_t cases, double p)
{
    double sum = 0;
    for (uint32_t k = 0; k <= held; k++) {
        double ways = lgamma(cases + 1.0) - lgamma(k + 1.0) - lgamma(cases - k + 1.0);
        sum += exp(ways + k * log(p) + (cases - k) * log1p(-p));
    }
    return sum;
}

bool share_is_too_small(uint32_t held, uint32_t cases, double p)
{
    return held < cases && chance_of_at_most(held, cases, p) < significance;
}
