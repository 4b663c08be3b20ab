// Reads nodes (glTF 2.0, section 3.5). Nothing here recurses, because a chain of nodes may be as
// long as the file.
#include "scene/gltf/gltf_node.h"

#include "scene/core/affine.h"
#include "scene/gltf/gltf_pose.h"
#include <float.h>
#include <math.h>
#include <string.h>

// --- transforms ----------------------------------------------------------------------------------

// Computes the matrix of a unit quaternion, for column vectors (Shoemake 1985, "Animating rotation
// with quaternion curves", appendix).
static void quaternion_matrix(const double q[4], double out[3][3])
{
    double x = q[0], y = q[1], z = q[2], w = q[3];
    const double matrix[3][3] = {
        {1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
        {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
        {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)},
    };
    memcpy(out, matrix, sizeof matrix);
}

bool gltf_compose(const double translation[3], const double rotation[4], const double scale[3],
                  double out[3][4])
{
    double largest = 0;
    for (int i = 0; i < 4; i++)
        largest = fmax(largest, fabs(rotation[i]));
    if (!(largest > 0))
        return false;
    // The quaternion is divided by its largest component, so that no square overflows or
    // underflows.
    double q[4], square = 0;
    for (int i = 0; i < 4; i++) {
        q[i] = rotation[i] / largest;
        square += q[i] * q[i];
    }
    for (int i = 0; i < 4; i++)
        q[i] /= sqrt(square);
    double matrix[3][3];
    quaternion_matrix(q, matrix);
    for (int row = 0; row < 3; row++) {
        for (int column = 0; column < 3; column++)
            out[row][column] = matrix[row][column] * scale[column];
        out[row][3] = translation[row];
    }
    return true;
}

// Reads "matrix": 16 numbers in column-major order, whose last row must be that of an affine map.
static bool read_matrix(const struct json_node *node, double out[3][4], struct err *err)
{
    static const char *const others[] = {"translation", "rotation", "scale"};
    for (int i = 0; i < 3; i++)
        if (json_object_get(node->value, others[i]))
            return node_fail(node, err, "both \"matrix\" and \"%s\" are given; expected one",
                             others[i]);
    double m[16];
    if (!gltf_read_numbers(node, "matrix", 16, m, err))
        return false;
    // Exporters write products of single-precision matrices, so rounding errors in the last row are
    // permitted.
    bool is_affine = fabs(m[3]) <= FLT_EPSILON && fabs(m[7]) <= FLT_EPSILON &&
                     fabs(m[11]) <= FLT_EPSILON && fabs(m[15] - 1) <= FLT_EPSILON;
    const struct json_node matrix = node_member(node, "matrix");
    if (!is_affine)
        return node_fail(&matrix, err, "the last row is (%g, %g, %g, %g); expected (0, 0, 0, 1)",
                         m[3], m[7], m[11], m[15]);
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 4; column++)
            out[row][column] = m[4 * column + row];
    return true;
}

// Computes a node's local transform. `pose` has the values that an animation sets, or is NULL.
static bool read_local(const struct json_node *node, const struct gltf_node_pose *pose,
                       double out[3][4], struct err *err)
{
    if (json_object_get(node->value, "matrix"))
        return read_matrix(node, out, err);
    double translation[3] = {0, 0, 0}, rotation[4] = {0, 0, 0, 1}, scale[3] = {1, 1, 1};
    if (!gltf_read_numbers(node, "translation", 3, translation, err) ||
        !gltf_read_numbers(node, "rotation", 4, rotation, err) ||
        !gltf_read_numbers(node, "scale", 3, scale, err))
        return false;
    if (pose && pose->has_translation)
        memcpy(translation, pose->translation, sizeof translation);
    if (pose && pose->has_rotation)
        memcpy(rotation, pose->rotation, sizeof rotation);
    if (pose && pose->has_scale)
        memcpy(scale, pose->scale, sizeof scale);
    const struct json_node rotation_node = node_member(node, "rotation");
    if (!gltf_compose(translation, rotation, scale, out))
        return node_fail(&rotation_node, err, "the zero quaternion is not a rotation");
    return true;
}

static bool is_finite(const double m[3][4])
{
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 4; column++)
            if (!isfinite(m[row][column]))
                return false;
    return true;
}

// --- hierarchy -----------------------------------------------------------------------------------

bool gltf_node_index(const struct json_node *array, size_t i, uint32_t count, uint32_t *out,
                     struct err *err)
{
    const struct json_node element = node_element(array, i);
    if (!json_is_integer(element.value))
        return node_unexpected(&element, "the index of a node", err);
    json_int_t index = json_integer_value(element.value);
    if (index < 0 || index >= (json_int_t)count)
        return node_fail(&element, err, "%lld; expected the index of a node, below %u",
                         (long long)index, count);
    *out = (uint32_t)index;
    return true;
}

static bool link_children(const struct gltf_document *document, struct gltf_nodes *nodes,
                          uint32_t index, struct err *err)
{
    const struct json_node node = gltf_item(document, GLTF_NODES, index);
    struct json_node children;
    if (!gltf_read_array(&node, "children", &children, err))
        return false;
    for (size_t i = 0; i < json_array_size(children.value); i++) {
        uint32_t child;
        if (!gltf_node_index(&children, i, nodes->count, &child, err))
            return false;
        const struct json_node element = node_element(&children, i);
        if (nodes->parent[child] != GLTF_NONE)
            return node_fail(&element, err, "node %u is already a child of nodes[%u]", child,
                             nodes->parent[child]);
        nodes->parent[child] = index;
    }
    return true;
}

