// Small kernels of their own, beside the renderer's: what the driver itself does.
#ifndef LAMPYRIS_CHECK_DRIVER_H
#define LAMPYRIS_CHECK_DRIVER_H

#include "check/check.h"
#include "shared/bindings.h"
#include "shared/check.h"

#define DRIVER_WORKGROUP 64u

enum driver_program { DRIVER_ARITHMETIC, DRIVER_THREADS };

// Four words in and four out, of each thread.
typedef union {
    uint32_t u[4];
    float f[4];
} driver_item;

struct driver_run {
    enum driver_program program;
    uint32_t routine;    // CHECK_*
    uint32_t constant;   // CONSTANT_CHECK_COUNT
    uint32_t items;      // a multiple of DRIVER_WORKGROUP
    uint32_t dispatches; // one after the other, with barriers; 0: one
    bool texels;         // the input is bound as texels, too
    double device_ns;    // out: by timestamps, from before the first to behind the last
    double host_ns;      // out: from recording on until the host knew of the end
};

// Replaces the items by what the kernel writes. Neither of the pointers may be NULL.
bool driver_run(const struct check *check, struct driver_run *run, driver_item *items,
                struct err *err);

// A number of the sequence that begins with *state (Steele, Lea and Flood 2014, SplitMix).
uint32_t driver_random(uint64_t *state);
// A float of either sign between 2^-exponent and 2^exponent.
float driver_random_float(uint64_t *state, int exponent);

#endif
