// Counts what is to be flattened, and decides which meshes are shared. Part of flatten.c.
#ifndef LAMPYRIS_FLATTEN_FLATTEN_CENSUS_H
#define LAMPYRIS_FLATTEN_FLATTEN_CENSUS_H

#include "flatten/flatten.h"
#include "flatten/flatten_attributes.h"
#include "scene/core/bounds.h"

struct mesh_use {
    struct bounds bounds;   // in its own space, of the vertices that triangles use
    bool is_in_range;       // each of these
    bool may_be_shared;     // whatever its instances are like
    bool is_shared;         // by the instances that can share it
    uint32_t flat;          // shared: its index of flat_scene.meshes
    uint32_t sharing;       // instances that can share it
    uint32_t tangent_set;   // set for the tangents of all its triangles; SCENE_NONE: they differ
    uint32_t own_material;  // instances of it without a material of theirs
    uint32_t skipped;       // instances with singular transforms
    uint32_t first_skipped; // the first one of them
};

enum instance_use { INSTANCE_SKIPPED, INSTANCE_HIDDEN, INSTANCE_FLATTENED, INSTANCE_SHARES };

struct census {
    struct mesh_use *meshes;
    uint8_t *instances;   // enum instance_use
    struct bounds bounds; // bounds of everything in the world; not tight for shared meshes
    uint64_t world_triangle_count, shared_triangle_count;
    uint32_t shared_count; // meshes
    uint32_t placed_count; // instances of them
    struct attribute_needs needs;
    uint32_t skipped_instances;
};

// Returns whether all coordinates are within SCENE_COORDINATE_MAX.
bool flatten_in_range(const double point[3]);
// Returns whether each triangle of the material has to be an emitter of its own.
bool flatten_emits(const struct scene *scene, uint32_t material);
// Returns whether shadow rays are sent to a shape, which is known by its middle and its size: where
// it is so small that rounding moves it by more than that, the light that it sends is right.
bool flatten_is_lamp(const struct scene *scene, uint32_t kind, uint32_t material);
// Reports a fraction and returns whether to continue; false with an error if not.
bool flatten_goes_on(const struct flatten_params *params, double fraction, struct err *err);
// Triangles between two polls.
#define FLATTEN_POLL 65536
// The progress when the census is finished.
#define FLATTEN_CENSUS_PART 0.4

// Takes the census. Arrays come from `scratch`. ERR_BUDGET if the flat scene does not fit. Warns of
// singular transforms and of meshes beyond their precision.
bool flatten_take_census(const struct flatten_params *params, struct arena *scratch,
                         struct census *out, struct err *err);

// Checks the memory budget for all arrays of the flat scene, as far as the census knows them.
bool flatten_check_memory(const struct scene *scene, const struct census *census, struct err *err);

// Chooses the origin of the arrays for these bounds: (0,0,0), or their centre if they are small
// relative to their coordinates.
void flatten_choose_origin(const struct bounds *bounds, double origin[3]);
// Returns whether single precision resolves something with these bounds in so few steps that its
// form is lost; with its largest extent along an axis and its largest coordinate.
bool flatten_is_coarse(const struct bounds *bounds, double *extent, double *farthest);
// Returns the scale for these bounds: see flat_scene.scale. 1 if they are empty, or a point.
double flatten_choose_scale(const struct bounds *bounds);
// Fails if these bounds are too large or too small.
bool flatten_check_extent(const struct scene *scene, const struct bounds *bounds, struct err *err);

#endif
