// Running the routines of library.comp.
#ifndef LAMPYRIS_TESTS_LIBRARY_FIXTURE_H
#define LAMPYRIS_TESTS_LIBRARY_FIXTURE_H

#include "kernel_fixture.h"
#include "routines.h"

// Inputs and outputs of an item; see library.comp.
union words {
    float f[4][4];
    uint32_t u[4][4];
};

// Room for so many items at a time is enough for a setup.
#define LIBRARY_SLOTS (1u << 17)

// A kernel that takes such items, and its constant CONSTANT_ROUTINE.
struct routine {
    const uint32_t *spirv;
    size_t spirv_bytes;
    uint32_t number;
};

bool routine_run(struct setup *setup, const struct routine *routine, union words *items,
                 uint32_t count);

// Replaces `items` by what the routine makes of them; records a failure and returns false if that
// cannot be.
bool library_run(struct setup *setup, uint32_t routine, union words *items, uint32_t count);

#endif
