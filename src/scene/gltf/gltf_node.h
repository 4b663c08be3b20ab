// The node hierarchy of a glTF document with world transforms. Internal to scene/.
#ifndef LAMPYRIS_SCENE_GLTF_GLTF_NODE_H
#define LAMPYRIS_SCENE_GLTF_GLTF_NODE_H

#include "scene/gltf/gltf_document.h"

struct gltf_node_pose;

// Selects a scene, its placement and the pose of its nodes.
struct gltf_nodes_params {
    const double (*place)[4]; // 3x4, from the file's world to the scene's
    const char *scene;        // name or index; NULL: "scene", else the first, else all roots
    const struct gltf_node_pose *poses; // values set by an animation, one for each node; NULL: none
};

struct gltf_nodes {
    uint32_t count;        // number of nodes in the file, and length of all arrays
    uint32_t *parent;      // GLTF_NONE: the node is a root
    bool *is_in_scene;     // whether it is reached from the scene's roots
    double (*world)[3][4]; // only set for nodes in the scene
};

// Checks the hierarchy of all nodes (each has at most one parent and is not its own ancestor) and
// computes the world transforms of the nodes in the scene. Memory comes from `arena`.
bool gltf_nodes_open(struct gltf_nodes *nodes, const struct gltf_document *document,
                     const struct gltf_nodes_params *params, struct arena *arena, struct err *err);

// Reads element `i` of an array of node indices, which must be below `count`.
bool gltf_node_index(const struct json_node *array, size_t i, uint32_t count, uint32_t *out,
                     struct err *err);

// Computes the map translation * rotation * scale. The quaternion is (x, y, z, w) of any length.
// Returns false when it is zero.
bool gltf_compose(const double translation[3], const double rotation[4], const double scale[3],
                  double out[3][4]);

#endif
