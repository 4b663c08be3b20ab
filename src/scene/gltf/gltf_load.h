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
    uint32_t clamped_colors, infinite_texcoords; // numbers of vertices, and of texture coordinates
    uint32_t ignored_channels, projective_joints, vertices_without_joints, instanced_skins;
    uint32_t orthographic_cameras, singular_cameras;
};

// The weights of a mesh's morph targets.
struct gltf_weights {
    const double *values;
    uint32_t count; // 0: all weights are 0
};

// The scene's meshes that were made from one glTF mesh: one per primitive, except omitted ones.
struct gltf_mesh_range {
    bool is_loaded;
    bool is_counted; // it is included in loaded_meshes
    bool has_target_count;
    uint32_t target_count; // number of morph targets
    uint32_t first, count;
    struct gltf_weights weights; // the weights with which they were converted
};

// The attributes that vertices carry.
enum gltf_attribute {
    GLTF_POSITION,
    GLTF_NORMAL,
    GLTF_TANGENT,
    GLTF_TEXCOORD,
    GLTF_COLOR,
    GLTF_ATTRIBUTE_COUNT,
};

// Arrays that were decoded from an accessor. Primitives that share the accessor share the array.
struct gltf_vectors {
    float *values[GLTF_ATTRIBUTE_COUNT]; // NULL until it is used as that attribute
    uint32_t count;                      // number of elements of each
};

struct gltf_node_pose;
struct gltf_skin;

struct gltf_load {
    struct scene *scene;
    struct gltf_document document;
    const struct progress *progress;
    uint32_t first_material;         // the scene's index of the file's material 0
    struct gltf_material *materials; // one for each of the file's, see gltf_material.h
    uint32_t variant;                // selected variant of materials; GLTF_NONE: none
    uint32_t default_material;       // material of primitives without one; SCENE_NONE until it is
                                     // needed
    struct gltf_mesh_range *meshes;  // one for each glTF mesh
    struct gltf_skin *skins;         // one for each of the file's; joints NULL: not read yet
    struct gltf_node_pose *poses;    // one for each node; NULL: there is no animation
    struct gltf_vectors *vectors;    // one for each accessor
    uint32_t loaded_meshes;
    struct gltf_tally tally;
};

// gltf_material.c: appends all materials of the file to the scene, without their textures.
bool gltf_materials_load(struct gltf_load *load, struct err *err);
// gltf_texture.c: decodes the images of the materials in use, and adds the textures to these.
bool gltf_textures_load(struct gltf_load *load, struct err *err);
// gltf_material_use.c: completes materials after all meshes and images were loaded.
bool gltf_materials_finish(struct gltf_load *load, struct err *err);

// gltf_variant.c: sets load->variant to the variant of KHR_materials_variants with this name; NULL:
// none. ERR_USAGE lists the variants of the file.
bool gltf_variant_find(struct gltf_load *load, const char *name, struct err *err);
// Finds a primitive's material in the selected variant and marks it as used; GLTF_NONE: none.
bool gltf_variant_material(struct gltf_load *load, const struct json_node *primitive,
                           uint32_t *material, struct err *err);

// gltf_light.c: adds the light of `holder`, a node.
bool gltf_light_load(struct gltf_load *load, const struct json_node *holder,
                     const double world[3][4], struct err *err);

// gltf_mesh.c: makes the scene's meshes for glTF mesh `index`, with its morph targets by these
// weights, which must live as long as the document. Returns the meshes of the last call for this
// mesh again if the weights are the same. skin: moves the meshes into the world; such meshes are
// always new. NULL: they stay in their own space.
bool gltf_mesh_load(struct gltf_load *load, uint32_t index, const struct gltf_weights *weights,
                    const struct gltf_skin *skin, struct gltf_mesh_range *out, struct err *err);

// A lower bound of the memory of a glTF mesh.
struct gltf_mesh_needs {
    uint64_t vertex_bytes;    // once, because primitives share the accessors
    uint64_t primitive_bytes; // each time that it is converted
    uint32_t count;           // number of the scene's meshes that it becomes
};
// `seen` has a bit for each attribute as which an accessor is counted already, one element per
// accessor.
struct gltf_mesh_needs gltf_mesh_count(const struct gltf_document *document, uint32_t index,
                                       uint8_t *seen);

// gltf_memory.c: checks the memory budget against a lower bound of what the nodes of the scene
// need, before any is loaded. ERR_BUDGET, with the first node that does not fit, if it is exceeded.
struct gltf_nodes;
bool gltf_check_memory(const struct gltf_load *load, const struct gltf_nodes *nodes,
                       struct err *err);

// gltf_instancing.c: returns the number of instances of the node's mesh by EXT_mesh_gpu_instancing;
// 1 without the extension, 0 if it cannot be read.
uint32_t gltf_instancing_count(const struct gltf_document *document, const struct json_node *node);
// Adds instances of the scene's meshes `meshes` at the transforms of the node's
// EXT_mesh_gpu_instancing, each applied before `world`. *found: the node has the extension.
bool gltf_instancing_load(struct gltf_load *load, const struct json_node *node,
                          const double world[3][4], struct gltf_mesh_range meshes, bool *found,
                          struct err *err);
bool gltf_instance_add(struct gltf_load *load, const double transform[3][4],
                       struct gltf_mesh_range meshes, struct err *err);

// load_gltf.c: loads a file whose bytes are in memory, as load_gltf_into does for a file on disk.
struct gltf_load_params {
    struct gltf_source source;
    const double (*place)[4]; // 3x4, from the file's world to the scene's
    bool with_cameras;
    const char *variant;      // as in scene_load_params
    const double *at_seconds; // these three are as in scene_load_params
    const char *animation, *scene_name;
    const struct progress *progress; // NULL: no listener
};
bool gltf_load_bytes(struct scene *scene, const struct gltf_load_params *params, struct err *err);

#endif
