// Numbers the routines of check_arithmetic.comp and check_threads.comp, for C and GLSL.
#ifndef SHARED_CHECK_H
#define SHARED_CHECK_H

#define CONSTANT_CHECK_ROUTINE CONSTANT_COUNT
#define CONSTANT_CHECK_COUNT (CONSTANT_COUNT + 1)

// Arithmetic routines, for the floats a, b, c of an item.
#define CHECK_SUM 0u           // a + b
#define CHECK_PRODUCT 1u       // a b
#define CHECK_QUOTIENT 2u      // a / b
#define CHECK_ROOT 3u          // sqrt(a)
#define CHECK_SUM_ERROR 4u     // a + b, and its rounding error
#define CHECK_PRODUCT_ERROR 5u // a b, and its rounding error
#define CHECK_CONTRACTION 6u   // a b + c: as `precise`, with contraction permitted, and as fma()
#define CHECK_SINE 7u          // sin(a), cos(a)
#define CHECK_TURNS 8u         // cos_sin_turns(a)
#define CHECK_DENORMALS 9u     // a b
#define CHECK_INTEGERS 10u // integers: high and low word of a product, reversed bits, highest bit
#define CHECK_HALVES 11u   // the two halves in the first word, as floats
#define CHECK_CONVERSIONS 12u // the first word as a float, floor(b), uint(c)

// Thread routines.
#define CHECK_LOOP 0u       // the number of iterations of a loop of `count` iterations
#define CHECK_ATOMICS 1u    // the value of a counter before 1 was added
#define CHECK_BARRIERS 2u   // values passed around the workgroup `count` times
#define CHECK_ARRAY 3u      // the sum over an array of `count` elements
#define CHECK_DISPATCHES 4u // 3 x + 1, where x is the value that the preceding dispatch has stored
#define CHECK_TEXELS 5u     // the item, read as a texel
#define CHECK_SUBGROUPS 6u  // the subgroup's size, and the rank among its lanes with odd values
// The number of lanes that vote after a branch, and the number of lanes.
#define CHECK_RECONVERGENCE 7u

#endif
