// Running the routines of library.comp.
#ifndef LAMPYRIS_TESTS_LIBRARY_FIXTURE_H
#define LAMPYRIS_TESTS_LIBRARY_FIXTURE_H

#include "kernel_fixture.h"
#include "routines.h"

struct library {
    struct gpu gpu;
    struct scene scene;
    struct renderer r;
};

// Inputs and outputs of an item; see library.comp.
union words {
    float f[4][4];
    uint32_t u[4][4];
};

// How many items a run may have, on any device.
#define LIBRARY_ITEMS (1u << 17)

// Leaves the test as skipped without a device. Makes a renderer on library->scene, which the test
// filled before.
#define OPEN_LIBRARY(library)                                                                      \
    do {                                                                                           \
        struct err library_err = {0};                                                              \
        OPEN_GPU(&(library)->gpu, .validation = false);                                            \
        const struct renderer_params library_params = {                                            \
            .gpu = &(library)->gpu, .scene = &(library)->scene, .wave = LIBRARY_ITEMS};            \
        bool created = renderer_create(&library_params, &(library)->r, &library_err);              \
        REQUIRE(created, "%s", library_err.msg);                                                   \
    } while (0)
void library_close(struct library *library);

// Replaces `items` by what the routine makes of them; records a failure and returns false if that
// cannot be.
bool library_run(struct library *library, uint32_t routine, union words *items, uint32_t count);

#endif
