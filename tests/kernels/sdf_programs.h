// Distance fields written by hand for the tests of kernels: every operation alone, and trees of
// operations.
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
    double half;      // half the length of its box's edges
    double magnitude; // 0: twice `half`
    bool is_fractal;  // gradients depend on the place at which they are computed
    bool is_cut;      // its box cuts the surface, which is open there
};

extern const struct sdf_program sdf_programs[];
extern const uint32_t sdf_program_count;

uint32_t sdf_program_named(const char *name);

// The placement of a field: its origin in world space, and world metres per metre of the field.
struct sdf_place {
    double center[3];
    double scale;
    double turn; // rotation about the axis (1, 2, 3), in radians
};

// Adds the program to the scene as a shape with material 0.
void add_sdf(struct scene *scene, const struct sdf_program *program, const struct sdf_place *place);

// Transforms a point from world space to the shape's space. The shape has the kind SHAPE_SDF.
void sdf_into(const struct scene *scene, const struct shape *shape, const double point[3],
              double out[3]);
double sdf_scale(const struct scene *scene, const struct shape *shape);
// Computes the unit normal, outwards, in double precision.
void sdf_normal(const struct sdf *sdf, const double point[3], double step, double out[3]);

#endif
