// Routines of check_arithmetic.comp and check_threads.comp: read by C and by GLSL.
#ifndef SHARED_CHECK_H
#define SHARED_CHECK_H

#define CONSTANT_CHECK_ROUTINE CONSTANT_COUNT
#define CONSTANT_CHECK_COUNT (CONSTANT_COUNT + 1)

// Arithmetic: of the floats a, b, c of an item.
#define CHECK_SUM 0u           // a + b
#define CHECK_PRODUCT 1u       // a b
#define CHECK_QUOTIENT 2u      // a / b
#define CHECK_ROOT 3u          // sqrt(a)
#define CHECK_SUM_ERROR 4u     // a + b, and what rounding took of it
#define CHECK_PRODUCT_ERROR 5u // a b, and what rounding took of it
#define CHECK_CONTRACTION 6u   // a b + c: precise, left to the compiler, and as fma()
#define CHECK_SINE 7u          // sin(a), cos(a)
#define CHECK_TURNS 8u         // cos_sin_turns(a)
#define CHECK_DENORMALS 9u     // a b
#define CHECK_INTEGERS 10u     // words: high and low of a product, reversed bits, highest bit
#define CHECK_HALVES 11u       // the halves in the first word, as floats
#define CHECK_CONVERSIONS 12u  // the first word as a float, floor(b), uint(c)

// Threads.
#define CHECK_LOOP 0u          // the turns of a loop of `count` turns
#define CHECK_ATOMICS 1u       // the value before one was added to a counter
#define CHECK_BARRIERS 2u      // values that went round the workgroup `count` times
#define CHECK_ARRAY 3u         // the sum over an array of `count` elements
#define CHECK_DISPATCHES 4u    // 3 x + 1 of the value that the dispatch before has left
#define CHECK_TEXELS 5u        // the item, read as a texel
#define CHECK_SUBGROUPS 6u     // the subgroup's size, and the rank among its odd lanes
#define CHECK_RECONVERGENCE 7u // how many lanes vote after a branch, and how many there are

#endif
