// The node hierarchy of a glTF document with world transforms. Internal to scene/.
#ifndef LAMPYRIS_SCENE_GLTF_NODE_H
#define LAMPYRIS_SCENE_GLTF_NODE_H

#include "gltf_document.h"

struct gltf_nodes {
    uint32_t count;        // of the file's nodes; all arrays have as many elements
    uint32_t *parent;      // GLTF_NONE: a root
    bool *is_in_scene;     // reached from the scene's roots
    double (*world)[3][4]; // of nodes in the scene
};

// Checks the hierarchy of all nodes (every node has at most one parent and is not its own ancestor)
// and computes the world transforms, after `place`, of those in the default scene: the document's
// "scene", else its first, else all roots. Memory comes from `arena`.
bool gltf_nodes_open(struct gltf_nodes *nodes, const struct gltf_document *document,
                     const double place[3][4], struct arena *arena, struct err *err);

// The map of a translation, a rotation and a scale, in this order from the left. The quaternion is
// (x, y, z, w) of any length; false when it is zero.
bool gltf_compose(const double translation[3], const double rotation[4], const double scale[3],
                  double out[3][4]);

#endif
