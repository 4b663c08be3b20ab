// State that the parts of the glTF loader share while a file is loaded. Internal to scene/.
#ifndef LAMPYRIS_SCENE_GLTF_GLTF_LOAD_H
#define LAMPYRIS_SCENE_GLTF_GLTF_LOAD_H

#include "scene/core/scene.h"
#include "scene/gltf/gltf_document.h"

// Counts of what was left out or approximated, for the scene's notes.
struct gltf_tally {
    uint32_t specular_glossy, coat_normals, anisotropic; // materials
    uint32_t translucent, translucent_volumes;
    uint32_t textures_without_image, mislabelled_images, singular_lights;
    uint32_t meshes_without_texcoords;
    uint32_t point_and_line_primitives, primitives_without_positions, primitives_without_material;
    uint32_t empty_primitives;
    uint32_t clamped_colors, infinite_texcoords; // vertices, numbers
    uint32_t ignored_channels, projective_joints, vertices_without_joints, instanced_skins;
    uint32_t orthographic_cameras, singular_cameras;
};

// The weights of a mesh's morph targets.
struct gltf_weights {
    const double *values;
    uint32_t count; // 0: none has any weight
};

// The scene's meshes that came from one glTF mesh: one a primitive, but for those left out.
struct gltf_mesh_range {
    bool is_loaded;
    bool is_counted; // in loaded_meshes
    bool has_target_count;
    uint32_t target_count; // of morph targets
    uint32_t first, count;
    struct gltf_weights weights; // that they were converted with
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

// Arrays decoded from an accessor. Primitives that share the accessor share the array.
struct gltf_vectors {
    float *values[GLTF_ATTRIBUTE_COUNT]; // NULL until wanted as that
    uint32_t count;                      // elements of each
};

struct gltf_node_pose;
struct gltf_skin;

struct gltf_load {
    struct scene *scene;
    struct gltf_document document;
    const struct progress *progress;
    uint32_t first_material;         // the scene's index of the file's material 0
    struct gltf_material *materials; // one for each of the file's, see gltf_material.h
    uint32_t variant;                // of materials; GLTF_NONE: primitives have their own
    uint32_t default_material;       // of primitives without one; SCENE_NONE until needed
    struct gltf_mesh_range *meshes;  // one for each glTF mesh
    struct gltf_skin *skins;         // one for each of the file's; joints NULL: not asked for yet
    struct gltf_node_pose *poses;    // one for each node; NULL: no animation is shown
    struct gltf_vectors *vectors;    // one for each accessor
    uint32_t loaded_meshes;
    struct gltf_tally tally;
};

// gltf_material.c: appends all materials of the file to the scene, yet without textures.
bool gltf_materials_load(struct gltf_load *load, struct err *err);
// gltf_texture.c: decodes the images of materials in use, and gives these their textures.
bool gltf_textures_load(struct gltf_load *load, struct err *err);
// gltf_material_use.c: what is known of materials once all meshes and images are there.
bool gltf_materials_finish(struct gltf_load *load, struct err *err);

// gltf_variant.c: sets load->variant to that of KHR_materials_variants by this name, NULL: none.
// ERR_USAGE naming those there are.
bool gltf_variant_find(struct gltf_load *load, const char *name, struct err *err);
// The material that a primitive has with it, now in use; GLTF_NONE: none.
bool gltf_variant_material(struct gltf_load *load, const struct json_node *primitive,
                           uint32_t *material, struct err *err);

// gltf_light.c: adds the light that `holder`, a node, has.
bool gltf_light_load(struct gltf_load *load, const struct json_node *holder,
                     const double world[3][4], struct err *err);

// gltf_mesh.c: the scene's meshes for glTF mesh `index`, with its morph targets by these weights,
// which must live as long as the document. Those of the last call for this mesh are returned again
// where the weights are the same. skin: moves them into the world; such ones are new every time.
// NULL: they stay in their own space.
bool gltf_mesh_load(struct gltf_load *load, uint32_t index, const struct gltf_weights *weights,
                    const struct gltf_skin *skin, struct gltf_mesh_range *out, struct err *err);

// The least memory that a glTF mesh will take.
struct gltf_mesh_needs {
    uint64_t vertex_bytes;    // once, whatever primitives share the accessors
    uint64_t primitive_bytes; // whenever it is converted
    uint32_t count;           // of the scene's meshes that it becomes
};
// `seen`, for each accessor, says as which attributes it is counted already: a bit for each.
struct gltf_mesh_needs gltf_mesh_count(const struct gltf_document *document, uint32_t index,
                                       uint8_t *seen);

// gltf_memory.c: asks the budget for all that the nodes of the scene will take at least, before any
// is loaded. ERR_BUDGET, with the first node that is too many, where that is more than is left.
struct gltf_nodes;
bool gltf_check_memory(const struct gltf_load *load, const struct gltf_nodes *nodes,
                       struct err *err);

// gltf_instancing.c: how many instances EXT_mesh_gpu_instancing makes of the node's mesh; 1 without
// it, 0 where it cannot be read.
uint32_t gltf_instancing_count(const struct gltf_document *document, const struct json_node *node);
// Adds instances of scene mesh range `meshes` at the transforms that the node's
// EXT_mesh_gpu_instancing gives, each after `world`. *found: the node has that extension.
bool gltf_instancing_load(struct gltf_load *load, const struct json_node *node,
                          const double world[3][4], struct gltf_mesh_range meshes, bool *found,
                          struct err *err);
bool gltf_instance_add(struct gltf_load *load, const double transform[3][4],
                       struct gltf_mesh_range meshes, struct err *err);

// load_gltf.c: loads a file whose bytes are in memory, as load_gltf_into does one on disk.
struct gltf_load_params {
    struct gltf_source source;
    const double (*place)[4]; // 3x4, the file's world to the scene's
    bool with_cameras;
    const char *variant;      // as in scene_load_params
    const double *at_seconds; // as in scene_load_params, and these two
    const char *animation, *scene_name;
    const struct progress *progress; // NULL: nobody listens
};
bool gltf_load_bytes(struct scene *scene, const struct gltf_load_params *params, struct err *err);

#endif
