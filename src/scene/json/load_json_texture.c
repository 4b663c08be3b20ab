// Textures of the materials of a scene file.
#include "scene/json/load_json.h"

#include "base/maths.h"
#include "scene/core/texture_load.h"
#include <math.h>
#include <string.h>

// A texture either scales parameters or has one of these uses.
static const char *const use_names[] = {"normal", "anisotropy", NULL};
static const uint32_t uses[] = {TEXTURE_USE_NORMAL, TEXTURE_USE_ANISOTROPY};

// An entry of the list: how its image is sampled, and which parameters it scales.
struct texture_entry {
    struct texture texture;       // all members but the image
    int channels[GROUP_COUNT][4]; // channel that scales each parameter; -1: none
    bool invert;
    // Whether the entry scales parameters that images store as sRGB-encoded colours, and whether it
    // scales parameters that images store as linear numbers.
    bool has_colors, has_data;
};

// --- sampling ------------------------------------------------------------------------------------

static bool read_pair(const struct json_node *entry, const char *key, double out[2],
                      struct err *err)
{
    const struct json_node node = node_member(entry, key);
    return !node.value || node_numbers(&node, 2, RANGE_COORDINATE, out, err);
}

// Reads a transform as in KHR_texture_transform.
static bool read_transform(const struct json_node *entry, struct texture *texture, struct err *err)
{
    double offset[2] = {0, 0}, scale[2] = {1, 1}, degrees = 0;
    if (!read_pair(entry, "offset", offset, err) || !read_pair(entry, "scale", scale, err) ||
        !node_read_number(entry, "rotation_degrees", RANGE_COORDINATE, &degrees, err))
        return false;
    // The angle is reduced exactly in degrees, so that multiples of 360 are no rotation.
    double angle = fmod(degrees, 360) * DEGREE;
    texture_transform(texture, offset, scale, angle);
    return true;
}

static const char *const wraps[] = {[TEXTURE_WRAP_REPEAT] = "repeat",
                                    [TEXTURE_WRAP_CLAMP] = "clamp",
                                    [TEXTURE_WRAP_MIRROR] = "mirror",
                                    NULL};

// Reads one word for both directions, or a list of two words.
static bool read_wrap(const struct json_node *entry, struct texture *texture, struct err *err)
{
    uint32_t wrap[2] = {TEXTURE_WRAP_REPEAT, TEXTURE_WRAP_REPEAT};
    const struct json_node node = node_member(entry, "wrap");
    if (json_is_array(node.value)) {
        if (!node_check_array(&node, 2, 2, err))
            return false;
        for (size_t i = 0; i < 2; i++) {
            const struct json_node element = node_element(&node, i);
            if (!node_choice(&element, wraps, &wrap[i], err))
                return false;
        }
    } else {
        if (!node_read_choice(entry, "wrap", wraps, &wrap[0], err))
            return false;
        wrap[1] = wrap[0];
    }
    texture->flags |= wrap[0] << TEXTURE_WRAP_S_SHIFT | wrap[1] << TEXTURE_WRAP_T_SHIFT;
    return true;
}

static bool read_sampling(const struct json_node *entry, struct texture *texture, struct err *err)
{
    static const char *const filters[] = {"linear", "nearest", NULL};
    uint32_t filter = 0;
    uint64_t uv_set = 0;
    if (!read_transform(entry, texture, err) || !read_wrap(entry, texture, err) ||
        !node_read_choice(entry, "filter", filters, &filter, err) ||
        !node_read_integer(entry, "uv_set", 0, 1, &uv_set, err))
        return false;
    texture->flags |= filter > 0 ? TEXTURE_NEAREST : 0;
    texture->flags |= uv_set > 0 ? TEXTURE_UV1 : 0;
    return true;
}

// --- use -----------------------------------------------------------------------------------------

// Returns whether a texture can scale the parameter. The index of refraction and the dispersion
// also describe the medium, the cutoff is a threshold, and the normal map has its own scale, so
// textures cannot scale these.
static bool is_scalable(const struct material_parameter *p)
{
    return p->first != PARAMETER_IOR && p->first != PARAMETER_DISPERSION &&
           p->first != PARAMETER_ALPHA_CUTOFF && p->first != PARAMETER_NORMAL_SCALE;
}

