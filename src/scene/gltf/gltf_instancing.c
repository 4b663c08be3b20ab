// Adds instances of meshes: single ones, and those of EXT_mesh_gpu_instancing.
#include "scene/gltf/gltf_load.h"

#include "scene/core/affine.h"
#include "scene/gltf/gltf_accessor.h"
#include "scene/gltf/gltf_node.h"
#include "scene/mesh/mesh_loader.h"
#include <string.h>

enum { TRANSLATION, ROTATION, SCALE, ATTRIBUTE_COUNT };

static const struct accessor_rule rules[ATTRIBUTE_COUNT] = {
    [TRANSLATION] = {.use = "TRANSLATION",
                     .components = 3,
                     .types = COMPONENTS_FLOAT,
                     .is_vertex_attribute = true},
    [ROTATION] = {.use = "ROTATION",
                  .components = 4,
                  .types = COMPONENTS_FLOAT,
                  .is_vertex_attribute = true,
                  .normalized_types = COMPONENT_BIT(COMPONENT_I8) | COMPONENT_BIT(COMPONENT_I16)},
    [SCALE] = {.use = "SCALE",
               .components = 3,
               .types = COMPONENTS_FLOAT,
               .is_vertex_attribute = true},
};

// The components of the instances' transforms. The values of components that the file omits are
// NULL.
struct parts {
    struct arena arena;
    uint32_t count;
    float *values[ATTRIBUTE_COUNT];
    struct json_node nodes[ATTRIBUTE_COUNT]; // accessors, for messages
};

bool gltf_instance_add(struct gltf_load *load, const double transform[3][4],
                       struct gltf_mesh_range meshes, struct err *err)
{
    if (!scene_reserve_instances(load->scene, meshes.count))
        return gltf_no_memory(&load->document, "instances",
                              (uint64_t)meshes.count * sizeof(struct instance), err);
    for (uint32_t i = 0; i < meshes.count; i++) {
        struct instance *instance = scene_add_instance(load->scene, NULL);
        instance->mesh = meshes.first + i;
        instance->material = SCENE_NONE;
        memcpy(instance->transform, transform, sizeof instance->transform);
    }
    return true;
}

static bool read_part(struct gltf_load *load, const struct json_node *attributes, int attribute,
                      struct parts *parts, struct err *err)
{
    const struct accessor_rule *rule = &rules[attribute];
    const struct gltf_document *document = &load->document;
    struct accessor_view view;
    uint32_t accessor;
    if (!gltf_read_index(attributes, rule->use, document->counts[GLTF_ACCESSORS], &accessor, err))
        return false;
    if (accessor == GLTF_NONE)
        return true;
    if (!accessor_view(document, accessor, rule, &view, err))
        return false;
    if (parts->count > 0 && view.count != parts->count)
        return node_fail(attributes, err,
                         "%s has %u elements, another attribute has %u; expected the same count",
                         rule->use, view.count, parts->count);
    parts->count = view.count;
    parts->nodes[attribute] = view.node;
    size_t size = rule->components * sizeof(float);
    parts->values[attribute] = arena_alloc(&parts->arena, view.count, size);
    if (!parts->values[attribute])
        return gltf_no_memory(document, "instances", view.count * size, err);
    return accessor_read_floats(&view, parts->values[attribute], err);
}

static bool read_parts(struct gltf_load *load, const struct json_node *attributes,
                       struct parts *parts, struct err *err)
{
    for (int attribute = 0; attribute < ATTRIBUTE_COUNT; attribute++)
        if (!read_part(load, attributes, attribute, parts, err))
            return false;
    if (parts->count == 0)
        return node_fail(attributes, err, "expected TRANSLATION, ROTATION or SCALE");
    return true;
}

// Replaces the default in `out` by element `i` of a component, if the file has that component.
static void take(const struct parts *parts, int attribute, uint32_t i, double *out)
{
    uint32_t n = rules[attribute].components;
    for (uint32_t c = 0; parts->values[attribute] && c < n; c++)
        out[c] = (double)parts->values[attribute][(size_t)i * n + c];
}

static bool add_one(struct gltf_load *load, const struct parts *parts, uint32_t i,
                    const double world[3][4], struct gltf_mesh_range meshes, struct err *err)
{
    double translation[3] = {0, 0, 0}, rotation[4] = {0, 0, 0, 1}, scale[3] = {1, 1, 1};
    double transform[3][4];
    take(parts, TRANSLATION, i, translation);
    take(parts, ROTATION, i, rotation);
    take(parts, SCALE, i, scale);
    if (!gltf_compose(translation, rotation, scale, transform))
        return node_fail(&parts->nodes[ROTATION], err,
                         "element %u: the zero quaternion is not a rotation", i);
    affine_multiply(world, transform, transform);
    return gltf_instance_add(load, transform, meshes, err);
}

uint32_t gltf_instancing_count(const struct gltf_document *document, const struct json_node *node)
{
    struct err dropped = {0};
    struct json_node extensions, instancing, attributes;
    if (!gltf_read_extension(node, "EXT_mesh_gpu_instancing", &extensions, &instancing, &dropped))
        return 0;
    if (!instancing.value)
        return 1;
    if (!gltf_read_object(&instancing, "attributes", &attributes, &dropped))
        return 0;
    for (int i = 0; i < ATTRIBUTE_COUNT; i++) {
        struct accessor_view view;
        uint32_t accessor;
        if (!gltf_read_index(&attributes, rules[i].use, document->counts[GLTF_ACCESSORS], &accessor,
                             &dropped))
            return 0;
        if (accessor != GLTF_NONE)
            return accessor_view(document, accessor, &rules[i], &view, &dropped) ? view.count : 0;
    }
    return 0;
}

bool gltf_instancing_load(struct gltf_load *load, const struct json_node *node,
                          const double world[3][4], struct gltf_mesh_range meshes, bool *found,
                          struct err *err)
{
    struct json_node extensions, instancing, attributes;
    if (!gltf_read_extension(node, "EXT_mesh_gpu_instancing", &extensions, &instancing, err))
        return false;
    *found = instancing.value != NULL;
    if (!*found)
        return true;
    if (!gltf_require(&instancing, "attributes", err) ||
        !gltf_read_object(&instancing, "attributes", &attributes, err))
        return false;
    struct parts parts = {0};
    bool ok = read_parts(load, &attributes, &parts, err);
    uint64_t total = (uint64_t)parts.count * meshes.count;
    if (ok && !scene_reserve_instances(load->scene, total)) {
        err_memory(err, "instances", total * sizeof(struct instance));
        ok = node_prepend(node, err);
    }
    for (uint32_t i = 0; ok && i < parts.count; i++)
        ok = scene_goes_on(load->scene, i, err) && add_one(load, &parts, i, world, meshes, err);
    arena_finish(&parts.arena);
    return ok;
}
