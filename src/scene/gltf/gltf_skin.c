// Applies skins (glTF 2.0, section 3.7.3): joints move vertices, by weights. The result is in world
// space, where the joints are; the transform of the mesh's own node is ignored.
#include "scene/gltf/gltf_pose.h"

#include "scene/core/affine.h"
#include "scene/gltf/gltf_accessor.h"
#include "scene/mesh/mesh_loader.h"
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static const struct accessor_rule matrix_rule = {
    .use = "inverse bind matrices", .components = ACCESSOR_MAT4, .types = COMPONENTS_FLOAT};
static const struct accessor_rule joint_rule = {.use = "JOINTS",
                                                .components = 4,
                                                .types = COMPONENTS_SMALL_UNSIGNED,
                                                .is_vertex_attribute = true};
static const struct accessor_rule weight_rule = {.use = "WEIGHTS",
                                                 .components = 4,
                                                 .types = COMPONENTS_FLOAT,
                                                 .normalized_types = COMPONENTS_SMALL_UNSIGNED,
                                                 .is_vertex_attribute = true};

// --- joints --------------------------------------------------------------------------------------

// Reads node `i` of the skin's joints, which must have a world transform.
static bool read_joint(const struct gltf_nodes *nodes, const struct json_node *joints, size_t i,
                       uint32_t *node, struct err *err)
{
    const struct json_node element = node_element(joints, i);
    if (!gltf_node_index(joints, i, nodes->count, node, err))
        return false;
    if (!nodes->is_in_scene[*node])
        return node_fail(&element, err, "node %u is not in the scene that is loaded", *node);
    return true;
}

// Returns whether the last row is (0, 0, 0, 1), as section 3.7.3.1 requires. A different row is
// ignored, as in other viewers, and only counted for a note.
static bool is_affine(const float m[16])
{
    return fabsf(m[3]) <= FLT_EPSILON && fabsf(m[7]) <= FLT_EPSILON &&
           fabsf(m[11]) <= FLT_EPSILON && fabsf(m[15] - 1) <= FLT_EPSILON;
}

// Multiplies the joints' transforms by the inverse bind matrices, which are in column-major order.
static bool apply_bind_matrices(struct gltf_load *load, uint32_t accessor, struct gltf_skin *skin,
                                struct err *err)
{
    struct accessor_view view;
    if (!accessor_view(&load->document, accessor, &matrix_rule, &view, err))
        return false;
    if (view.count < skin->joint_count)
        return node_fail(&view.node, err, "%u inverse bind matrices for %u joints", view.count,
                         skin->joint_count);
    struct arena scratch = {0};
    float(*matrices)[16] = arena_alloc(&scratch, view.count, sizeof *matrices);
    if (!matrices)
        return gltf_no_memory(&load->document, "matrices", view.count * sizeof *matrices, err);
    bool ok = accessor_read_floats(&view, matrices[0], err);
    for (uint32_t j = 0; ok && j < skin->joint_count; j++) {
        double inverse_bind[3][4];
        for (int row = 0; row < 3; row++)
            for (int column = 0; column < 4; column++)
                inverse_bind[row][column] = (double)matrices[j][4 * column + row];
        load->tally.projective_joints += !is_affine(matrices[j]);
        affine_multiply((const double(*)[4])skin->joints[j], inverse_bind, skin->joints[j]);
    }
    arena_finish(&scratch);
    return ok;
}

static bool read_skin(struct gltf_load *load, const struct gltf_nodes *nodes, uint32_t index,
                      struct gltf_skin *out, struct err *err)
{
    struct gltf_document *document = &load->document;
    const struct json_node node = gltf_item(document, GLTF_SKINS, index);
    struct json_node joints;
    uint32_t accessor, skeleton;
    if (!gltf_require(&node, "joints", err) || !gltf_read_array(&node, "joints", &joints, err) ||
        !node_check_array(&joints, 1, GLTF_MAX_COUNT, err) ||
        !gltf_read_index(&node, "skeleton", nodes->count, &skeleton, err) ||
        !gltf_read_index(&node, "inverseBindMatrices", document->counts[GLTF_ACCESSORS], &accessor,
                         err))
        return false;
    out->joint_count = (uint32_t)json_array_size(joints.value);
    out->joints = arena_alloc(&document->arena, out->joint_count, sizeof *out->joints);
    if (!out->joints)
        return gltf_no_memory(document, "joints", out->joint_count * sizeof *out->joints, err);
    for (uint32_t j = 0; j < out->joint_count; j++) {
        uint32_t joint;
        if (!read_joint(nodes, &joints, j, &joint, err))
            return false;
        memcpy(out->joints[j], nodes->world[joint], sizeof out->joints[j]);
    }
    return accessor == GLTF_NONE || apply_bind_matrices(load, accessor, out, err);
}

