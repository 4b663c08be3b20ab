// Runs the renderer's BSDFs on materials that were uploaded by the renderer's own code.
#ifndef LAMPYRIS_TESTS_BSDF_FIXTURE_H
#define LAMPYRIS_TESTS_BSDF_FIXTURE_H

#include "bsdf_reference.h"
#include "check/bsdf.h"
#include "kernel_fixture.h"

enum { BSDF_LOBES_CLASS, BSDF_LOBES_ALL, BSDF_LOBES_CHOICES };

struct bsdf_device {
    struct setup setup;
    // Kernels by the lobes compiled into them: those of the material's class, as for rendering, or
    // all.
    struct gpu_kernel kernels[BSDF_LOBES_CHOICES][CLASS_COUNT][BSDF_ROUTINES];
    uint32_t all_lobes;
};

// Opens a scene with one sphere per material, a renderer for it, and its kernels. Materials keep
// their numbers: items name material i by i + 1. Returns false if the test was skipped or failed.
bool bsdf_device_open(struct bsdf_device *device, const struct material *materials, uint32_t count);
bool bsdf_device_open_with(struct bsdf_device *device, const struct material *materials,
                           uint32_t count, struct bsdf_choices choices);
void bsdf_device_close(struct bsdf_device *device);

// Replaces `items` by the output of a routine, which runs in the kernel for the class of
// `material`.
bool bsdf_run(struct bsdf_device *device, uint32_t routine, int lobes,
              const struct material *material, union bsdf_item *items, uint32_t count);
#endif
