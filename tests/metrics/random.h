// Random numbers for synthetic noise. The renderer does not use these generators.
#ifndef LAMPYRIS_TESTS_METRICS_RANDOM_H
#define LAMPYRIS_TESTS_METRICS_RANDOM_H

#include <math.h>
#include <stdint.h>

// A linear congruential generator (Knuth) with one sequence per program. Returns values in (0, 1).
static inline double uniform(void)
{
    static uint64_t state = 1;
    state = state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return ((double)(state >> 11) + 0.5) * 0x1p-53;
}

// Returns a normal variable (Box and Muller 1958).
static inline double normal(void)
{
    return sqrt(-2 * log(uniform())) * cos(2 * acos(-1.0) * uniform());
}

// SplitMix64 (Steele, Lea, Flood 2014) with a state that the caller owns.
static inline uint64_t random_next(uint64_t *state)
{
    uint64_t z = *state += UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
    return z ^ z >> 31;
}

static inline double random_uniform(uint64_t *state) // in (0, 1]
{
    return (double)((random_next(state) >> 11) + 1) * 0x1p-53;
}

#endif
