// Flattens a scene: converts meshes, instances and shapes to the arrays that the BVH and the
// kernels need. They are in single precision, in world space except for meshes that instances
// share, and in coordinates whose unit of length and origin suit the scene. flat_from_world()
// converts positions to these coordinates, flat_to_world() converts back.
#ifndef LAMPYRIS_FLATTEN_FLATTEN_H
#define LAMPYRIS_FLATTEN_FLATTEN_H

#include "scene/core/scene.h"

struct flat_triangle {
    float v[3][3]; // in the coordinates of flat_from_world()
    uint32_t material;
};

// A triangle of a lamp that is so small relative to its coordinates that its corners, in single
// precision, do not represent its form. Its edges from corner 0 are stored here. The corners v[1]
// and v[2] in flat_scene.triangles are rounded away from v[0], so that the bounding box of v
// contains the exact triangle.
struct flat_small_triangle {
    uint32_t triangle;
    float edges[2][3];
    // Coordinates relative to the lamp's centre, in the lamp's own unit, for occlusion by the lamp
    // itself.
    float corner[3], own_edges[2][3];
    uint32_t lamp;
    // Index among the small triangles sorted by lamp, and the index of the first triangle and the
    // number of triangles of its lamp.
    uint32_t place, first, count;
};

// A struct shape in the arrays' coordinates and unit.
struct flat_shape {
    uint32_t kind; // enum shape_kind
    uint32_t material;
    float center[3]; // in the coordinates of flat_from_world(); lengths are in the arrays' unit
    float normal[3];
    float radius;
    float axes[3][3];
    uint32_t sdf;
    uint32_t source; // index in scene.shapes
};

// A mesh that instances share. Its triangles are in the mesh's own space, with an origin and a unit
// of length like those of struct flat_scene.
struct flat_mesh {
    uint32_t first_triangle, triangle_count;
    float bounds_min[3], bounds_max[3];
    bool is_own_material_used; // whether some instance does not override it
};

// An instance of a shared mesh.
struct flat_instance {
    uint32_t mesh;     // index in flat_scene.meshes
    uint32_t material; // replaces the triangles' materials; SCENE_NONE: none
    uint32_t source;   // index in scene.instances
    bool is_mirrored;
    float to_world[3][4];  // from flat_scene.triangles to the coordinates of flat_from_world()
    float to_object[3][4]; // inverse of the rounded to_world, rounded
};

// Selects the meshes that are shared, that is, stored once, in their own space, for all their
// instances:
// - auto: meshes of at least 12 triangles with more than one instance, if copies would take 2^20
//   triangles or more in all; smaller scenes are built in seconds with one level, which is faster
//   to trace;
// - on: all meshes, including those with one instance;
// - off: none.
// Emissive meshes are never shared, because each of their triangles is an emitter of its own. An
// instance does not share its mesh if its material makes the mesh emissive, if its transform
// squashes or shears the mesh by more than about 1:4096, or if the mesh has no tangents and the
// instance's material derives them from another set of texture coordinates. Such instances are
// flattened into world space.
enum instancing { INSTANCING_AUTO, INSTANCING_ON, INSTANCING_OFF };

