// Helpers for the tests of kernels: scenes built in C, a device and a renderer for them, and
// running one kernel on buffers that the test has filled.
#ifndef LAMPYRIS_TESTS_KERNEL_FIXTURE_H
#define LAMPYRIS_TESTS_KERNEL_FIXTURE_H

#include "base/maths.h"
#include "open_gpu.h"
#include "render/counters.h"
#include "render/render.h"

// --- random numbers ------------------------------------------------------------------------------

// PCG-XSH-RR 64/32 (O'Neill 2014).
struct random {
    uint64_t state;
};
uint32_t random_u32(struct random *random);
double random_unit(struct random *random); // [0, 1)
double random_between(struct random *random, double min, double max);
void random_direction(struct random *random, float direction[3]); // uniform on the sphere

// The hash that the kernels use (Jarzynski and Olano 2020, "Hash Functions for GPU Rendering",
// listing in section 4).
void pcg4d(uint32_t v[4]);

// --- vectors -------------------------------------------------------------------------------------

// Subtracts points given in single precision.
void subtract(const float a[3], const float b[3], double out[3]);

// --- scenes --------------------------------------------------------------------------------------
// Helpers exit when memory is exhausted. A scene is released by scene_finish().

// Makes a scene with a grey material 0, a camera at (0, 0, 4) that looks along -z, and default
// settings.
void scene_start(struct scene *scene, uint32_t width, uint32_t height);
uint32_t add_material(struct scene *scene, const struct material *material);
// Adds triangles with unshared vertices, as a mesh with an identity instance.
void add_triangles(struct scene *scene, const float (*vertices)[3][3], uint32_t count,
                   uint32_t material);
// The same with a normal for each vertex.
void add_smooth_triangles(struct scene *scene, const float (*vertices)[3][3],
                          const float (*normals)[3][3], uint32_t count, uint32_t material);
void add_sphere(struct scene *scene, const double center[3], double radius, uint32_t material);
void add_disc(struct scene *scene, const double center[3], const double normal[3], double radius,
              uint32_t material);
// Makes an environment image of width x height texels, all different.
void add_environment_image(struct scene *scene, uint32_t width, uint32_t height);

// --- a renderer ----------------------------------------------------------------------------------

struct setup {
    struct gpu gpu;
    struct scene scene;
    struct renderer r;
};

// Makes a renderer for setup->scene, which the test has filled. If that is impossible, ends the
// test as skipped or failed. `slots` is the number of paths in flight; the other macro takes any
// members of renderer_params.
#define OPEN_SETUP(setup, slots) OPEN_SETUP_WITH(setup, .wave = (slots))
#define OPEN_SETUP_WITH(setup, ...)                                                                \
    do {                                                                                           \
        struct err setup_err = {0};                                                                \
        OPEN_GPU(&(setup)->gpu, .validation = false);                                              \
        const struct renderer_params setup_params = {                                              \
            .gpu = &(setup)->gpu, .scene = &(setup)->scene, __VA_ARGS__};                          \
        bool created = renderer_create(&setup_params, &(setup)->r, &setup_err);                    \
        REQUIRE(created, "%s", setup_err.msg);                                                     \
    } while (0)
void setup_close(struct setup *setup); // also finishes the scene

// --- one kernel ----------------------------------------------------------------------------------

// Runs `kernel` over `items` items with renderer->push as it is, and waits.
bool run_kernel(struct renderer *r, const struct gpu_kernel *kernel, uint32_t items,
                struct err *err);

#endif