const struct gltf_skin *gltf_skin_open(struct gltf_load *load, const struct gltf_nodes *nodes,
                                       uint32_t index, struct err *err)
{
    struct gltf_skin *skin = &load->skins[index];
    return skin->joints || read_skin(load, nodes, index, skin, err) ? skin : NULL;
}

// --- weights -------------------------------------------------------------------------------------

// The weighted sums of the joints' transforms, for the vertices of a mesh.
struct blend {
    struct arena arena;
    const struct gltf_skin *skin;
    uint32_t vertex_count;
    double (*transforms)[3][4];
    double *totals; // sums of weights
    uint32_t *joints;
    float *weights; // one set of weights: four per vertex
};

static bool no_blend_memory(struct gltf_load *load, const struct blend *blend, struct err *err)
{
    return gltf_no_memory(&load->document, "a skin",
                          blend->vertex_count * (sizeof *blend->transforms + sizeof(double) +
                                                 4 * (sizeof(uint32_t) + sizeof(float))),
                          err);
}

static bool open_blend(struct gltf_load *load, struct blend *blend, struct err *err)
{
    blend->transforms = arena_alloc(&blend->arena, blend->vertex_count, sizeof *blend->transforms);
    blend->totals = ARENA_NEW(&blend->arena, double, blend->vertex_count);
    blend->joints = arena_alloc(&blend->arena, blend->vertex_count, 4 * sizeof(uint32_t));
    blend->weights = arena_alloc(&blend->arena, blend->vertex_count, 4 * sizeof(float));
    return (blend->transforms && blend->totals && blend->joints && blend->weights) ||
           no_blend_memory(load, blend, err);
}

static bool read_set(struct gltf_load *load, const struct json_node *attributes, uint32_t accessor,
                     const char *weights_key, struct blend *blend, struct err *err)
{
    struct accessor_view view[2];
    uint32_t weights;
    if (!gltf_require(attributes, weights_key, err) ||
        !gltf_read_index(attributes, weights_key, load->document.counts[GLTF_ACCESSORS], &weights,
                         err) ||
        !accessor_view(&load->document, accessor, &joint_rule, &view[0], err) ||
        !accessor_view(&load->document, weights, &weight_rule, &view[1], err))
        return false;
    for (int i = 0; i < 2; i++)
        if (view[i].count != blend->vertex_count)
            return node_fail(&view[i].node, err, "%u elements of %s for %u positions",
                             view[i].count, i ? weights_key : joint_rule.use, blend->vertex_count);
    if (!accessor_read_joints(&view[0], blend->skin->joint_count, blend->joints, err) ||
        !accessor_read_floats(&view[1], blend->weights, err))
        return false;
    for (size_t i = 0; i < 4 * (size_t)blend->vertex_count; i++)
        if (blend->weights[i] < 0)
            return node_fail(&view[1].node, err,
                             "element %zu, component %zu is %g; expected no negative weight", i / 4,
                             i % 4, (double)blend->weights[i]);
    return true;
}

static void add_joint(struct blend *blend, uint32_t vertex, uint32_t joint, double weight)
{
    blend->totals[vertex] += weight;
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 4; column++)
            blend->transforms[vertex][row][column] +=
                weight * blend->skin->joints[joint][row][column];
}

// Adds JOINTS_set and WEIGHTS_set; *found becomes whether they exist.
static bool add_set(struct gltf_load *load, const struct json_node *attributes, uint32_t set,
                    struct blend *blend, bool *found, struct err *err)
{
    char joints_key[32], weights_key[32];
    uint32_t accessor;
    snprintf(joints_key, sizeof joints_key, "JOINTS_%u", set);
    snprintf(weights_key, sizeof weights_key, "WEIGHTS_%u", set);
    if (!gltf_read_index(attributes, joints_key, load->document.counts[GLTF_ACCESSORS], &accessor,
                         err))
        return false;
    *found = accessor != GLTF_NONE;
    if (!*found)
        return true;
    if (!read_set(load, attributes, accessor, weights_key, blend, err))
        return false;
    for (size_t i = 0; i < 4 * (size_t)blend->vertex_count; i++)
        if (blend->weights[i] > 0)
            add_joint(blend, (uint32_t)(i / 4), blend->joints[i], (double)blend->weights[i]);
    return true;
}

// Divides by the sums of weights, which are 1 except for rounding. As in other viewers, a vertex
// without weights follows the first joint.
static void normalize_weights(struct gltf_load *load, struct blend *blend)
{
    for (uint32_t v = 0; v < blend->vertex_count; v++) {
        if (!(blend->totals[v] > 0)) {
            load->tally.vertices_without_joints++;
            add_joint(blend, v, 0, 1);
        }
        for (int row = 0; row < 3; row++)
            for (int column = 0; column < 4; column++)
                blend->transforms[v][row][column] /= blend->totals[v];
    }
}

// --- vertices ------------------------------------------------------------------------------------