// A scene as arrays. Hidden instances and shapes are omitted from all arrays and counts, but keep
// their indices in the scene.
struct flat_scene {
    // World position of the arrays' origin. Geometry far from the world's origin is translated in
    // double precision before it is rounded (docs/verification.md, C2). The origin is (0,0,0), or
    // if max |coordinate| exceeds 16 times the scene's extent, the centre of the bounding box. If
    // that origin is too far from the object that the camera resolves best (more than 4096 times
    // the greater of the object's size and its distance from the camera), the origin is at this
    // object.
    double origin[3];
    // Units of length of the arrays per metre: a power of two, so that scaling is exact. 1 unless
    // the scene's size requires another one: see flatten_choose_scale().
    double scale;
    struct flat_triangle *triangles;
    // Unit normals, per triangle and corner; NULL when no mesh has normals. A normal that is
    // missing or not finite is replaced by the geometric one. They are transformed by the inverse
    // transpose.
    float (*normals)[3][3];
    // Other attributes, per triangle and corner; NULL if no used material needs them, or no mesh
    // has them. A tangent is a unit vector, not always orthogonal to the normal, followed by a
    // sign; the bitangent is sign * cross(normal, tangent). If a mesh has no tangents, they point
    // in the direction of increasing u, or in an arbitrary direction if the texture coordinates do
    // not define one.
    float (*tangents)[3][4];
    float (*uvs[2])[3][2]; // finite, 0 if missing; t points down
    float (*colors)[3][4]; // linear RGBA, 1 if missing
    uint32_t triangle_count;
    // Triangles, in ascending order, of lamps that are small relative to their coordinates
    // (flatten_lamps.h). Their light depends on areas and normals, which rounding to single
    // precision would change by a relative error of more than 2^-11.
    struct flat_small_triangle *small;
    uint32_t small_count;
    // The first triangles are in world space; those of shared meshes follow.
    uint32_t world_triangle_count;
    struct flat_mesh *meshes;
    uint32_t mesh_count;
    struct flat_instance *instances;
    uint32_t placed_count; // length of `instances`
    struct flat_shape *shapes;
    uint32_t shape_count;
    // The following members say where in the scene each triangle comes from: see
    // flat_triangle_source().
    uint32_t instance_count; // number of instances in the scene
    // For each instance, then for each entry of `meshes`: the number of triangles, including
    // dropped ones, of all entries before it.
    uint32_t *instance_first;
    uint32_t *dropped_before; // for each dropped triangle, the flat triangle that follows it
    bool *material_used;      // for each material of the scene, whether a primitive has it
    float bounds_min[3], bounds_max[3]; // in the arrays' coordinates; min > max if empty
    uint32_t dropped_degenerate;        // triangles without area (docs/verification.md, C6)
    uint32_t skipped_instances; // those with singular transforms (docs/verification.md, C30)
};

struct flatten_params {
    const struct scene *scene;
    enum instancing instancing;
    const struct progress *progress; // its phase is "Flattening"
    // The camera, by which the origin is chosen if the scene's objects are too far apart for one
    // origin; NULL: none.
    const struct camera *camera;
};

// Computes the edges of a triangle from its corner 0, from the exact edges if it is a small
// triangle of a lamp.
void flat_triangle_edges(const struct flat_scene *flat, uint32_t id, double edges[2][3]);
// Returns the triangle's entry in flat->small; NULL if it has none.
const struct flat_small_triangle *flat_find_small(const struct flat_scene *flat, uint32_t id);

// Finds the instance of a flat triangle (SCENE_NONE if it belongs to a shared mesh), and the
// triangle's index in the mesh.
void flat_triangle_source(const struct flat_scene *flat, uint32_t id, uint32_t *instance,
                          uint32_t *triangle);
// Finds the instance and the triangle of the k-th dropped triangle.
void flat_dropped_source(const struct flat_scene *flat, uint32_t k, uint32_t *instance,
                         uint32_t *triangle);

// Finds the range of flat triangles of an instance that does not share its mesh.
void flat_instance_triangles(const struct flat_scene *flat, uint32_t instance, uint32_t *first,
                             uint32_t *count);

// Returns a hash of all input of scene_flatten() except the camera; if two hashes are equal, so are
// the results. Vertices and indices of meshes are hashed by their addresses, so hashes are only
// comparable for one scene, whose meshes stay as they were loaded. The function processes some GB/s
// of instances, shapes and triangles' materials. Moving the camera does not change the hash. The
// coordinates keep the origin that was chosen for its earlier position.
uint64_t flatten_key(const struct flatten_params *params);

// Convert a point of the world to the arrays' coordinates, before rounding, and back. `out` may be
// `point`.
void flat_from_world(const struct flat_scene *flat, const double point[3], double out[3]);
void flat_to_world(const struct flat_scene *flat, const double point[3], double out[3]);

// Flattens a scene. The arrays are allocated in `arena`. Fails with ERR_INPUT if the scene's extent
// exceeds SCENE_EXTENT_MAX or is below SCENE_EXTENT_MIN, if a vertex is out of range after
// transformation (the message names instance, mesh and vertex), or if a transform is not finite.
// Instances with singular transforms are omitted, with one warning per mesh. Fails with ERR_STOPPED
// when stopped.
bool scene_flatten(const struct flatten_params *params, struct arena *arena, struct flat_scene *out,
                   struct err *err);

#endif
