// The pose of a glTF document at a time: animations, morph targets and skins are applied when the
// scene is loaded. Internal to scene/.
#ifndef LAMPYRIS_SCENE_GLTF_GLTF_POSE_H
#define LAMPYRIS_SCENE_GLTF_GLTF_POSE_H

#include "scene/gltf/gltf_load.h"
#include "scene/gltf/gltf_node.h"

// --- gltf_animation.c ----------------------------------------------------------------------------

// The transform parts of a node that an animation sets; the others are the node's own.
struct gltf_node_pose {
    bool has_translation, has_rotation, has_scale;
    double translation[3], rotation[4], scale[3];
    const double *weights; // weights of morph targets, weight_count; NULL: the node's own
    uint32_t weight_count;
};

// Computes an array with the pose of each of the document's nodes in the animation `name` (a name
// or an index; NULL: the first) at `seconds`. Before the first key and after the last, the value of
// that key applies. *poses is NULL if the file has no animations. Memory comes from the document's
// arena.
bool gltf_animation_pose(struct gltf_load *load, const char *name, double seconds,
                         struct gltf_node_pose **poses, struct err *err);

// --- gltf_morph.c --------------------------------------------------------------------------------

// Returns the number of morph targets of a mesh. It is an error if its primitives differ in it.
bool gltf_morph_count(struct gltf_load *load, uint32_t mesh, uint32_t *count, struct err *err);
// Finds the weights of a node's mesh: those of its pose (may be NULL), or else of the node, or else
// of the mesh.
bool gltf_morph_weights(struct gltf_load *load, uint32_t node, uint32_t mesh,
                        const struct gltf_node_pose *pose, struct gltf_weights *out,
                        struct err *err);
// Adds the primitive's displacements to the arrays of *mesh; arrays that change are replaced by new
// ones.
bool gltf_morph_apply(struct gltf_load *load, const struct json_node *primitive,
                      const struct gltf_weights *weights, struct mesh *mesh, struct err *err);

// --- gltf_skin.c ---------------------------------------------------------------------------------

struct gltf_skin {
    uint32_t joint_count;
    double (*joints)[3][4]; // from the space of the skinned mesh to the world
};

// Reads skin `index` in the pose of the nodes on the first request; returns NULL with *err set on
// failure.
const struct gltf_skin *gltf_skin_open(struct gltf_load *load, const struct gltf_nodes *nodes,
                                       uint32_t index, struct err *err);
// Moves *mesh, whose triangles are complete, into the world. The arrays that change are new.
bool gltf_skin_apply(struct gltf_load *load, const struct json_node *primitive,
                     const struct gltf_skin *skin, struct mesh *mesh, struct err *err);

#endif