static bool find_parameter(const struct json_node *node, const struct material *material,
                           const struct material_parameter **out, struct err *err)
{
    for (uint32_t i = 0; i < material_parameter_count; i++) {
        *out = &material_parameters[i];
        if (strcmp((*out)->name, node->key) != 0)
            continue;
        if (!((*out)->models >> material->model & 1u))
            return node_fail(node, err, "is not a parameter of \"type\": \"%s\"",
                             material_model_names[material->model]);
        return is_scalable(*out) || node_fail(node, err, "cannot be scaled by a texture");
    }
    return node_fail(node, err, "is not a parameter of materials");
}

// Reads "rgb" for a colour, or one channel for a number or for all components of a colour.
static bool read_channels(const struct json_node *node, const struct material_parameter *p,
                          int channels[4], struct err *err)
{
    static const char *const names[] = {"r", "g", "b", "a", "rgb", NULL};
    uint32_t channel;
    if (!node_choice(node, names, &channel, err))
        return false;
    if (channel == 4 && p->count != 3)
        return node_fail(node, err,
                         "\"rgb\" is for colours; expected \"r\", \"g\", \"b\" or \"a\"");
    for (uint32_t i = 0; i < p->count; i++)
        channels[p->first % 4 + i] = channel == 4 ? (int)i : (int)channel;
    return true;
}

// Prepares a parameter for scaling. If its range is 0 to 1 and the file does not set it, it becomes
// 1 (or 0 if inverted), so that the texel is the value. Other parameters keep their default, which
// must not be 0.
static bool begin_parameter(const struct json_node *node, const struct json_node *owner,
                            const struct material_parameter *p, bool invert,
                            struct material *material, struct err *err)
{
    bool is_unit = p->min == 0.0f && p->max == 1.0f;
    if (invert && !is_unit)
        return node_fail(node, err, "\"invert\" is for parameters from 0 to 1");
    if (node_member(owner, p->name).value)
        return true;
    if (!is_unit)
        return p->fallback != 0.0f ||
               node_fail(node, err, "scales \"%s\", which is 0 by default; expected a value for it",
                         p->name);
    for (uint32_t i = 0; i < p->count; i++)
        material->parameters[p->first + i] = invert ? 0.0f : 1.0f;
    return true;
}

static bool read_parameters(const struct json_node *list, const struct json_node *owner,
                            struct material *material, struct texture_entry *entry, struct err *err)
{
    if (!json_is_object(list->value) || json_object_size(list->value) == 0)
        return node_unexpected(list, "an object of channels by parameter", err);
    const char *name;
    json_t *value;
    json_object_foreach(list->value, name, value)
    {
        if (strcmp(name, "comment") == 0)
            continue;
        const struct json_node node = node_member(list, name);
        const struct material_parameter *p = NULL;
        if (!find_parameter(&node, material, &p, err) ||
            !read_channels(&node, p, entry->channels[p->first / 4], err) ||
            !begin_parameter(&node, owner, p, entry->invert, material, err))
            return false;
        bool is_color = p->count == 3 && p->first != PARAMETER_CONDUCTOR_ETA &&
                        p->first != PARAMETER_CONDUCTOR_K;
        // Alpha is linear in every image.
        bool is_alpha = entry->channels[p->first / 4][p->first % 4] == 3;
        entry->has_colors |= is_color && !is_alpha;
        entry->has_data |= !is_color && !is_alpha;
    }
    return true;
}

// --- one entry -----------------------------------------------------------------------------------

