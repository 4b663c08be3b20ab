// What the mesh loaders share. Internal to scene/.
#ifndef LAMPYRIS_SCENE_MESH_LOADER_H
#define LAMPYRIS_SCENE_MESH_LOADER_H

#include "scene.h"

// An arena for data that only the load needs, within what the scene's byte budget leaves.
struct arena mesh_scratch(const struct scene *scene);

// Writes the unit vector along `direction`, or (0,0,0), a missing normal, and false where that has
// no direction: zero or not finite.
bool mesh_unit_normal(const float direction[3], float out[3]);

// Sets *material to `given`, or to a new grey one when that is SCENE_NONE.
bool mesh_default_material(struct scene *scene, uint32_t given, uint32_t *material,
                           struct err *err);

// A list of triangles that grows in an arena.
struct triangle_list {
    struct arena *arena;
    uint32_t (*indices)[3];
    uint32_t count, capacity;
};

// ERR_SYSTEM when memory is out, ERR_INPUT beyond 2^32 - 1 triangles.
bool triangle_list_reserve(struct triangle_list *list, uint64_t capacity, struct err *err);
bool triangle_list_add(struct triangle_list *list, uint32_t a, uint32_t b, uint32_t c,
                       struct err *err);

// --- vertices from pairs of position and normal --------------------------------------------------

#define MESH_NO_NORMAL UINT32_MAX // a corner without a normal

struct vertex_pairs {
    uint32_t (*pairs)[2]; // of a position and a normal, for each vertex
    uint32_t count;
};

// Makes one vertex for each pair of position and normal that a corner uses, in the order of first
// use. In: `indices` of positions and `normal_indices`; out: `indices` of vertices. Memory comes
// from `scratch`.
bool mesh_pair_vertices(struct arena *scratch, uint64_t triangle_count, uint32_t (*indices)[3],
                        uint32_t (*normal_indices)[3], struct vertex_pairs *out, struct err *err);

// --- MTL -----------------------------------------------------------------------------------------

struct mtl_material {
    struct material material;
    uint32_t order;       // of definition: the first of two with one name counts
    uint32_t scene_index; // in the scene's materials; SCENE_NONE until a face uses it
};

// The materials of all MTL files of one OBJ file.
struct mtl_library {
    struct mtl_file *files; // that were read
    struct mtl_material *materials;
    uint32_t count, capacity;
};

// Appends the materials of an MTL file, unless it was read before (many OBJ files name theirs again
// and again); names and arrays live in `arena`. What is read:
//   Kd  base colour, default 0.5;  Ke  emitted radiance;  Ks  a mirror's reflectance, default 1
//   illum 5, and illum 3 with a black Kd: a perfect mirror; all other models are diffuse
// Colours outside [0, 1] are clamped and negative emission becomes 0, with one warning a file; so
// are spectral and XYZ colours and texture maps skipped. *hash goes on over the file's bytes.
// `path` lives as long as the library. *missing: there is no such file, or none that can be read.
// err is not NULL here.
bool load_mtl(struct arena *arena, const char *path, struct mtl_library *library, uint64_t *hash,
              bool *missing, struct err *err);

// Sorts the library by name for mtl_find.
void mtl_sort(struct mtl_library *library);
// NULL when there is none of that name.
struct mtl_material *mtl_find(const struct mtl_library *library, const char *name, size_t length);

#endif
