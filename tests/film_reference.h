// The film's sums (shaders/shared/film_sums.h) in C, by double precision: what a value brings to
// the bins of both digits.
#ifndef LAMPYRIS_TESTS_FILM_REFERENCE_H
#define LAMPYRIS_TESTS_FILM_REFERENCE_H

#include "shared/types.h"
#include <math.h>

static inline int film_reference_digit(float value)
{
    return value == 0.0f ? 0 : (ilogb((double)value) + 128) / 32;
}

// The unit of a digit, as a power of two.
static inline int film_reference_unit(int digit)
{
    return 32 * digit + FILM_LEAST_EXPONENT;
}

static inline void film_reference_slices(float value, int top, int64_t *upper, int64_t *lower)
{
    double units = ldexp(fabs((double)value), -film_reference_unit(top - 1));
    double high = floor(ldexp(units, -32) + 0.5);
    // From 2^24 on a value of 24 bits is whole.
    double low = (units < 0x1p24 ? floor(units + 0.5) : units) - ldexp(high, 32);
    *upper = value < 0.0f ? -(int64_t)high : (int64_t)high;
    *lower = value < 0.0f ? -(int64_t)low : (int64_t)low;
}

static inline int film_reference_top(uint32_t digits, uint32_t component)
{
    int top = 0;
    for (uint32_t set = digits >> FILM_DIGIT_BITS * component & FILM_DIGITS_MASK; set; set >>= 1)
        top++;
    return top;
}

// The bin of a digit among a sum's four words.
static inline int64_t film_reference_bin(const uint32_t sum[4], int digit)
{
    const uint32_t *words = &sum[2 * (digit & 1)];
    return (int64_t)((uint64_t)words[1] << 32 | words[0]);
}

static inline void film_reference_set_bin(uint32_t sum[4], int digit, int64_t bin)
{
    uint32_t *words = &sum[2 * (digit & 1)];
    words[0] = (uint32_t)(uint64_t)bin;
    words[1] = (uint32_t)((uint64_t)bin >> 32);
}

static inline void film_reference_add(uint32_t sum[4], uint32_t *digits, uint32_t component,
                                      float value)
{
    int top = film_reference_top(*digits, component), digit = film_reference_digit(value);
    for (; top < digit; top++)
        film_reference_set_bin(sum, top + 1, 0);
    if (digit > 0)
        *digits |= 1u << (FILM_DIGIT_BITS * component + (uint32_t)digit - 1);
    int64_t upper, lower;
    film_reference_slices(value, top, &upper, &lower);
    film_reference_set_bin(sum, top, film_reference_bin(sum, top) + upper);
    film_reference_set_bin(sum, top - 1, film_reference_bin(sum, top - 1) + lower);
}

static inline double film_reference_value(const uint32_t sum[4], uint32_t digits,
                                          uint32_t component)
{
    int top = film_reference_top(digits, component);
    return ldexp((double)film_reference_bin(sum, top), film_reference_unit(top)) +
           ldexp((double)film_reference_bin(sum, top - 1), film_reference_unit(top - 1));
}

#endif
