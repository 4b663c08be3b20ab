// The pose of a glTF document at one time: animations, morph targets and skins are applied while
// the scene is loaded. Internal to scene/.
#ifndef LAMPYRIS_SCENE_GLTF_GLTF_POSE_H
#define LAMPYRIS_SCENE_GLTF_GLTF_POSE_H

#include "scene/gltf/gltf_load.h"
#include "scene/gltf/gltf_node.h"

// --- gltf_animation.c ----------------------------------------------------------------------------

// The parts of a node's transform that an animation sets; the other parts are the node's own.
struct gltf_node_pose {
    bool has_translation, has_rotation, has_scale;
    double translation[3], rotation[4], scale[3];
    const double *weights; // weight_count weights of morph targets; NULL: the node's own
    uint32_t weight_count;
};

// Computes the poses of all nodes in the animation `name` (a name or an index; NULL: the first) at
// `seconds`. Before the first key and after the last, that key's value applies. *poses is NULL if
// the file has no animations. Memory comes from the document's arena.
bool gltf_animation_pose(struct gltf_load *load, const char *name, double seconds,
                         struct gltf_node_pose **poses, struct err *err);

// --- gltf_morph.c --------------------------------------------------------------------------------

// Gets the number of morph targets of a mesh. Fails if its primitives have different numbers.
bool gltf_morph_count(struct gltf_load *load, uint32_t mesh, uint32_t *count, struct err *err);
// Finds the weights of a node's mesh: those of the pose (which may be NULL), else of the node, else
// of the mesh.
bool gltf_morph_weights(struct gltf_load *load, uint32_t node, uint32_t mesh,
                        const struct gltf_node_pose *pose, struct gltf_weights *out,
                        struct err *err);
// Adds a primitive's displacements to the arrays of *mesh. Arrays that change are replaced by new
// ones.
bool gltf_morph_apply(struct gltf_load *load, const struct json_node *primitive,
                      const struct gltf_weights *weights, struct mesh *mesh, struct err *err);

// --- gltf_skin.c ---------------------------------------------------------------------------------

struct gltf_skin {
    uint32_t joint_count;
    double (*joints)[3][4]; // from the skinned mesh's space to the world
};

// Returns skin `index`, which is read in the pose of the nodes when it is first requested; NULL
// with *err set on failure.
const struct gltf_skin *gltf_skin_open(struct gltf_load *load, const struct gltf_nodes *nodes,
                                       uint32_t index, struct err *err);
// Moves *mesh, whose triangles are complete, into the world. Arrays that change are replaced by new
// ones.
bool gltf_skin_apply(struct gltf_load *load, const struct json_node *primitive,
                     const struct gltf_skin *skin, struct mesh *mesh, struct err *err);

#endif
