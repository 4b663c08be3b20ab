// Applies morph targets (glTF 2.0, section 3.7.2.2): weighted displacements of vertex attributes.
#include "scene/gltf/gltf_pose.h"

#include "scene/gltf/gltf_accessor.h"
#include "scene/gltf/gltf_attribute.h"
#include "scene/mesh/mesh_loader.h"
#include <math.h>
#include <string.h>

// Accessor rules of displacements. The displacement of a tangent has no sign, and that of a colour
// may lack alpha.
static const struct accessor_rule rules[GLTF_ATTRIBUTE_COUNT] = {
    [GLTF_POSITION] = {.use = "displacements of POSITION",
                       .components = 3,
                       .types = COMPONENTS_FLOAT,
                       .quantized_types = COMPONENTS_SMALL_SIGNED,
                       .quantized_normalized = COMPONENTS_SMALL_SIGNED,
                       .is_vertex_attribute = true},
    [GLTF_NORMAL] = {.use = "displacements of NORMAL",
                     .components = 3,
                     .types = COMPONENTS_FLOAT,
                     .quantized_normalized = COMPONENTS_SMALL_SIGNED,
                     .is_vertex_attribute = true},
    [GLTF_TANGENT] = {.use = "displacements of TANGENT",
                      .components = 3,
                      .types = COMPONENTS_FLOAT,
                      .quantized_normalized = COMPONENTS_SMALL_SIGNED,
                      .is_vertex_attribute = true},
    [GLTF_TEXCOORD] = {.use = "displacements of TEXCOORD",
                       .components = 2,
                       .types = COMPONENTS_FLOAT,
                       .normalized_types = COMPONENTS_SMALL_SIGNED | COMPONENTS_SMALL_UNSIGNED,
                       .quantized_types = COMPONENTS_SMALL_SIGNED | COMPONENTS_SMALL_UNSIGNED,
                       .is_vertex_attribute = true},
    [GLTF_COLOR] = {.use = "displacements of COLOR",
                    .components = 4,
                    .fewer_components = 3,
                    .types = COMPONENTS_FLOAT,
                    .normalized_types = COMPONENTS_SMALL_SIGNED | COMPONENTS_SMALL_UNSIGNED,
                    .is_vertex_attribute = true},
};

// --- weights -------------------------------------------------------------------------------------

bool gltf_morph_count(struct gltf_load *load, uint32_t mesh, uint32_t *count, struct err *err)
{
    struct gltf_mesh_range *range = &load->meshes[mesh];
    const struct json_node node = gltf_item(&load->document, GLTF_MESHES, mesh);
    struct json_node primitives, targets;
    *count = range->target_count;
    if (range->has_target_count)
        return true;
    if (!gltf_read_array(&node, "primitives", &primitives, err))
        return false;
    for (size_t i = 0; i < json_array_size(primitives.value); i++) {
        const struct json_node primitive = node_element(&primitives, i);
        if (!gltf_read_array(&primitive, "targets", &targets, err))
            return false;
        uint32_t its = (uint32_t)json_array_size(targets.value);
        if (i > 0 && its != *count)
            return node_fail(&primitive, err,
                             "has %u morph targets, but the primitives before have %u", its,
                             *count);
        *count = its;
    }
    range->target_count = *count;
    range->has_target_count = true;
    return true;
}

static bool read_weights(const struct json_node *object, uint32_t count, double *out,
                         struct err *err)
{
    return gltf_read_numbers(object, "weights", count, out, err);
}

bool gltf_morph_weights(struct gltf_load *load, uint32_t node, uint32_t mesh,
                        const struct gltf_node_pose *pose, struct gltf_weights *out,
                        struct err *err)
{
    const struct json_node node_object = gltf_item(&load->document, GLTF_NODES, node);
    const struct json_node mesh_object = gltf_item(&load->document, GLTF_MESHES, mesh);
    uint32_t count;
    *out = (struct gltf_weights){0};
    if (!gltf_morph_count(load, mesh, &count, err))
        return false;
    double *values = ARENA_NEW(&load->document.arena, double, count);
    if (!values)
        return gltf_no_memory(&load->document, "weights", count * sizeof *values, err);
    if (!read_weights(&mesh_object, count, values, err) ||
        !read_weights(&node_object, count, values, err))
        return false;
    if (pose && pose->weights)
        memcpy(values, pose->weights, count * sizeof *values);
    out->values = values;
    for (uint32_t i = 0; i < count; i++)
        if (values[i] != 0)
            out->count = count;
    return true;
}

// --- displacements -------------------------------------------------------------------------------

// An attribute of a mesh while displacements are added to it.
struct sum {
    struct arena arena;
    const struct json_node *targets;
    const struct gltf_weights *weights;
    const char *key;
    enum gltf_attribute attribute;
    uint32_t vertex_count, width;
    double *numbers; // vertex_count * width sums; NULL until a target changes them
    float *scratch;  // room for vertex_count * width numbers
};

static bool open_sum(struct gltf_load *load, const float *base, struct sum *sum, struct err *err)
{
    size_t count = (size_t)sum->vertex_count * sum->width;
    sum->numbers = ARENA_NEW(&sum->arena, double, count);
    sum->scratch = ARENA_NEW(&sum->arena, float, count);
    if (!sum->numbers || !sum->scratch)
        return gltf_no_memory(&load->document, "morph targets",
                              count * (sizeof *sum->numbers + sizeof *sum->scratch), err);
    for (size_t i = 0; i < count; i++)
        sum->numbers[i] = (double)base[i];
    return true;
}

