// Converts meshes (glTF 2.0, section 3.7): each primitive that consists of triangles becomes a mesh
// of the scene.
#include "scene/gltf/gltf_load.h"

#include "scene/gltf/gltf_accessor.h"
#include "scene/gltf/gltf_attribute.h"
#include "scene/gltf/gltf_pose.h"
#include "scene/mesh/mesh_loader.h"
#include <string.h>

// The codes of the specification.
enum primitive_mode {
    MODE_POINTS = 0,
    MODE_LINE_STRIP = 3,
    MODE_TRIANGLES = 4,
    MODE_TRIANGLE_STRIP = 5,
    MODE_TRIANGLE_FAN = 6,
};

static const struct accessor_rule index_rule = {
    .use = "indices",
    .components = 1,
    .types = COMPONENTS_SMALL_UNSIGNED | COMPONENT_BIT(COMPONENT_U32),
};

// --- vertices ------------------------------------------------------------------------------------

// Reads the arrays of *mesh, which primitives with the same accessors share. All attributes are
// kept, whether the material uses them or not, because the arrays are shared; flattening omits
// those that no material needs.
static bool read_vertices(struct gltf_load *load, const struct json_node *attributes,
                          uint32_t position_accessor, struct mesh *mesh, struct err *err)
{
    float *positions, *normals, *tangents, *uvs[2], *colors;
    if (!gltf_attribute_read(load, attributes, "POSITION", GLTF_POSITION, 0, &positions, err))
        return false;
    uint32_t count = load->vectors[position_accessor].count;
    if (!gltf_attribute_read(load, attributes, "NORMAL", GLTF_NORMAL, count, &normals, err) ||
        !gltf_attribute_read(load, attributes, "TANGENT", GLTF_TANGENT, count, &tangents, err) ||
        !gltf_attribute_read(load, attributes, "TEXCOORD_0", GLTF_TEXCOORD, count, &uvs[0], err) ||
        !gltf_attribute_read(load, attributes, "TEXCOORD_1", GLTF_TEXCOORD, count, &uvs[1], err) ||
        !gltf_attribute_read(load, attributes, "COLOR_0", GLTF_COLOR, count, &colors, err))
        return false;
    mesh->vertex_count = count;
    mesh->positions = (float(*)[3])positions;
    // A mesh without normals is flat-shaded, and its tangents are ignored (section 3.7.2.1).
    mesh->normals = (float(*)[3])normals;
    mesh->tangents = normals ? (float(*)[4])tangents : NULL;
    for (int set = 0; set < 2; set++)
        mesh->uvs[set] = (float(*)[2])uvs[set];
    mesh->colors = (float(*)[4])colors;
    return true;
}

// --- triangles -----------------------------------------------------------------------------------

// Computes the corners of triangle `i` as positions in the sequence of vertices or indices (section
// 3.7.2.1).
static void triangle_corners(enum primitive_mode mode, uint32_t i, uint32_t corners[3])
{
    switch (mode) {
    case MODE_TRIANGLE_STRIP: // every other triangle is reversed, so that all face the same side
        corners[0] = i;
        corners[1] = i + 1 + i % 2;
        corners[2] = i + 2 - i % 2;
        return;
    case MODE_TRIANGLE_FAN:
        corners[0] = i + 1;
        corners[1] = i + 2;
        corners[2] = 0;
        return;
    default:
        for (uint32_t c = 0; c < 3; c++)
            corners[c] = 3 * i + c;
    }
}

// Checks that `count` vertices or indices, given by `node`, form whole triangles.
static bool count_triangles(const struct json_node *node, enum primitive_mode mode, uint32_t count,
                            uint32_t *out, struct err *err)
{
    if (mode == MODE_TRIANGLES && count % 3 != 0)
        return node_fail(node, err, "%u vertices of triangles; expected a multiple of 3", count);
    if (count < 3)
        return node_fail(node, err, "%u vertices of a triangle strip or fan; expected at least 3",
                         count);
    *out = mode == MODE_TRIANGLES ? count / 3 : count - 2;
    return true;
}

