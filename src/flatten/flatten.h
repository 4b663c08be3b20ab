// From meshes, instances and shapes to the arrays that the BVH and the kernels take: single
// precision, in the world's space but for meshes that instances share, in a unit of length and
// about an origin that suit the scene. flat_from_world() is the one way there, flat_to_world() the
// way back.
#ifndef LAMPYRIS_FLATTEN_FLATTEN_H
#define LAMPYRIS_FLATTEN_FLATTEN_H

#include "scene/core/scene.h"

struct flat_triangle {
    float v[3][3]; // as flat_from_world() makes them
    uint32_t material;
};

// A triangle of a lamp that is too small for where it is: its corners, in single precision, say
// nothing of its form. Its edges do, from corner 0 to the others; and v[1] and v[2] are rounded
// away from v[0], so that the box of all three holds it.
struct flat_small_triangle {
    uint32_t triangle;
    float edges[2][3];
    // About the lamp's middle, in a unit of the lamp's own: by which it hides itself.
    float corner[3], own_edges[2][3];
    uint32_t lamp;
    // Among all small triangles, a lamp's beside each other: its place, and those of its lamp.
    uint32_t place, first, count;
};

// A struct shape in the flat scene's unit.
struct flat_shape {
    uint32_t kind; // enum shape_kind
    uint32_t material;
    float center[3]; // as flat_from_world() makes it; lengths in flat_scene's unit
    float normal[3];
    float radius;
    float axes[3][3];
    uint32_t sdf;
    uint32_t source; // of scene.shapes
};

// A mesh that its instances share: triangles in its own space, with an origin and a unit of length
// of its own, as the world has in struct flat_scene.
struct flat_mesh {
    uint32_t first_triangle, triangle_count;
    float bounds_min[3], bounds_max[3];
    bool is_own_material_used; // some instance has none in place of it
};

// One of them, placed.
struct flat_instance {
    uint32_t mesh;     // of flat_scene.meshes
    uint32_t material; // in place of the triangles' own; SCENE_NONE: these
    uint32_t source;   // of scene.instances
    bool is_mirrored;
    float to_world[3][4];  // from flat_scene.triangles to positions as of flat_from_world()
    float to_object[3][4]; // the inverse of the rounded to_world, rounded
};

// Which meshes are kept in their own space, once for all their instances:
// - auto: where copies would take 2^20 triangles or more in all, those of at least 12 triangles
// that
//   are used more than once; below that one level is built in seconds and is faster to trace;
// - on: all, those with one instance too;
// - off: none.
// Never shared are meshes that emit, since each of their triangles is an emitter of its own; and
// never by instances that make them emit, that squash or shear by more than about 1 : 4096, or that
// give a mesh without tangents a material with other texture coordinates for them. These are put
// into the world.
enum instancing { INSTANCING_AUTO, INSTANCING_ON, INSTANCING_OFF };

// A scene as arrays. Hidden instances and shapes are in none of the arrays and counts, but keep
// their indices in the scene.
struct flat_scene {
    // World position of the arrays' origin: geometry far from the world's origin is moved in double
    // precision before it is rounded (docs/verification.md, C2). (0,0,0) unless the scene needs it:
    // the middle of the bounding box when max |coordinate| exceeds 16 times its extent; and what
    // the camera sees best where that is more than 4096 times as far from there as it is large and
    // away.
    double origin[3];
    // Units of length of the arrays a metre: a power of two, so that it costs no bit. 1 unless the
    // scene's size demands another: see flatten_choose_scale().
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
    // In ascending order those of lamps that are small for where they are (flatten_lamps.h): what
    // they send goes by their areas and normals, which are lost where rounding changes these by
    // more than 2^-11.
    struct flat_small_triangle *small;
    uint32_t small_count;
    // The first ones are in the world; then come the shared meshes' own.
    uint32_t world_triangle_count;
    struct flat_mesh *meshes;
    uint32_t mesh_count;
    struct flat_instance *instances;
    uint32_t placed_count; // of `instances`
    struct flat_shape *shapes;
    uint32_t shape_count;
    // Where triangles come from: see flat_triangle_source.
    uint32_t instance_count;            // the scene's
    uint32_t *instance_first;           // of all triangles, dropped ones included; then of `meshes`
    uint32_t *dropped_before;           // dropped_degenerate of them: the triangle that came next
    bool *material_used;                // scene->material_count: some primitive has it
    float bounds_min[3], bounds_max[3]; // in the arrays' space; min > max when empty
    uint32_t dropped_degenerate;        // zero-area triangles left out (docs/verification.md, C6)
    uint32_t skipped_instances;         // singular transforms (docs/verification.md, C30)
};

struct flatten_params {
    const struct scene *scene;
    enum instancing instancing;
    const struct progress *progress; // phase "Flattening", of the calling thread
    // That looks at the scene, where its objects are too far apart for one origin; NULL: none.
    const struct camera *camera;
};

// The edges of a triangle from its corner 0 to the others, as exact as is known.
void flat_triangle_edges(const struct flat_scene *flat, uint32_t id, double edges[2][3]);
// Its entry in flat->small; NULL: it has none.
const struct flat_small_triangle *flat_find_small(const struct flat_scene *flat, uint32_t id);

// The instance that a flat triangle is of (SCENE_NONE: a shared mesh's), and which of its mesh's
// triangles it is.
void flat_triangle_source(const struct flat_scene *flat, uint32_t id, uint32_t *instance,
                          uint32_t *triangle);
// Finds the source of the k-th of those that were dropped.
void flat_dropped_source(const struct flat_scene *flat, uint32_t k, uint32_t *instance,
                         uint32_t *triangle);

// The flat triangles of an instance that is not kept apart in `instances`: so many from the first.
void flat_instance_triangles(const struct flat_scene *flat, uint32_t instance, uint32_t *first,
                             uint32_t *count);

// Equal where scene_flatten() would make the same of the scene as before, or fail again: a hash of
// all that it reads, of meshes' vertices and indices where they are instead of what they say. So
// for one scene, whose meshes stay as they were loaded; some GB/s of instances, shapes and
// triangles' materials. The camera does not count: coordinates stay about the place
// that it had when they were made.
uint64_t flatten_key(const struct flatten_params *params);

// Where a point of the world is in the arrays' space, before it is rounded, and the way back. `out`
// may be `point`.
void flat_from_world(const struct flat_scene *flat, const double point[3], double out[3]);
void flat_to_world(const struct flat_scene *flat, const double point[3], double out[3]);

// Memory comes from `arena`. A scene that is larger or smaller than SCENE_EXTENT_MAX and _MIN is
// ERR_INPUT; a vertex that is out of range after transformation likewise, naming instance, mesh and
// vertex; so is a transform that is not finite. Instances with singular transforms are
// left out, with one warning a mesh. Being asked to stop is ERR_STOPPED.
bool scene_flatten(const struct flatten_params *params, struct arena *arena, struct flat_scene *out,
                   struct err *err);

#endif
