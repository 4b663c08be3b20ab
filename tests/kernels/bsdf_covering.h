// Covering arrays of strength two.
#ifndef LAMPYRIS_TESTS_BSDF_COVERING_H
#define LAMPYRIS_TESTS_BSDF_COVERING_H

#include <stdint.h>

enum { COVERING_MAX_AXES = 24, COVERING_MAX_VALUES = 16 };

// Makes rows such that every two values of every two axes occur together at least once;
// values[axis] is the number of values. The algorithm is greedy (after Cohen et al. 1997, "The AETG
// System"), and its result is the same for every call. Returns the number of rows, at most
// `capacity`; if it is reached, pairs may be missing.
uint32_t covering_build(const uint8_t *values, uint32_t axes, uint8_t (*rows)[COVERING_MAX_AXES],
                        uint32_t capacity);
// Returns the number of pairs of values that no row has.
uint32_t covering_missing(const uint8_t *values, uint32_t axes,
                          const uint8_t (*rows)[COVERING_MAX_AXES], uint32_t count);

#endif
