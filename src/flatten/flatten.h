// Converts meshes, instances and shapes to the arrays that the BVH and the kernels take: in single
// precision, in world space except for meshes that instances share, and with a unit of length and
// an origin that suit the scene. flat_from_world() converts positions to these coordinates,
// flat_to_world() converts back.
#ifndef LAMPYRIS_FLATTEN_FLATTEN_H
#define LAMPYRIS_FLATTEN_FLATTEN_H

#include "scene/core/scene.h"

struct flat_triangle {
    float v[3][3]; // in the coordinates of flat_from_world()
    uint32_t material;
};

// A triangle of a lamp that is so small relative to its coordinates that its corners, in single
// precision, do not represent its form. Its edges from corner 0 to the others do; v[1] and v[2] are
// rounded away from v[0], so that the box of all three contains it.
struct flat_small_triangle {
    uint32_t triangle;
    float edges[2][3];
    // About the lamp's centre, in a unit of the lamp's own, for its self-occlusion.
    float corner[3], own_edges[2][3];
    uint32_t lamp;
    // Its index among all small triangles, where those of a lamp are adjacent, and the range of its
    // lamp.
    uint32_t place, first, count;
};

// A struct shape in the flat scene's unit.
struct flat_shape {
    uint32_t kind; // enum shape_kind
    uint32_t material;
    float center[3]; // in the coordinates of flat_from_world(); lengths are in flat_scene's unit
    float normal[3];
    float radius;
    float axes[3][3];
    uint32_t sdf;
    uint32_t source; // index in scene.shapes
};

// A mesh that its instances share: triangles in its own space, with an origin and a unit of length
// of its own, like those of the world in struct flat_scene.
struct flat_mesh {
    uint32_t first_triangle, triangle_count;
    float bounds_min[3], bounds_max[3];
    bool is_own_material_used; // some instance has none in place of it
};

// An instance of such a mesh.
struct flat_instance {
    uint32_t mesh;     // index in flat_scene.meshes
    uint32_t material; // replaces the triangles' own; SCENE_NONE: does not
    uint32_t source;   // index in scene.instances
    bool is_mirrored;
    float to_world[3][4];  // from flat_scene.triangles to the coordinates of flat_from_world()
    float to_object[3][4]; // the inverse of the rounded to_world, rounded
};

// Which meshes are kept in their own space, once for all their instances:
// - auto: where copies would take 2^20 triangles or more in all, those of at least 12 triangles
// that
//   are used more than once; below that one level is built in seconds and is faster to trace;
// - on: all, those with one instance too;
// - off: none.
// Meshes that emit are never shared, since each of their triangles is an emitter of its own; nor do
// instances share a mesh if they make it emit, squash or shear it by more than about 1 : 4096, or
// give a mesh without tangents a material with other texture coordinates for them. These are placed
// in the world.
enum instancing { INSTANCING_AUTO, INSTANCING_ON, INSTANCING_OFF };

