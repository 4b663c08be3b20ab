// Reads vertex attributes (glTF 2.0, section 3.7.2.1, with the additions of KHR_mesh_quantization).
#include "scene/gltf/gltf_attribute.h"

#include "scene/gltf/gltf_accessor.h"
#include "scene/mesh/mesh_loader.h"
#include <math.h>

static const struct accessor_rule rules[GLTF_ATTRIBUTE_COUNT] = {
    [GLTF_POSITION] = {.use = "POSITION",
                       .components = 3,
                       .types = COMPONENTS_FLOAT,
                       .quantized_types = COMPONENTS_SMALL_SIGNED | COMPONENTS_SMALL_UNSIGNED,
                       .quantized_normalized = COMPONENTS_SMALL_SIGNED | COMPONENTS_SMALL_UNSIGNED,
                       .is_vertex_attribute = true},
    [GLTF_NORMAL] = {.use = "NORMAL",
                     .components = 3,
                     .types = COMPONENTS_FLOAT,
                     .quantized_normalized = COMPONENTS_SMALL_SIGNED,
                     .is_vertex_attribute = true},
    [GLTF_TANGENT] = {.use = "TANGENT",
                      .components = 4,
                      .types = COMPONENTS_FLOAT,
                      .quantized_normalized = COMPONENTS_SMALL_SIGNED,
                      .is_vertex_attribute = true},
    [GLTF_TEXCOORD] = {.use = "TEXCOORD",
                       .components = 2,
                       .types = COMPONENTS_FLOAT,
                       .normalized_types = COMPONENTS_SMALL_UNSIGNED,
                       .quantized_types = COMPONENTS_SMALL_SIGNED | COMPONENTS_SMALL_UNSIGNED,
                       .quantized_normalized = COMPONENTS_SMALL_SIGNED,
                       .is_vertex_attribute = true},
    [GLTF_COLOR] = {.use = "COLOR",
                    .components = 4,
                    .fewer_components = 3,
                    .types = COMPONENTS_FLOAT,
                    .normalized_types = COMPONENTS_SMALL_UNSIGNED,
                    .is_vertex_attribute = true},
};

// --- corrections of invalid data -----------------------------------------------------------------

static void unit_tangent(float tangent[4])
{
    mesh_unit_normal(tangent, tangent);
    // The specification permits 1 and -1. Quantized values are rounded; 0 counts as 1.
    tangent[3] = tangent[3] < 0 ? -1.0f : 1.0f;
}

// Clamps a colour to [0, 1]. Colours multiply reflectances, so a component above 1 would create
// energy.
static bool clamp_color(float color[4])
{
    bool was_outside = false;
    for (int i = 0; i < 4; i++) {
        was_outside |= !(color[i] >= 0 && color[i] <= 1);
        color[i] = fminf(fmaxf(color[i], 0.0f), 1.0f);
    }
    return was_outside;
}

static void prepare(struct gltf_tally *tally, enum gltf_attribute attribute, uint32_t count,
                    float *values)
{
    for (uint32_t i = 0; i < count; i++) {
        float *at = values + (size_t)i * rules[attribute].components;
        if (attribute == GLTF_NORMAL)
            mesh_unit_normal(at, at);
        else if (attribute == GLTF_TANGENT)
            unit_tangent(at);
        else if (attribute == GLTF_COLOR)
            tally->clamped_colors += clamp_color(at);
    }
}

// --- reading -------------------------------------------------------------------------------------

// Expands `count` elements from three numbers to four, in place, from the last to the first; alpha
// is 1.
static void widen_colors(float *values, uint32_t count)
{
    for (uint32_t i = count; i-- > 0;) {
        for (size_t c = 3; c-- > 0;)
            values[(size_t)i * 4 + c] = values[(size_t)i * 3 + c];
        values[(size_t)i * 4 + 3] = 1.0f;
    }
}

// Decodes an accessor into the scene's arena unless *cached, its entry in load->vectors, is already
// set.
static bool share_values(struct gltf_load *load, uint32_t accessor, enum gltf_attribute attribute,
                         float **cached, struct err *err)
{
    struct accessor_view view;
    if (*cached)
        return true;
    if (!accessor_view(&load->document, accessor, &rules[attribute], &view, err))
        return false;
    size_t size = rules[attribute].components * sizeof(float);
    float *values = arena_alloc(&load->scene->arena, view.count, size);
    if (!values)
        return gltf_no_memory(&load->document, "vertices", view.count * size, err);
    // Texture coordinates that are not finite are common, and harmless unless they are used.
    if (!(attribute == GLTF_TEXCOORD
              ? accessor_read_or_zero(&view, values, &load->tally.infinite_texcoords)
              : accessor_read_floats(&view, values, err)))
        return false;
    if (view.components < rules[attribute].components)
        widen_colors(values, view.count);
    prepare(&load->tally, attribute, view.count, values);
    load->vectors[accessor].count = view.count;
    *cached = values;
    return true;
}

bool gltf_attribute_read(struct gltf_load *load, const struct json_node *attributes,
                         const char *key, enum gltf_attribute attribute, uint32_t count,
                         float **values, struct err *err)
{
    uint32_t accessor;
    *values = NULL;
    if (!gltf_read_index(attributes, key, load->document.counts[GLTF_ACCESSORS], &accessor, err))
        return false;
    if (accessor == GLTF_NONE)
        return true;
    struct gltf_vectors *shared = &load->vectors[accessor];
    if (!share_values(load, accessor, attribute, &shared->values[attribute], err))
        return false;
    if (count > 0 && shared->count != count) {
        const struct json_node node = gltf_item(&load->document, GLTF_ACCESSORS, accessor);
        return node_fail(&node, err, "%u elements of %s for %u positions", shared->count, key,
                         count);
    }
    *values = shared->values[attribute];
    return true;
}

uint32_t gltf_attribute_count(const struct gltf_document *document, uint32_t accessor,
                              enum gltf_attribute attribute)
{
    struct err dropped = {0};
    struct accessor_view view;
    return accessor_view(document, accessor, &rules[attribute], &view, &dropped) ? view.count : 0;
}

uint32_t gltf_attribute_width(enum gltf_attribute attribute)
{
    return rules[attribute].components;
}