// Checks that there are no cycles. Every node has at most one parent, so following the parents from
// a node ends at a root or finds a cycle. Every node is visited once: visit[n] is 1 + the start
// from which node n was visited.
static bool check_acyclic(const struct gltf_document *document, const struct gltf_nodes *nodes,
                          uint32_t *visit, struct err *err)
{
    for (uint32_t start = 0; start < nodes->count; start++) {
        uint32_t n = start;
        while (n != GLTF_NONE && visit[n] == 0) {
            visit[n] = start + 1;
            n = nodes->parent[n];
        }
        if (n != GLTF_NONE && visit[n] == start + 1) {
            const struct json_node node = gltf_item(document, GLTF_NODES, n);
            return node_fail(&node, err, "is its own ancestor");
        }
    }
    return true;
}

// --- the scene -----------------------------------------------------------------------------------

// A traversal of the scene's nodes, parents before children. `order` holds the `count` nodes that
// have been found; the children of the first `next` nodes are among them.
struct walk {
    const struct gltf_nodes_params *params;
    uint32_t *order;
    uint32_t count, next;
};

static bool walk_add(struct walk *walk, const struct gltf_document *document,
                     struct gltf_nodes *nodes, uint32_t index, const double parent[3][4],
                     struct err *err)
{
    const struct json_node node = gltf_item(document, GLTF_NODES, index);
    const struct gltf_node_pose *poses = walk->params->poses;
    double local[3][4];
    if (!read_local(&node, poses ? &poses[index] : NULL, local, err))
        return false;
    affine_multiply(parent, local, nodes->world[index]);
    if (!is_finite(nodes->world[index]))
        return node_fail(&node, err, "its transform in the world is not finite");
    nodes->is_in_scene[index] = true;
    walk->order[walk->count++] = index;
    return true;
}

static bool add_scene_roots(struct walk *walk, const struct gltf_document *document,
                            struct gltf_nodes *nodes, uint32_t scene_index, struct err *err)
{
    const struct json_node scene = gltf_item(document, GLTF_SCENES, scene_index);
    struct json_node roots;
    if (!gltf_read_array(&scene, "nodes", &roots, err))
        return false;
    for (size_t i = 0; i < json_array_size(roots.value); i++) {
        uint32_t index;
        if (!gltf_node_index(&roots, i, nodes->count, &index, err))
            return false;
        const struct json_node element = node_element(&roots, i);
        if (nodes->parent[index] != GLTF_NONE)
            return node_fail(&element, err, "node %u is a child of nodes[%u]; expected a root",
                             index, nodes->parent[index]);
        if (nodes->is_in_scene[index])
            return node_fail(&element, err, "node %u is named twice", index);
        if (!walk_add(walk, document, nodes, index, walk->params->place, err))
            return false;
    }
    return true;
}

static bool add_all_roots(struct walk *walk, const struct gltf_document *document,
                          struct gltf_nodes *nodes, struct err *err)
{
    const double(*place)[4] = walk->params->place;
    for (uint32_t i = 0; i < nodes->count; i++)
        if (nodes->parent[i] == GLTF_NONE && !walk_add(walk, document, nodes, i, place, err))
            return false;
    return true;
}

static bool add_roots(struct walk *walk, const struct gltf_document *document,
                      struct gltf_nodes *nodes, struct err *err)
{
    uint32_t scene, scene_count = document->counts[GLTF_SCENES];
    const char *wanted = walk->params->scene;
    if (wanted ? !gltf_find(document, GLTF_SCENES, "scene", wanted, &scene, err)
               : !gltf_read_index(&document->root, "scene", scene_count, &scene, err))
        return false;
    if (scene == GLTF_NONE && scene_count > 0)
        scene = 0;
    return scene == GLTF_NONE ? add_all_roots(walk, document, nodes, err)
                              : add_scene_roots(walk, document, nodes, scene, err);
}

static bool walk_on(struct walk *walk, const struct gltf_document *document,
                    struct gltf_nodes *nodes, struct err *err)
{
    uint32_t index = walk->order[walk->next++];
    const struct json_node node = gltf_item(document, GLTF_NODES, index);
    const json_t *children = node_member(&node, "children").value;
    for (size_t i = 0; i < json_array_size(children); i++) {
        uint32_t child = (uint32_t)json_integer_value(json_array_get(children, i));
        if (!walk_add(walk, document, nodes, child, nodes->world[index], err))
            return false;
    }
    return true;
}

bool gltf_nodes_open(struct gltf_nodes *nodes, const struct gltf_document *document,
                     const struct gltf_nodes_params *params, struct arena *arena, struct err *err)
{
    uint32_t count = document->counts[GLTF_NODES];
    *nodes = (struct gltf_nodes){
        .count = count,
        .parent = ARENA_NEW(arena, uint32_t, count),
        .is_in_scene = ARENA_NEW(arena, bool, count),
        .world = arena_alloc(arena, count, sizeof *nodes->world),
    };
    uint32_t *visit = ARENA_NEW(arena, uint32_t, count);
    struct walk walk = {.params = params, .order = ARENA_NEW(arena, uint32_t, count)};
    if (!nodes->parent || !nodes->is_in_scene || !nodes->world || !visit || !walk.order)
        return gltf_no_memory(document, "nodes", count * sizeof *nodes->world, err);
    for (uint32_t i = 0; i < count; i++)
        nodes->parent[i] = GLTF_NONE;
    for (uint32_t i = 0; i < count; i++)
        if (!link_children(document, nodes, i, err))
            return false;
    if (!check_acyclic(document, nodes, visit, err) || !add_roots(&walk, document, nodes, err))
        return false;
    while (walk.next < walk.count)
        if (!walk_on(&walk, document, nodes, err))
            return false;
    return true;
}
