// Counts what is to be flattened, and decides which meshes are shared. Part of flatten.c.
#ifndef LAMPYRIS_FLATTEN_FLATTEN_CENSUS_H
#define LAMPYRIS_FLATTEN_FLATTEN_CENSUS_H

#include "flatten/flatten.h"
#include "flatten/flatten_attributes.h"
#include "scene/core/bounds.h"

struct mesh_use {
    struct bounds bounds;   // bounds, in the mesh's own space, of all vertices that triangles use
    bool is_in_range;       // whether these vertices are within SCENE_COORDINATE_MAX
    bool may_be_shared;     // the mesh itself permits sharing
    bool is_shared;         // the instances that can share it do so
    uint32_t flat;          // index in flat_scene.meshes, if shared
    uint32_t sharing;       // number of instances that can share it
    uint32_t tangent_set;   // set of texture coordinates for tangents; SCENE_NONE: triangles differ
    uint32_t own_material;  // number of instances that do not override the material
    uint32_t skipped;       // number of instances with singular transforms
    uint32_t first_skipped; // index of the first such instance
};

enum instance_use { INSTANCE_SKIPPED, INSTANCE_HIDDEN, INSTANCE_FLATTENED, INSTANCE_SHARES };

struct census {
    struct mesh_use *meshes;
    uint8_t *instances;   // enum instance_use of each instance
    struct bounds bounds; // bounds of the world; not tight for shared meshes
    uint64_t world_triangle_count, shared_triangle_count;
    uint32_t shared_count; // number of shared meshes
    uint32_t placed_count; // number of instances of shared meshes
    struct attribute_needs needs;
    uint32_t skipped_instances;
};

// Returns whether all coordinates are within SCENE_COORDINATE_MAX.
bool flatten_in_range(const double point[3]);
// Returns whether triangles with the material are emitters.
bool flatten_emits(const struct scene *scene, uint32_t material);
// Returns whether a shape is a lamp to which shadow rays are sent. The light samples use the
// shape's centre and size, so its light is correct even if rounding moves the shape by more than
// its size.
bool flatten_is_lamp(const struct scene *scene, uint32_t kind, uint32_t material);
// Reports progress, a fraction in [0, 1]. Returns false with ERR_STOPPED if the work is to stop.
bool flatten_goes_on(const struct flatten_params *params, double fraction, struct err *err);
// Number of triangles between two polls.
#define FLATTEN_POLL 65536
// The overall progress, in [0, 1], when the census is finished.
#define FLATTEN_CENSUS_PART 0.4

// Takes the census; its arrays are allocated in `scratch`. Fails with ERR_BUDGET if the flat scene
// does not fit. Warns of singular transforms, and of meshes that single precision represents too
// coarsely.
bool flatten_take_census(const struct flatten_params *params, struct arena *scratch,
                         struct census *out, struct err *err);

// Checks the memory budget for all arrays of the flat scene, as far as the census knows them.
bool flatten_check_memory(const struct scene *scene, const struct census *census, struct err *err);

// Chooses the origin of the arrays: (0,0,0), or the centre of the bounds if they are small relative
// to their coordinates.
void flatten_choose_origin(const struct bounds *bounds, double origin[3]);
// Returns whether an object with these bounds is so far from the origin that single precision loses
// its form. Also computes its largest extent along an axis and its largest absolute coordinate.
bool flatten_is_coarse(const struct bounds *bounds, double *extent, double *farthest);
// Returns flat_scene.scale for these bounds; 1 if they are empty, or a point.
double flatten_choose_scale(const struct bounds *bounds);
// Fails with ERR_INPUT if these bounds are too large or too small.
bool flatten_check_extent(const struct scene *scene, const struct bounds *bounds, struct err *err);

#endif
