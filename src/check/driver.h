// Runs small kernels that test the driver itself, independently of the renderer's kernels.
#ifndef LAMPYRIS_CHECK_DRIVER_H
#define LAMPYRIS_CHECK_DRIVER_H

#include "check/check.h"
#include "shared/bindings.h"
#include "shared/check.h"

#define DRIVER_WORKGROUP 64u

enum driver_program { DRIVER_ARITHMETIC, DRIVER_THREADS };

// Four words of input, or of output, of one thread.
typedef union {
    uint32_t u[4];
    float f[4];
} driver_item;

struct driver_run {
    enum driver_program program;
    uint32_t routine;    // CHECK_*
    uint32_t constant;   // value of the specialization constant CONSTANT_CHECK_COUNT
    uint32_t items;      // a multiple of DRIVER_WORKGROUP
    uint32_t dispatches; // number of dispatches with barriers in between; 0 means 1
    bool texels;         // the input is also bound as a texel buffer
    // result: time between timestamps before the first dispatch and after the last one
    double device_ns;
    double host_ns; // result: time from the start of recording until the host saw the end
};

// Replaces the items by the kernel's output. No pointer may be NULL.
bool driver_run(const struct check *check, struct driver_run *run, driver_item *items,
                struct err *err);

// Returns the next number of the pseudo-random sequence *state (Steele, Lea and Flood 2014,
// SplitMix).
uint32_t driver_random(uint64_t *state);
// Returns a random float of either sign whose magnitude is between 2^-exponent and 2^exponent.
float driver_random_float(uint64_t *state, int exponent);

#endif