static bool load_image(struct json_loader *loader, const struct json_node *node,
                       struct texture_entry *entry, struct err *err)
{
    static const char *const encodings[] = {"linear", "srgb", NULL};
    const struct json_node file = node_member(node, "file");
    uint32_t encoding = entry->has_colors;
    if (!node_read_choice(node, "encoding", encodings, &encoding, err))
        return false;
    if (entry->has_colors && entry->has_data && !node_member(node, "encoding").value)
        return node_fail(
            node, err,
            "scales colours and numbers; expected \"encoding\", the kind of values in the image");
    struct err reason = {0};
    const struct texture_source source = {
        .path = load_json_path(loader, node, "file", &reason),
        .is_srgb = encoding == 1,
    };
    uint32_t *image = &entry->texture.image;
    if (source.path && texture_image_load(loader->scene, &source, image, &reason))
        return true;
    if (source.path)
        node_prepend(&file, &reason);
    if (reason.is_missing)
        return texture_image_missing(loader->scene, &reason, image, err);
    if (err)
        *err = reason;
    return false;
}

// Adds one texture for each group of parameters that the entry scales.
static bool add_scales(struct scene *scene, struct material *material,
                       const struct texture_entry *entry, struct err *err)
{
    for (uint32_t group = 0; group < GROUP_COUNT; group++) {
        struct texture texture = entry->texture;
        uint32_t scales = texture_scales(group, entry->channels[group]);
        uint32_t mask = scales >> TEXTURE_MASK_SHIFT & 15u;
        if (mask == 0)
            continue;
        texture.flags |= scales | (entry->invert ? mask << TEXTURE_INVERT_SHIFT : 0u);
        if (!material_add_texture(scene, material, &texture, err))
            return false;
    }
    return true;
}

static bool add_use(struct scene *scene, const struct json_node *node,
                    const struct json_node *owner, struct material *material,
                    struct texture_entry *entry, struct err *err)
{
    const struct json_node use_node = node_member(node, "use");
    uint32_t use = 0;
    if (!node_read_choice(node, "use", use_names, &use, err))
        return false;
    if (entry->invert)
        return node_fail(&use_node, err, "\"invert\" requires \"parameters\"");
    entry->texture.flags |= uses[use] << TEXTURE_USE_SHIFT;
    if (uses[use] == TEXTURE_USE_ANISOTROPY) {
        if (material->model != MATERIAL_PRINCIPLED)
            return node_fail(
                &use_node, err,
                "\"anisotropy\" needs a material of \"type\": \"principled\"; this one is \"%s\"",
                material_model_names[material->model]);
        if (!node_member(owner, "anisotropic").value)
            material->anisotropic = 1.0f;
    }
    return material_add_texture(scene, material, &entry->texture, err);
}

static bool load_texture(struct json_loader *loader, const struct json_node *node,
                         const struct json_node *owner, struct material *material, struct err *err)
{
    static const char *const required[] = {"file", NULL};
    static const char *const optional[] = {"parameters",       "use",    "encoding", "wrap",
                                           "filter",           "uv_set", "offset",   "scale",
                                           "rotation_degrees", "invert", NULL};
    struct texture_entry entry = {.texture.image = SCENE_NONE};
    memset(entry.channels, -1, sizeof entry.channels);
    if (!node_check_object(node, required, optional, err) ||
        !node_check_either(node, "parameters", "use", err) ||
        !node_read_boolean(node, "invert", &entry.invert, err) ||
        !read_sampling(node, &entry.texture, err))
        return false;
    const struct json_node parameters = node_member(node, "parameters");
    if (parameters.value)
        return read_parameters(&parameters, owner, material, &entry, err) &&
               load_image(loader, node, &entry, err) &&
               add_scales(loader->scene, material, &entry, err);
    return load_image(loader, node, &entry, err) &&
           add_use(loader->scene, node, owner, material, &entry, err);
}

bool load_json_textures(struct json_loader *loader, const struct json_node *owner,
                        struct material *material, struct err *err)
{
    const struct json_node textures = node_member(owner, "textures");
    if (!textures.value)
        return true;
    if (!node_check_array(&textures, 0, UINT32_MAX, err))
        return false;
    for (size_t i = 0; i < json_array_size(textures.value); i++) {
        const struct json_node node = node_element(&textures, i);
        if (!load_texture(loader, &node, owner, material, err))
            return false;
    }
    return true;
}