// Allocates the triangles of `count` vertices or indices, given by `node`.
static bool allocate_triangles(struct gltf_load *load, const struct json_node *node,
                               enum primitive_mode mode, uint32_t count, struct mesh *mesh,
                               struct err *err)
{
    if (!count_triangles(node, mode, count, &mesh->triangle_count, err))
        return false;
    mesh->indices = arena_alloc(&load->scene->arena, mesh->triangle_count, sizeof *mesh->indices);
    if (!mesh->indices)
        return gltf_no_memory(&load->document, "triangles",
                              (uint64_t)mesh->triangle_count * sizeof *mesh->indices, err);
    return true;
}

// Stores the triangles. `sequence` is the order of the vertices; NULL: 0, 1, 2, … In strips and
// fans, triangles with a repeated vertex are omitted; strips use these to connect their parts.
static void write_triangles(struct mesh *mesh, enum primitive_mode mode, const uint32_t *sequence)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < mesh->triangle_count; i++) {
        uint32_t corners[3], *to = mesh->indices[count];
        triangle_corners(mode, i, corners);
        for (int c = 0; c < 3; c++)
            to[c] = sequence ? sequence[corners[c]] : corners[c];
        bool is_turn = to[0] == to[1] || to[1] == to[2] || to[2] == to[0];
        count += mode == MODE_TRIANGLES || !is_turn;
    }
    mesh->triangle_count = count;
}

static bool read_indexed_triangles(struct gltf_load *load, uint32_t accessor,
                                   enum primitive_mode mode, struct mesh *mesh, struct err *err)
{
    struct accessor_view view;
    if (!accessor_view(&load->document, accessor, &index_rule, &view, err) ||
        !allocate_triangles(load, &view.node, mode, view.count, mesh, err))
        return false;
    struct arena scratch = {0};
    uint32_t *sequence = ARENA_NEW(&scratch, uint32_t, view.count);
    bool ok = sequence ? accessor_read_indices(&view, mesh->vertex_count, "the number of vertices",
                                               sequence, err)
                       : gltf_no_memory(&load->document, "indices", 4 * (uint64_t)view.count, err);
    if (ok)
        write_triangles(mesh, mode, sequence);
    arena_finish(&scratch);
    return ok;
}

static bool read_triangles(struct gltf_load *load, const struct json_node *primitive,
                           enum primitive_mode mode, struct mesh *mesh, struct err *err)
{
    uint32_t accessor;
    if (!gltf_read_index(primitive, "indices", load->document.counts[GLTF_ACCESSORS], &accessor,
                         err))
        return false;
    if (accessor != GLTF_NONE)
        return read_indexed_triangles(load, accessor, mode, mesh, err);
    if (!allocate_triangles(load, primitive, mode, mesh->vertex_count, mesh, err))
        return false;
    write_triangles(mesh, mode, NULL);
    return true;
}

// --- primitives ----------------------------------------------------------------------------------

static bool read_material(struct gltf_load *load, const struct json_node *primitive,
                          uint32_t *material, struct err *err)
{
    uint32_t index;
    if (!gltf_variant_material(load, primitive, &index, err))
        return false;
    if (index != GLTF_NONE) {
        *material = load->first_material + index;
        return true;
    }
    load->tally.primitives_without_material++;
    if (!mesh_default_material(load->scene, load->default_material, false, material, err))
        return false;
    load->default_material = *material;
    return true;
}

// Returns whether the primitive has triangles and positions. If not, counts it as omitted.
static bool is_drawable(struct gltf_tally *tally, enum primitive_mode mode, uint32_t position)
{
    if (mode <= MODE_LINE_STRIP)
        tally->point_and_line_primitives++;
    else if (position == GLTF_NONE)
        tally->primitives_without_positions++;
    return mode > MODE_LINE_STRIP && position != GLTF_NONE;
}

