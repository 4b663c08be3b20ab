// Lists the kernels. A new kernel needs a .comp file, a line here and a line in
// shaders/meson.build.
#ifndef LAMPYRIS_RENDER_KERNELS_H
#define LAMPYRIS_RENDER_KERNELS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// A kernel has the same name in its file, in this list, and in every report and profile. Exceptions
// are the kernels that shade one class of surfaces: they are shade_surface.comp compiled with the
// lobes of that class (FEATURE_CLASSES), in the order of CLASS_*.
#define KERNEL_LIST(X)                                                                             \
    X(generate_rays)                                                                               \
    X(intersect_closest)                                                                           \
    X(shade_miss)                                                                                  \
    X(shade_surface)                                                                               \
    X(shade_diffuse)                                                                               \
    X(shade_principled)                                                                            \
    X(shade_transmissive)                                                                          \
    X(shade_classical)                                                                             \
    X(shade_ao)                                                                                    \
    X(shade_whitted)                                                                               \
    X(intersect_shadow)                                                                            \
    X(generate_light_rays)                                                                         \
    X(shade_light)                                                                                 \
    X(intersect_camera)                                                                            \
    X(add_splats)                                                                                  \
    X(sort_count)                                                                                  \
    X(sort_scan)                                                                                   \
    X(sort_scatter)                                                                                \
    X(accumulate)                                                                                  \
    X(prepare_dispatch)                                                                            \
    X(resolve)

enum kernel_id {
#define X(name) KERNEL_##name,
    KERNEL_LIST(X)
#undef X
        KERNEL_COUNT
};

struct kernel_code {
    const char *name;
    const uint32_t *spirv;
    size_t bytes;
};

// Returns the embedded SPIR-V, in the variant with or without subgroup ballot.
struct kernel_code kernel_code(enum kernel_id id, bool ballot);

// Returns a hash of the embedded kernels, which differs between builds whose kernels differ.
uint64_t kernels_hash(void);

// Kernels compiled while the program runs, which replace the embedded ones, in one variant.
struct kernel_set {
    struct kernel_code codes[KERNEL_COUNT]; // spirv NULL: the embedded code is used
};

#endif
