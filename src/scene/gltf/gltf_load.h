// State that the parts of the glTF loader share during loading. Internal to scene/.
#ifndef LAMPYRIS_SCENE_GLTF_GLTF_LOAD_H
#define LAMPYRIS_SCENE_GLTF_GLTF_LOAD_H

#include "scene/core/scene.h"
#include "scene/gltf/gltf_document.h"

// Counts of items that were omitted or approximated, for the scene's notes.
struct gltf_tally {
    uint32_t specular_glossy, coat_normals, anisotropic; // numbers of materials
    uint32_t translucent, translucent_volumes;
    uint32_t textures_without_image, mislabelled_images, singular_lights;
    uint32_t meshes_without_texcoords;
    uint32_t point_and_line_primitives, primitives_without_positions, primitives_without_material;
    uint32_t empty_primitives;
    uint32_t clamped_colors, infinite_texcoords; // numbers of colours, and of coordinates
    uint32_t ignored_channels, projective_joints, vertices_without_joints, instanced_skins;
    uint32_t orthographic_cameras, singular_cameras;
};

// The weights of a mesh's morph targets.
struct gltf_weights {
    const double *values;
    uint32_t count; // 0: all weights are 0
};

// The range of the scene's meshes that were made from one glTF mesh: one per primitive, except
// omitted ones.
struct gltf_mesh_range {
    bool is_loaded;
    bool is_counted; // included in loaded_meshes
    bool has_target_count;
    uint32_t target_count; // number of morph targets
    uint32_t first, count;
    struct gltf_weights weights; // the weights used for the conversion
};

// Vertex attributes.
enum gltf_attribute {
    GLTF_POSITION,
    GLTF_NORMAL,
    GLTF_TANGENT,
    GLTF_TEXCOORD,
    GLTF_COLOR,
    GLTF_ATTRIBUTE_COUNT,
};

// Arrays decoded from an accessor. Primitives with the same accessor share them.
struct gltf_vectors {
    float *values[GLTF_ATTRIBUTE_COUNT]; // NULL until the accessor is used as that attribute
    uint32_t count;                      // number of elements of each
};

struct gltf_node_pose;
struct gltf_skin;

struct gltf_load {
    struct scene *scene;
    struct gltf_document document;
    const struct progress *progress;
    uint32_t first_material;         // index in the scene of the file's material 0
    struct gltf_material *materials; // one for each of the file's materials, see gltf_material.h
    uint32_t variant;                // selected variant of materials; GLTF_NONE: none
    uint32_t default_material;       // for primitives without one; SCENE_NONE until it is needed
    struct gltf_mesh_range *meshes;  // one for each glTF mesh
    struct gltf_skin *skins;         // one for each skin; joints NULL: not read yet
    struct gltf_node_pose *poses;    // one for each node; NULL: there is no animation
    struct gltf_vectors *vectors;    // one for each accessor
    uint32_t loaded_meshes;
    struct gltf_tally tally;
};

// gltf_material.c: appends all materials of the file to the scene, without their textures.
bool gltf_materials_load(struct gltf_load *load, struct err *err);
// gltf_texture.c: decodes the images that used materials need, and adds textures to these
// materials.
bool gltf_textures_load(struct gltf_load *load, struct err *err);
// gltf_material_use.c: completes materials after all meshes and images were loaded.
bool gltf_materials_finish(struct gltf_load *load, struct err *err);

// gltf_variant.c: sets load->variant to the variant of KHR_materials_variants with this name; NULL:
// none. If there is no such variant, fails with ERR_USAGE, listing the variants of the file.
bool gltf_variant_find(struct gltf_load *load, const char *name, struct err *err);
// Finds a primitive's material in the selected variant and marks it as used; GLTF_NONE if it has
// none.
bool gltf_variant_material(struct gltf_load *load, const struct json_node *primitive,
                           uint32_t *material, struct err *err);

// gltf_light.c: adds the light of `holder`, a node.
bool gltf_light_load(struct gltf_load *load, const struct json_node *holder,
                     const double world[3][4], struct err *err);

// gltf_mesh.c: makes the scene's meshes for glTF mesh `index`, deformed by its morph targets with
// these weights, which must live as long as the document. If the weights are the same as in the
// last call for this mesh, returns that call's meshes again. A skin moves the meshes into the
// world; such meshes are always new. If `skin` is NULL, meshes stay in their own space.
bool gltf_mesh_load(struct gltf_load *load, uint32_t index, const struct gltf_weights *weights,
                    const struct gltf_skin *skin, struct gltf_mesh_range *out, struct err *err);

// A lower bound of the memory of a glTF mesh.
struct gltf_mesh_needs {
    uint64_t vertex_bytes;    // bytes needed once, because primitives share the accessors
    uint64_t primitive_bytes; // bytes needed each time the mesh is converted
    uint32_t count;           // number of meshes of the scene that it becomes
};
// `seen` has one element per accessor. Its bit 1 << GLTF_POSITION … is set if the accessor is
// already counted as that attribute.
struct gltf_mesh_needs gltf_mesh_count(const struct gltf_document *document, uint32_t index,
                                       uint8_t *seen);

// gltf_memory.c: checks a lower bound of the memory that the nodes of the scene need against the
// budget, before any node is loaded. Fails with ERR_BUDGET if it is exceeded, naming the first node
// that does not fit.
struct gltf_nodes;
bool gltf_check_memory(const struct gltf_load *load, const struct gltf_nodes *nodes,
                       struct err *err);

// gltf_instancing.c: returns the number of instances of the node's mesh by EXT_mesh_gpu_instancing;
// 1 without the extension, 0 if it cannot be read.
uint32_t gltf_instancing_count(const struct gltf_document *document, const struct json_node *node);
// Adds instances of the scene's meshes `meshes` at the transforms of the node's
// EXT_mesh_gpu_instancing, each followed by `world`. *found becomes true if the node has the
// extension.
bool gltf_instancing_load(struct gltf_load *load, const struct json_node *node,
                          const double world[3][4], struct gltf_mesh_range meshes, bool *found,
                          struct err *err);
bool gltf_instance_add(struct gltf_load *load, const double transform[3][4],
                       struct gltf_mesh_range meshes, struct err *err);

// load_gltf.c: loads a file whose bytes are in memory; load_gltf_into() loads one from disk.
struct gltf_load_params {
    struct gltf_source source;
    const double (*place)[4]; // 3x4, from the file's world to the scene's
    bool with_cameras;
    const char *variant; // this and the next three members are as in scene_load_params
    const double *at_seconds;
    const char *animation, *scene_name;
    const struct progress *progress; // NULL: no listener
};
bool gltf_load_bytes(struct scene *scene, const struct gltf_load_params *params, struct err *err);

#endif