// The deformation of a mesh by a node.
struct deformation {
    const struct gltf_weights *weights;
    const struct gltf_skin *skin; // NULL: none
};

static bool load_primitive(struct gltf_load *load, const struct json_node *primitive,
                           const char *name, const struct deformation *deformation, struct err *err)
{
    if (!json_is_object(primitive->value))
        return node_unexpected(primitive, "an object", err);
    uint32_t accessor_count = load->document.counts[GLTF_ACCESSORS], position;
    uint64_t mode = MODE_TRIANGLES;
    struct json_node attributes;
    if (!gltf_require(primitive, "attributes", err) ||
        !gltf_read_object(primitive, "attributes", &attributes, err) ||
        !gltf_read_index(&attributes, "POSITION", accessor_count, &position, err) ||
        !node_read_integer(primitive, "mode", MODE_POINTS, MODE_TRIANGLE_FAN, &mode, err))
        return false;
    if (!is_drawable(&load->tally, (enum primitive_mode)mode, position))
        return true;
    struct mesh mesh = {.name = name};
    if (!read_vertices(load, &attributes, position, &mesh, err) ||
        !read_triangles(load, primitive, (enum primitive_mode)mode, &mesh, err) ||
        !gltf_morph_apply(load, primitive, deformation->weights, &mesh, err) ||
        (deformation->skin && !gltf_skin_apply(load, primitive, deformation->skin, &mesh, err)) ||
        !read_material(load, primitive, &mesh.material, err))
        return false;
    load->tally.empty_primitives += mesh.triangle_count == 0;
    return mesh.triangle_count == 0 || scene_append_mesh(load->scene, &mesh, NULL, err) ||
           node_prepend(primitive, err);
}

static bool load_primitives(struct gltf_load *load, const struct json_node *node,
                            const struct deformation *deformation, struct err *err)
{
    struct json_node primitives;
    const char *name;
    if (!gltf_require(node, "primitives", err) ||
        !gltf_read_array(node, "primitives", &primitives, err) ||
        !node_check_array(&primitives, 1, GLTF_MAX_COUNT, err) ||
        !gltf_read_name(node, &load->scene->arena, &name, err))
        return false;
    for (size_t i = 0; i < json_array_size(primitives.value); i++) {
        const struct json_node primitive = node_element(&primitives, i);
        if (!scene_goes_on(load->scene, 0, err) ||
            !load_primitive(load, &primitive, name, deformation, err))
            return false;
    }
    return true;
}

static bool is_loaded_so(const struct gltf_mesh_range *range, const struct gltf_weights *weights)
{
    return range->is_loaded && range->weights.count == weights->count &&
           (weights->count == 0 || memcmp(range->weights.values, weights->values,
                                          weights->count * sizeof *weights->values) == 0);
}

bool gltf_mesh_load(struct gltf_load *load, uint32_t index, const struct gltf_weights *weights,
                    const struct gltf_skin *skin, struct gltf_mesh_range *out, struct err *err)
{
    struct gltf_mesh_range *range = &load->meshes[index];
    if (!skin && is_loaded_so(range, weights)) {
        *out = *range;
        return true;
    }
    const struct json_node node = gltf_item(&load->document, GLTF_MESHES, index);
    *out = *range;
    out->first = load->scene->mesh_count;
    out->weights = *weights;
    if (!load_primitives(load, &node, &(struct deformation){weights, skin}, err))
        return false;
    out->count = load->scene->mesh_count - out->first;
    load->loaded_meshes += !range->is_counted;
    range->is_counted = out->is_counted = out->is_loaded = true;
    if (!skin)
        *range = *out;
    progress_report(load->progress, "Loading",
                    (double)load->loaded_meshes / load->document.counts[GLTF_MESHES]);
    return true;
}

// --- memory --------------------------------------------------------------------------------------

// The following functions ignore invalid parts of the file, because the readers above report them.