static bool allocate_vertices(struct gltf_load *load, struct mesh *mesh)
{
    struct arena *arena = &load->scene->arena;
    size_t count = mesh->vertex_count;
    mesh->positions = arena_alloc(arena, count, sizeof *mesh->positions);
    mesh->exact_positions = arena_alloc(arena, count, sizeof *mesh->exact_positions);
    if (mesh->normals)
        mesh->normals = arena_alloc(arena, count, sizeof *mesh->normals);
    if (mesh->tangents)
        mesh->tangents = arena_alloc(arena, count, sizeof *mesh->tangents);
    return mesh->positions && mesh->exact_positions;
}

static bool move_position(const double transform[3][4], const float from[3], double exact[3],
                          float to[3])
{
    const double p[3] = {(double)from[0], (double)from[1], (double)from[2]};
    affine_point(transform, p, exact);
    for (int i = 0; i < 3; i++) {
        if (!(fabs(exact[i]) <= SCENE_COORDINATE_MAX))
            return false;
        to[i] = (float)exact[i];
    }
    return true;
}

// Transforms a normal by the inverse transpose, up to a positive factor. A degenerate result
// becomes zero.
static void move_normal(const double transform[3][4], const float from[3], float to[3])
{
    double cofactors[3][3], turned[3];
    double sign = affine_determinant(transform) < 0 ? -1 : 1;
    affine_cofactors(transform, cofactors);
    for (int i = 0; i < 3; i++)
        turned[i] = sign * (cofactors[i][0] * (double)from[0] + cofactors[i][1] * (double)from[1] +
                            cofactors[i][2] * (double)from[2]);
    bool is_valid = vec3_normalize(turned);
    for (int i = 0; i < 3; i++)
        to[i] = is_valid ? (float)turned[i] : 0.0f;
}

static void move_tangent(const double transform[3][4], const float from[4], float to[4])
{
    double turned[3] = {(double)from[0], (double)from[1], (double)from[2]};
    affine_vector(transform, turned, turned);
    bool is_valid = vec3_normalize(turned);
    for (int i = 0; i < 3; i++)
        to[i] = is_valid ? (float)turned[i] : 0.0f;
    // A reflection reverses the cross product of normal and tangent.
    to[3] = affine_determinant(transform) < 0 ? -from[3] : from[3];
}

static bool move_vertices(struct gltf_load *load, const struct json_node *primitive,
                          const struct blend *blend, struct mesh *mesh, struct err *err)
{
    const struct mesh rest = *mesh;
    if (!allocate_vertices(load, mesh) || (rest.normals && !mesh->normals) ||
        (rest.tangents && !mesh->tangents))
        return gltf_no_memory(&load->document, "skinned vertices",
                              mesh->vertex_count * (sizeof *mesh->exact_positions + 10 * 4), err);
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        const double(*transform)[4] = (const double(*)[4])blend->transforms[v];
        double *exact = mesh->exact_positions[v];
        if (!move_position(transform, rest.positions[v], exact, mesh->positions[v]))
            return node_fail(primitive, err,
                             "vertex %u: its joints bring it to (%g, %g, %g); expected "
                             "coordinates within +-%g",
                             v, exact[0], exact[1], exact[2], SCENE_COORDINATE_MAX);
        if (rest.normals)
            move_normal(transform, rest.normals[v], mesh->normals[v]);
        if (rest.tangents)
            move_tangent(transform, rest.tangents[v], mesh->tangents[v]);
    }
    return true;
}

// Exchanges two corners of triangles that the joints reflect, so that the front side stays outside.
static void turn_reflected(const struct blend *blend, struct mesh *mesh)
{
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        uint32_t *corners = mesh->indices[t];
        int reflected = 0;
        for (int c = 0; c < 3; c++)
            reflected += affine_determinant((const double(*)[4])blend->transforms[corners[c]]) < 0;
        if (reflected < 2)
            continue;
        uint32_t second = corners[1];
        corners[1] = corners[2];
        corners[2] = second;
    }
}

bool gltf_skin_apply(struct gltf_load *load, const struct json_node *primitive,
                     const struct gltf_skin *skin, struct mesh *mesh, struct err *err)
{
    struct json_node attributes;
    if (!gltf_read_object(primitive, "attributes", &attributes, err) ||
        !gltf_require(&attributes, "JOINTS_0", err))
        return false;
    struct blend blend = {.skin = skin, .vertex_count = mesh->vertex_count};
    bool ok = open_blend(load, &blend, err), found = true;
    for (uint32_t set = 0; ok && found; set++)
        ok = add_set(load, &attributes, set, &blend, &found, err);
    if (ok) {
        normalize_weights(load, &blend);
        ok = move_vertices(load, primitive, &blend, mesh, err);
    }
    if (ok)
        turn_reflected(&blend, mesh);
    arena_finish(&blend.arena);
    return ok;
}