static bool add_target(struct gltf_load *load, uint32_t index, const float *base, struct sum *sum,
                       struct err *err)
{
    const struct json_node target = node_element(sum->targets, index);
    struct accessor_view view;
    uint32_t accessor;
    double weight = sum->weights->values[index];
    if (!json_is_object(target.value))
        return node_unexpected(&target, "an object", err);
    if (!gltf_read_index(&target, sum->key, load->document.counts[GLTF_ACCESSORS], &accessor, err))
        return false;
    if (weight == 0 || accessor == GLTF_NONE)
        return true;
    if (!accessor_view(&load->document, accessor, &rules[sum->attribute], &view, err))
        return false;
    if (view.count != sum->vertex_count)
        return node_fail(&view.node, err, "%u displacements of %s for %u vertices", view.count,
                         sum->key, sum->vertex_count);
    if ((!sum->numbers && !open_sum(load, base, sum, err)) ||
        !accessor_read_floats(&view, sum->scratch, err))
        return false;
    for (uint32_t v = 0; v < view.count; v++)
        for (uint32_t c = 0; c < view.components; c++)
            sum->numbers[(size_t)v * sum->width + c] +=
                weight * (double)sum->scratch[(size_t)v * view.components + c];
    return true;
}

static bool check_numbers(const struct json_node *primitive, const struct sum *sum, struct err *err)
{
    for (size_t i = 0; i < (size_t)sum->vertex_count * sum->width; i++)
        if (!(fabs(sum->numbers[i]) <= SCENE_COORDINATE_MAX))
            return node_fail(primitive, err,
                             "vertex %zu: %s is %g with its morph targets; expected at most %g",
                             i / sum->width, sum->key, sum->numbers[i], SCENE_COORDINATE_MAX);
    return true;
}

static bool store(struct gltf_load *load, const struct sum *sum, float **out, struct err *err)
{
    size_t size = sum->width * sizeof(float);
    float *stored = arena_alloc(&load->scene->arena, sum->vertex_count, size);
    if (!stored)
        return gltf_no_memory(&load->document, "vertices", sum->vertex_count * size, err);
    for (uint32_t v = 0; v < sum->vertex_count; v++) {
        float *to = stored + (size_t)v * sum->width;
        for (uint32_t c = 0; c < sum->width; c++)
            to[c] = (float)sum->numbers[(size_t)v * sum->width + c];
        if (sum->attribute == GLTF_NORMAL || sum->attribute == GLTF_TANGENT)
            mesh_unit_normal(to, to);
        for (uint32_t c = 0; c < sum->width && sum->attribute == GLTF_COLOR; c++)
            to[c] = fminf(fmaxf(to[c], 0.0f), 1.0f); // the specification requires this
    }
    *out = stored;
    return true;
}

// Replaces *values by a new array with the displacements added.
static bool morph(struct gltf_load *load, const struct json_node *primitive, struct sum *sum,
                  float **values, struct err *err)
{
    const float *base = *values;
    if (!base)
        return true;
    sum->width = gltf_attribute_width(sum->attribute);
    bool ok = true;
    for (uint32_t i = 0; ok && i < sum->weights->count; i++)
        ok = add_target(load, i, base, sum, err);
    if (ok && sum->numbers)
        ok = check_numbers(primitive, sum, err) && store(load, sum, values, err);
    arena_finish(&sum->arena);
    return ok;
}

bool gltf_morph_apply(struct gltf_load *load, const struct json_node *primitive,
                      const struct gltf_weights *weights, struct mesh *mesh, struct err *err)
{
    float *values[] = {(float *)mesh->positions, (float *)mesh->normals, (float *)mesh->tangents,
                       (float *)mesh->uvs[0],    (float *)mesh->uvs[1],  (float *)mesh->colors};
    static const struct {
        const char *key;
        enum gltf_attribute attribute;
    } parts[] = {
        {"POSITION", GLTF_POSITION},   {"NORMAL", GLTF_NORMAL},       {"TANGENT", GLTF_TANGENT},
        {"TEXCOORD_0", GLTF_TEXCOORD}, {"TEXCOORD_1", GLTF_TEXCOORD}, {"COLOR_0", GLTF_COLOR},
    };
    struct json_node targets;
    if (weights->count == 0)
        return true;
    if (!gltf_read_array(primitive, "targets", &targets, err))
        return false;
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++) {
        struct sum sum = {
            .targets = &targets,
            .weights = weights,
            .key = parts[i].key,
            .attribute = parts[i].attribute,
            .vertex_count = mesh->vertex_count,
        };
        if (!morph(load, primitive, &sum, &values[i], err))
            return false;
    }
    mesh->positions = (float(*)[3])values[0];
    mesh->normals = (float(*)[3])values[1];
    mesh->tangents = (float(*)[4])values[2];
    mesh->uvs[0] = (float(*)[2])values[3];
    mesh->uvs[1] = (float(*)[2])values[4];
    mesh->colors = (float(*)[4])values[5];
    return true;
}