static uint64_t new_vertex_bytes(const struct gltf_document *document,
                                 const struct json_node *attributes, uint8_t *seen)
{
    static const struct {
        const char *key;
        enum gltf_attribute attribute;
    } keys[] = {
        {"POSITION", GLTF_POSITION},   {"NORMAL", GLTF_NORMAL},       {"TANGENT", GLTF_TANGENT},
        {"TEXCOORD_0", GLTF_TEXCOORD}, {"TEXCOORD_1", GLTF_TEXCOORD}, {"COLOR_0", GLTF_COLOR},
    };
    uint64_t bytes = 0;
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++) {
        struct err dropped = {0};
        uint32_t accessor;
        if (!gltf_read_index(attributes, keys[i].key, document->counts[GLTF_ACCESSORS], &accessor,
                             &dropped) ||
            accessor == GLTF_NONE || seen[accessor] >> keys[i].attribute & 1)
            continue;
        seen[accessor] |= (uint8_t)(1u << keys[i].attribute);
        bytes += (uint64_t)gltf_attribute_count(document, accessor, keys[i].attribute) *
                 gltf_attribute_width(keys[i].attribute) * sizeof(float);
    }
    return bytes;
}

static uint32_t count_corners(const struct gltf_document *document,
                              const struct json_node *primitive, uint32_t position,
                              bool *is_indexed)
{
    struct err dropped = {0};
    struct accessor_view view;
    uint32_t indices;
    if (!gltf_read_index(primitive, "indices", document->counts[GLTF_ACCESSORS], &indices,
                         &dropped))
        return 0;
    *is_indexed = indices != GLTF_NONE;
    if (!*is_indexed)
        return gltf_attribute_count(document, position, GLTF_POSITION);
    return accessor_view(document, indices, &index_rule, &view, &dropped) ? view.count : 0;
}

static void count_primitive(const struct gltf_document *document, const struct json_node *primitive,
                            uint8_t *seen, struct gltf_mesh_needs *needs)
{
    const struct mesh *mesh = NULL;
    struct err dropped = {0};
    struct gltf_tally tally = {0};
    struct json_node attributes;
    uint64_t mode = MODE_TRIANGLES;
    uint32_t position, triangles;
    bool is_indexed;
    if (!json_is_object(primitive->value) ||
        !gltf_read_object(primitive, "attributes", &attributes, &dropped) || !attributes.value ||
        !gltf_read_index(&attributes, "POSITION", document->counts[GLTF_ACCESSORS], &position,
                         &dropped) ||
        !node_read_integer(primitive, "mode", MODE_POINTS, MODE_TRIANGLE_FAN, &mode, &dropped) ||
        !is_drawable(&tally, (enum primitive_mode)mode, position))
        return;
    uint32_t corners = count_corners(document, primitive, position, &is_indexed);
    if (!count_triangles(primitive, (enum primitive_mode)mode, corners, &triangles, &dropped))
        return;
    needs->vertex_bytes += new_vertex_bytes(document, &attributes, seen);
    needs->primitive_bytes += triangles * (uint64_t)sizeof *mesh->indices;
    // All triangles of an indexed strip or fan may be omitted, so it may not become a mesh.
    needs->count += triangles > 0 && (mode == MODE_TRIANGLES || !is_indexed);
}

struct gltf_mesh_needs gltf_mesh_count(const struct gltf_document *document, uint32_t index,
                                       uint8_t *seen)
{
    const struct json_node node = gltf_item(document, GLTF_MESHES, index);
    struct gltf_mesh_needs needs = {0};
    struct json_node primitives;
    struct err dropped = {0};
    if (!gltf_read_array(&node, "primitives", &primitives, &dropped))
        return needs;
    for (size_t i = 0; i < json_array_size(primitives.value); i++) {
        const struct json_node primitive = node_element(&primitives, i);
        count_primitive(document, &primitive, seen, &needs);
    }
    needs.primitive_bytes += needs.count * sizeof(struct mesh);
    return needs;
}
