// Declarations that the mesh loaders share. Internal to scene/.
#ifndef LAMPYRIS_SCENE_MESH_MESH_LOADER_H
#define LAMPYRIS_SCENE_MESH_MESH_LOADER_H

#include "scene/core/scene.h"
#include "scene/core/text.h"

// Reads a file into `scratch` and continues the scene's hash over its bytes.
bool mesh_open(struct scene *scene, struct arena *scratch, const char *path,
               struct text_reader *out, struct err *err);

// Computes the unit vector along `direction`. If `direction` is zero or not finite, writes (0,0,0),
// which means that the normal is missing, and returns false.
bool mesh_unit_normal(const float direction[3], float out[3]);

// Sets *material to `given`, or if `given` is SCENE_NONE, to a new material. The new material is
// grey, or white if the vertices have colours, which scale it.
bool mesh_default_material(struct scene *scene, uint32_t given, bool has_colors, uint32_t *material,
                           struct err *err);

// Returns whether single precision loses details of a mesh: it is farther from its origin than 16
// times its size, or one of its triangles is farther than 2^16 times the triangle's size. Uses the
// exact positions if there are any.
bool mesh_is_rounded(const struct mesh *mesh);
// Stores the exact positions of a mesh's vertices if single precision loses details of it and the
// exact positions differ from the rounded ones.
void mesh_keep_exact(struct mesh *mesh, double (*exact)[3]);

// A list of triangles that grows in an arena.
struct triangle_list {
    struct arena *arena;
    uint32_t (*indices)[3];
    uint32_t count, capacity;
};

// Reserves room for `capacity` triangles. Fails with ERR_SYSTEM when out of memory, with ERR_INPUT
// above 2^32 - 1 triangles.
bool triangle_list_reserve(struct triangle_list *list, uint64_t capacity, struct err *err);
bool triangle_list_add(struct triangle_list *list, uint32_t a, uint32_t b, uint32_t c,
                       struct err *err);

// --- vertices from corners -----------------------------------------------------------------------

// The index of a corner without a normal, or without texture coordinates.
#define MESH_NO_INDEX UINT32_MAX

struct vertex_list {
    uint32_t (*corners)[3]; // position, normal and texture coordinates of each vertex
    uint32_t count;
};

// Makes one vertex for each distinct combination of position, normal and texture coordinates, in
// the order of first use. On entry `indices` are those of positions, and the other two arrays may
// be NULL; on return `indices` are those of vertices. Memory comes from `scratch`.
bool mesh_merge_corners(struct arena *scratch, uint64_t triangle_count, uint32_t (*indices)[3],
                        uint32_t (*normal_indices)[3], uint32_t (*uv_indices)[3],
                        struct vertex_list *out, struct err *err);

// --- MTL -----------------------------------------------------------------------------------------

// A texture of a material, loaded when the first face uses the material.
struct mtl_map {
    const char *path; // as written in the file; NULL: no texture
    uint64_t line;
    float offset[2], scale[2];
    float bump_scale; // option -bm
    bool is_clamped;
};

enum mtl_map_kind {
    MTL_MAP_DIFFUSE,   // map_Kd
    MTL_MAP_EMISSION,  // map_Ke
    MTL_MAP_OPACITY,   // map_d
    MTL_MAP_ROUGHNESS, // map_Pr
    MTL_MAP_METALLIC,  // map_Pm
    MTL_MAP_BUMP,      // map_Bump, bump: only used if it contains normals
    MTL_MAP_NORMAL,    // norm
    MTL_MAP_COUNT,
};

struct mtl_material {
    struct material material;
    struct mtl_map maps[MTL_MAP_COUNT];
    const char *file;     // the file that defines the material
    uint32_t order;       // position in the library before sorting; of several materials with one
                          // name, the first is used
    uint32_t scene_index; // index in the scene's materials; SCENE_NONE until a face uses it
};

// The materials of all MTL files of one OBJ file.
struct mtl_library {
    struct mtl_file *files; // the files that were read
    struct mtl_material *materials;
    uint32_t count, capacity;
};

// Appends the materials of an MTL file unless it was read before, because many OBJ files name a
// library repeatedly. Names and arrays live in `arena`. mtl_material.c describes which statements
// make which material. Colours outside [0, 1] are clamped, negative emission becomes 0, and
// spectral and XYZ colours and unknown maps are skipped, with one warning of each kind per file.
// The file's bytes are added to *hash. `path` must live as long as the library. *missing becomes
// true if the file does not exist or cannot be read. `err` must not be NULL.
bool load_mtl(struct arena *arena, const char *path, struct mtl_library *library, uint64_t *hash,
              bool *missing, struct err *err);

// The statements of one material. mtl_statements_init() sets the values for statements that the
// file does not have: a default, or -1.
struct mtl_statements {
    const char *name; // NULL before the first newmtl
    float diffuse[3], specular[3], ambient[3], emission[3], filter[3]; // Kd Ks Ka Ke Tf
    float exponent, opacity, ior;                                      // Ns d Ni
    float roughness, metallic, sheen;                                  // Pr Pm Ps
    float coat, coat_roughness, anisotropy, anisotropy_rotation;       // Pc Pcr aniso anisor
    int64_t illumination_model;                                        // -1: not given
    struct mtl_map maps[MTL_MAP_COUNT];
};
void mtl_statements_init(struct mtl_statements *statements, const char *name);
// mtl_material.c: makes a material from its statements.
void mtl_material_make(const struct mtl_statements *statements, struct material *out);
// Adds a library's material and its textures to the scene. An image that cannot be read is replaced
// by pink; in a strict scene, it is an error. `allow_outside` permits files outside the MTL file's
// folder.
bool mtl_material_add(struct scene *scene, struct mtl_material *wanted, bool allow_outside,
                      struct err *err);

// Sorts the library by name for mtl_find.
void mtl_sort(struct mtl_library *library);
// Returns the material with that name, or NULL.
struct mtl_material *mtl_find(const struct mtl_library *library, const char *name, size_t length);

#endif
