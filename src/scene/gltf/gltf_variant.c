// Chooses the material of a primitive: its own, or that of the selected variant of
// KHR_materials_variants.
#include "scene/gltf/gltf_material.h"

#include <stdio.h>
#include <string.h>

#define EXTENSION "KHR_materials_variants"

struct variant_list {
    struct json_node extensions, extension, variants;
    uint32_t count;
};

static bool open_list(const struct gltf_document *document, struct variant_list *list,
                      struct err *err)
{
    if (!gltf_read_extension(&document->root, EXTENSION, &list->extensions, &list->extension,
                             err) ||
        !gltf_read_array(&list->extension, "variants", &list->variants, err))
        return false;
    list->count = (uint32_t)json_array_size(list->variants.value);
    return true;
}

static bool read_variant_name(const struct variant_list *list, uint32_t index, const char **name,
                              struct err *err)
{
    const struct json_node node = node_element(&list->variants, index);
    if (!json_is_object(node.value))
        return node_unexpected(&node, "an object", err);
    return gltf_require(&node, "name", err) && node_read_string(&node, "name", name, err);
}

// Fails with a list of as many names of variants as fit into a message.
static bool fail_unknown(const struct gltf_load *load, const struct variant_list *list,
                         const char *wish, struct err *err)
{
    char known[256] = "";
    size_t length = 0;
    for (uint32_t i = 0; i < list->count && length < sizeof known; i++) {
        const char *name = NULL;
        if (!read_variant_name(list, i, &name, err))
            return false;
        int written =
            snprintf(known + length, sizeof known - length, "%s\"%s\"", i > 0 ? ", " : "", name);
        length += (size_t)written;
    }
    const char *path = load->document.source->path;
    if (list->count == 0)
        return err_set(err, ERR_USAGE, "%s: has no variant \"%.64s\" and no others", path, wish);
    return err_set(err, ERR_USAGE, "%s: has no variant \"%.64s\", but %s%s", path, wish, known,
                   length < sizeof known ? "" : "…");
}

bool gltf_variant_find(struct gltf_load *load, const char *name, struct err *err)
{
    struct variant_list list;
    load->variant = GLTF_NONE;
    if (!name)
        return true;
    if (!open_list(&load->document, &list, err))
        return false;
    for (uint32_t i = 0; i < list.count; i++) {
        const char *candidate = NULL;
        if (!read_variant_name(&list, i, &candidate, err))
            return false;
        if (strcmp(candidate, name) == 0) {
            load->variant = i;
            return true;
        }
    }
    return fail_unknown(load, &list, name, err);
}

// Reads a mapping. *found becomes whether it contains the selected variant.
static bool read_mapping(const struct gltf_load *load, const struct json_node *mapping,
                         uint32_t variant_count, bool *found, uint32_t *material, struct err *err)
{
    struct json_node variants;
    uint32_t index;
    *found = false;
    if (!json_is_object(mapping->value))
        return node_unexpected(mapping, "an object", err);
    if (!gltf_require(mapping, "material", err) ||
        !gltf_read_index(mapping, "material", load->document.counts[GLTF_MATERIALS], &index, err) ||
        !gltf_require(mapping, "variants", err) ||
        !gltf_read_array(mapping, "variants", &variants, err))
        return false;
    for (size_t i = 0; i < json_array_size(variants.value); i++) {
        const struct json_node node = node_element(&variants, i);
        if (!json_is_integer(node.value) || json_integer_value(node.value) < 0 ||
            json_integer_value(node.value) >= variant_count)
            return node_fail(&node, err, "expected the index of one of %u variants", variant_count);
        if (json_integer_value(node.value) == load->variant) {
            *found = true;
            *material = index;
        }
    }
    return true;
}

bool gltf_variant_material(struct gltf_load *load, const struct json_node *primitive,
                           uint32_t *material, struct err *err)
{
    struct json_node extensions, extension, mappings;
    struct variant_list list;
    if (!gltf_read_index(primitive, "material", load->document.counts[GLTF_MATERIALS], material,
                         err))
        return false;
    if (load->variant != GLTF_NONE) {
        bool found = false;
        if (!open_list(&load->document, &list, err) ||
            !gltf_read_extension(primitive, EXTENSION, &extensions, &extension, err) ||
            !gltf_read_array(&extension, "mappings", &mappings, err))
            return false;
        for (size_t i = 0; i < json_array_size(mappings.value) && !found; i++) {
            const struct json_node mapping = node_element(&mappings, i);
            if (!read_mapping(load, &mapping, list.count, &found, material, err))
                return false;
        }
    }
    if (*material != GLTF_NONE)
        load->materials[*material].is_used = true;
    return true;
}
