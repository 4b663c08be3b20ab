// The pose of a glTF document at a time: animations, morph targets and skins, baked when the scene
// is loaded. Internal to scene/.
#ifndef LAMPYRIS_SCENE_GLTF_GLTF_POSE_H
#define LAMPYRIS_SCENE_GLTF_GLTF_POSE_H

#include "scene/gltf/gltf_load.h"
#include "scene/gltf/gltf_node.h"

// --- gltf_animation.c ----------------------------------------------------------------------------

// The parts of a node that an animation sets; the others are the node's own.
struct gltf_node_pose {
    bool has_translation, has_rotation, has_scale;
    double translation[3], rotation[4], scale[3];
    const double *weights; // of morph targets, weight_count; NULL: the node's own
    uint32_t weight_count;
};

// An array of the document's nodes, each as the animation `name` (a name or an index; NULL: the
// first) has it at `seconds`: before its first key the value of that, after the last the last's.
// NULL in *poses where the file has no animations. Memory comes from the document's arena.
bool gltf_animation_pose(struct gltf_load *load, const char *name, double seconds,
                         struct gltf_node_pose **poses, struct err *err);

// --- gltf_morph.c --------------------------------------------------------------------------------

// The number of morph targets of a mesh, 0 for most. err: its primitives disagree.
bool gltf_morph_count(struct gltf_load *load, uint32_t mesh, uint32_t *count, struct err *err);
// The weights of a node's mesh: of its pose (may be NULL), else of the node, else of the mesh.
bool gltf_morph_weights(struct gltf_load *load, uint32_t node, uint32_t mesh,
                        const struct gltf_node_pose *pose, struct gltf_weights *out,
                        struct err *err);
// Adds the primitive's displacements to the arrays of *mesh, replacing those that they change.
bool gltf_morph_apply(struct gltf_load *load, const struct json_node *primitive,
                      const struct gltf_weights *weights, struct mesh *mesh, struct err *err);

// --- gltf_skin.c ---------------------------------------------------------------------------------

struct gltf_skin {
    uint32_t joint_count;
    double (*joints)[3][4]; // from the space of the skinned mesh to the world
};

// Reads skin `index` as the nodes stand, when first asked for; NULL with *err set on failure.
const struct gltf_skin *gltf_skin_open(struct gltf_load *load, const struct gltf_nodes *nodes,
                                       uint32_t index, struct err *err);
// Moves *mesh, whose triangles are there, into the world. What is written is new.
bool gltf_skin_apply(struct gltf_load *load, const struct json_node *primitive,
                     const struct gltf_skin *skin, struct mesh *mesh, struct err *err);

#endif
