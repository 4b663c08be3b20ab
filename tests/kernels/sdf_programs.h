// Distance fields written by hand, for the tests of the kernels: every operation by itself, and
// trees of them.
#ifndef LAMPYRIS_TESTS_SDF_PROGRAMS_H
#define LAMPYRIS_TESTS_SDF_PROGRAMS_H

#include "kernel_fixture.h"
#include "scene/sdf/sdf_evaluate.h"
#include "shared/sdf.h"

#define SDF_TEST_CODE 40

struct sdf_program {
    const char *name;
    struct gpu_sdf_instruction code[SDF_TEST_CODE];
    uint32_t count;
    double half;      // half of its box's edges
    double magnitude; // 0: twice the box's half
    bool is_fractal;  // gradients depend on where they are taken
    bool is_cut;      // by its box: the surface is open there
};

extern const struct sdf_program sdf_programs[];
extern const uint32_t sdf_program_count;

uint32_t sdf_program_named(const char *name);

// How a field is placed: its origin in the world, and metres of the world a metre.
struct sdf_place {
    double center[3];
    double scale;
    double turn; // about the axis (1, 2, 3), radians
};

// Adds the program to the scene as a shape of material 0.
void add_sdf(struct scene *scene, const struct sdf_program *program, const struct sdf_place *place);

// A point of the world in the shape's own space. The shape is of kind SHAPE_SDF.
void sdf_into(const struct scene *scene, const struct shape *shape, const double point[3],
              double out[3]);
double sdf_scale(const struct scene *scene, const struct shape *shape);
// Unit, outwards, in double precision.
void sdf_normal(const struct sdf *sdf, const double point[3], double step, double out[3]);

#endif
