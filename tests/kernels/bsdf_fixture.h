// Running the shipped BSDFs on materials that went through the shipped upload.
#ifndef LAMPYRIS_TESTS_BSDF_FIXTURE_H
#define LAMPYRIS_TESTS_BSDF_FIXTURE_H

#include "bsdf_reference.h"
#include "check/bsdf.h"
#include "kernel_fixture.h"

enum { BSDF_LOBES_CLASS, BSDF_LOBES_ALL, BSDF_LOBES_CHOICES };

struct bsdf_device {
    struct setup setup;
    // By the lobes compiled in: those of the material's class, as rendering has them, or all.
    struct gpu_kernel kernels[BSDF_LOBES_CHOICES][CLASS_COUNT][BSDF_ROUTINES];
    uint32_t all_lobes;
};

// A scene of one sphere for each material, a renderer on it, and its kernels. Leaves the material's
// number i as it is, so that items name it by i + 1. False: skipped or failed.
bool bsdf_device_open(struct bsdf_device *device, const struct material *materials, uint32_t count);
bool bsdf_device_open_with(struct bsdf_device *device, const struct material *materials,
                           uint32_t count, struct bsdf_choices choices);
void bsdf_device_close(struct bsdf_device *device);

// Replaces `items` by what the routine makes of them, with the kernel of `material`'s class.
bool bsdf_run(struct bsdf_device *device, uint32_t routine, int lobes,
              const struct material *material, union bsdf_item *items, uint32_t count);
#endif
