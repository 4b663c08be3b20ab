// Computes a lower bound of the memory for the nodes of a glTF file from the accessors' counts,
// before any node is loaded.
#include "scene/gltf/gltf_load.h"

#include "base/memory.h"
#include "scene/gltf/gltf_node.h"

struct tally {
    const struct gltf_load *load;
    struct gltf_mesh_needs *meshes; // one for each glTF mesh
    bool *counted;                  // one for each glTF mesh: `meshes` and `bytes` include it
    uint8_t *seen;                  // one for each accessor, see gltf_mesh_count()
    uint64_t bytes;
};

static void add_node(struct tally *tally, uint32_t index)
{
    const struct gltf_document *document = &tally->load->document;
    const struct json_node node = gltf_item(document, GLTF_NODES, index);
    struct err dropped = {0};
    uint32_t mesh, skin;
    if (!gltf_read_index(&node, "mesh", document->counts[GLTF_MESHES], &mesh, &dropped) ||
        !gltf_read_index(&node, "skin", document->counts[GLTF_SKINS], &skin, &dropped) ||
        mesh == GLTF_NONE)
        return;
    struct gltf_mesh_needs *needs = &tally->meshes[mesh];
    bool is_new = !tally->counted[mesh];
    if (is_new) {
        *needs = gltf_mesh_count(document, mesh, tally->seen);
        tally->bytes += needs->vertex_bytes;
        tally->counted[mesh] = true;
    }
    // A skin moves its mesh into the world, so each skinned node has a mesh of its own and one
    // instance.
    bool has_skin = skin != GLTF_NONE;
    uint32_t instances = has_skin ? 1 : gltf_instancing_count(document, &node);
    if (is_new || has_skin)
        tally->bytes += needs->primitive_bytes;
    tally->bytes += (uint64_t)instances * needs->count * sizeof(struct instance);
}

static bool add_nodes(struct tally *tally, const struct gltf_nodes *nodes, struct err *err)
{
    static const char what[] =
        "the instances and meshes of all nodes; this node is the first that does not fit";
    uint32_t refused = GLTF_NONE;
    for (uint32_t i = 0; i < nodes->count; i++) {
        if (!nodes->is_in_scene[i])
            continue;
        if (!scene_goes_on(tally->load->scene, 0, err))
            return false;
        add_node(tally, i);
        if (refused == GLTF_NONE && !memory_check(tally->bytes, what, err))
            refused = i;
    }
    if (refused == GLTF_NONE || memory_check(tally->bytes, what, err))
        return true;
    const struct json_node first = gltf_item(&tally->load->document, GLTF_NODES, refused);
    return node_prepend(&first, err);
}

bool gltf_check_memory(const struct gltf_load *load, const struct gltf_nodes *nodes,
                       struct err *err)
{
    const uint32_t *counts = load->document.counts;
    struct arena scratch = {0};
    struct tally tally = {
        .load = load,
        .meshes = ARENA_NEW(&scratch, struct gltf_mesh_needs, counts[GLTF_MESHES]),
        .counted = ARENA_NEW(&scratch, bool, counts[GLTF_MESHES]),
        .seen = ARENA_NEW(&scratch, uint8_t, counts[GLTF_ACCESSORS]),
        .bytes = counts[GLTF_MATERIALS] * sizeof(struct material),
    };
    bool ok = tally.meshes && tally.counted && tally.seen
                  ? add_nodes(&tally, nodes, err)
                  : gltf_no_memory(&load->document, "the memory counts of nodes",
                                   counts[GLTF_MESHES] * sizeof *tally.meshes, err);
    arena_finish(&scratch);
    return ok;
}
