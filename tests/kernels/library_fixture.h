// Runs the routines of library.comp.
#ifndef LAMPYRIS_TESTS_LIBRARY_FIXTURE_H
#define LAMPYRIS_TESTS_LIBRARY_FIXTURE_H

#include "kernel_fixture.h"
#include "routines.h"

// Inputs and outputs of an item; see library.comp.
union words {
    float f[4][4];
    uint32_t u[4][4];
};

// A setup with this many slots has room for all items.
#define LIBRARY_SLOTS (1u << 17)

// A kernel with such items, and the value of its constant CONSTANT_ROUTINE.
struct routine {
    const uint32_t *spirv;
    size_t spirv_bytes;
    uint32_t number;
};

bool routine_run(struct setup *setup, const struct routine *routine, union words *items,
                 uint32_t count);

// Replaces `items` by the output of the routine. Returns false, and records a failure, if the
// device failed.
bool library_run(struct setup *setup, uint32_t routine, union words *items, uint32_t count);

#endif