// A scene as arrays. Hidden instances and shapes are in none of the arrays and counts, but keep
// their indices in the scene.
struct flat_scene {
    // World position of the arrays' origin: geometry far from the world's origin is translated in
    // double precision before it is rounded (docs/verification.md, C2). (0,0,0) unless the scene
    // needs another: the centre of the bounding box when max |coordinate| exceeds 16 times its
    // extent; or the object that the camera sees best, if that is more than 4096 times as far from
    // that origin as its size and its distance from the camera.
    double origin[3];
    // Units of length of the arrays per metre: a power of two, so that scaling is exact. 1 unless
    // the scene's size requires another: see flatten_choose_scale().
    double scale;
    struct flat_triangle *triangles;
    float (*normals)[3][3]; // per triangle and corner; NULL when no mesh has normals. Where one is
                            // missing or not finite: the geometric normal. Transformed by the
                            // inverse transpose.
    // Further attributes, per triangle and corner; NULL when no used material needs them, or no
    // mesh has them.
    float (*tangents)[3][4]; // unit, not always orthogonal to the normal, and the sign of the
                             // bitangent sign * cross(normal, tangent). Where a mesh has none:
                             // along growing u, or any where that has no direction either
    float (*uvs[2])[3][2];   // finite, 0 where missing; t downwards
    float (*colors)[3][4];   // linear RGBA, 1 where missing
    uint32_t triangle_count;
    // The triangles, in ascending order, of lamps that are small relative to their coordinates
    // (flatten_lamps.h): their light depends on their areas and normals, which rounding would
    // change by more than 2^-11.
    struct flat_small_triangle *small;
    uint32_t small_count;
    // The first ones are in the world; those of shared meshes follow.
    uint32_t world_triangle_count;
    struct flat_mesh *meshes;
    uint32_t mesh_count;
    struct flat_instance *instances;
    uint32_t placed_count; // number of `instances`
    struct flat_shape *shapes;
    uint32_t shape_count;
    // The origin of triangles: see flat_triangle_source.
    uint32_t instance_count;            // the scene's
    uint32_t *instance_first;           // for all triangles, including dropped ones; then for
                                        // `meshes`
    uint32_t *dropped_before;           // dropped_degenerate of them: the triangle that came next
    bool *material_used;                // scene->material_count: some primitive has it
    float bounds_min[3], bounds_max[3]; // in the arrays' coordinates; min > max when empty
    uint32_t dropped_degenerate;        // zero-area triangles left out (docs/verification.md, C6)
    uint32_t skipped_instances;         // singular transforms (docs/verification.md, C30)
};

struct flatten_params {
    const struct scene *scene;
    enum instancing instancing;
    const struct progress *progress; // phase "Flattening", of the calling thread
    // The camera of the view, for scenes whose objects are too far apart for one origin; NULL:
    // none.
    const struct camera *camera;
};

// Computes the edges of a triangle from its corner 0 to the others, as exactly as they are known.
void flat_triangle_edges(const struct flat_scene *flat, uint32_t id, double edges[2][3]);
// Returns its entry in flat->small; NULL if it has none.
const struct flat_small_triangle *flat_find_small(const struct flat_scene *flat, uint32_t id);

// Finds the instance of a flat triangle (SCENE_NONE: it belongs to a shared mesh), and its index in
// its mesh.
void flat_triangle_source(const struct flat_scene *flat, uint32_t id, uint32_t *instance,
                          uint32_t *triangle);
// Finds the source of the k-th of those that were dropped.
void flat_dropped_source(const struct flat_scene *flat, uint32_t k, uint32_t *instance,
                         uint32_t *triangle);

// Finds the range of flat triangles of an instance that is not in `instances`.
void flat_instance_triangles(const struct flat_scene *flat, uint32_t instance, uint32_t *first,
                             uint32_t *count);

// Returns a hash of everything that scene_flatten() reads, which is equal if it would give the same
// result, or fail, again. Vertices and indices of meshes enter by their addresses. So it is valid
// for one scene, whose meshes stay as they were loaded; it processes some GB/s of instances, shapes
// and triangles' materials. The camera is not included: coordinates stay relative to its position
// when they were made.
uint64_t flatten_key(const struct flatten_params *params);

// Convert a point of the world to the arrays' coordinates, before rounding, and back. `out` may be
// `point`.
void flat_from_world(const struct flat_scene *flat, const double point[3], double out[3]);
void flat_to_world(const struct flat_scene *flat, const double point[3], double out[3]);

// Flattens a scene into memory of `arena`. ERR_INPUT if the scene is larger or smaller than
// SCENE_EXTENT_MAX and _MIN, if a vertex is out of range after transformation, naming instance,
// mesh and vertex, or if a transform is not finite. Instances with singular transforms are omitted,
// with one warning per mesh. ERR_STOPPED when stopped.
bool scene_flatten(const struct flatten_params *params, struct arena *arena, struct flat_scene *out,
                   struct err *err);

#endif
