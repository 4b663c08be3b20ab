// Reads textures and samplers (glTF 2.0, section 3.8) and KHR_texture_transform.
#include "scene/gltf/gltf_material.h"

#include "image/image.h"
#include "scene/core/texture_load.h"
#include <math.h>

// --- sampling ------------------------------------------------------------------------------------

// The codes are those of WebGL. In each list, the specification's default comes first.
struct sampler_code {
    uint32_t code, meaning;
};
#define SAMPLER_CODES_END 0

static const struct sampler_code wraps[] = {
    {10497, TEXTURE_WRAP_REPEAT},
    {33071, TEXTURE_WRAP_CLAMP},
    {33648, TEXTURE_WRAP_MIRROR},
    {SAMPLER_CODES_END, 0},
};
static const struct sampler_code magnifications[] = {
    {9729, 0},
    {9728, TEXTURE_NEAREST},
    {SAMPLER_CODES_END, 0},
};
// The minification filter is only checked, because many samples per pixel have the same effect.
static const struct sampler_code minifications[] = {
    {9729, 0}, {9728, 0}, {9984, 0}, {9985, 0}, {9986, 0}, {9987, 0}, {SAMPLER_CODES_END, 0},
};

static bool read_code(const struct json_node *sampler, const char *key,
                      const struct sampler_code *codes, uint32_t *meaning, struct err *err)
{
    const struct json_node node = node_member(sampler, key);
    uint64_t code = codes[0].code;
    if (!node_read_integer(sampler, key, 0, INT64_MAX, &code, err))
        return false;
    for (const struct sampler_code *known = codes; known->code != SAMPLER_CODES_END; known++) {
        *meaning = known->meaning;
        if (known->code == code)
            return true;
    }
    return node_fail(&node, err, "%llu is not a value of a sampler's \"%s\"; the default is %u",
                     (unsigned long long)code, key, codes[0].code);
}

static bool read_sampler(const struct gltf_document *document, const struct json_node *texture,
                         uint32_t *flags, struct err *err)
{
    uint32_t index, wrap[2], magnification, minification;
    if (!gltf_read_index(texture, "sampler", document->counts[GLTF_SAMPLERS], &index, err))
        return false;
    if (index == GLTF_NONE)
        return true;
    const struct json_node node = gltf_item(document, GLTF_SAMPLERS, index);
    if (!read_code(&node, "wrapS", wraps, &wrap[0], err) ||
        !read_code(&node, "wrapT", wraps, &wrap[1], err) ||
        !read_code(&node, "magFilter", magnifications, &magnification, err) ||
        !read_code(&node, "minFilter", minifications, &minification, err))
        return false;
    *flags |= wrap[0] << TEXTURE_WRAP_S_SHIFT | wrap[1] << TEXTURE_WRAP_T_SHIFT | magnification;
    return true;
}

// Reads a transform. Because v points down, a rotation turns coordinates counter-clockwise, as in
// the text and the first example of the extension.
static bool read_transform(const struct json_node *transform, struct texture *texture,
                           struct err *err)
{
    const struct range any = {-SCENE_COORDINATE_MAX, SCENE_COORDINATE_MAX, false};
    double offset[2] = {0, 0}, scale[2] = {1, 1}, angle = 0;
    if (!gltf_read_numbers(transform, "offset", 2, offset, err) ||
        !gltf_read_numbers(transform, "scale", 2, scale, err) ||
        !node_read_number(transform, "rotation", any, &angle, err))
        return false;
    for (int i = 0; i < 2; i++)
        if (fabs(offset[i]) > any.max || fabs(scale[i]) > any.max)
            return node_fail(transform, err, "offset %g or scale %g is beyond %g", offset[i],
                             scale[i], any.max);
    texture_transform(texture, offset, scale, angle);
    return true;
}

// Reads the set of texture coordinates and their transform. A set given by KHR_texture_transform
// has precedence.
static bool read_coordinates(const struct json_node *info, struct texture *texture, struct err *err)
{
    struct json_node extensions, transform;
    uint64_t set = 0;
    if (!gltf_read_extension(info, "KHR_texture_transform", &extensions, &transform, err) ||
        !node_read_integer(info, "texCoord", 0, INT64_MAX, &set, err) ||
        !node_read_integer(&transform, "texCoord", 0, INT64_MAX, &set, err) ||
        !read_transform(&transform, texture, err))
        return false;
    if (set > 1)
        return node_fail(info, err, "\"texCoord\" is %llu, but only sets 0 and 1 are read",
                         (unsigned long long)set);
    texture->flags |= set == 1 ? TEXTURE_UV1 : 0;
    return true;
}

// --- use -----------------------------------------------------------------------------------------

#define SCALES_MASK ((15u << TEXTURE_MASK_SHIFT) | (15u << TEXTURE_INVERT_SHIFT))
#define CHANNELS_MASK (255u << TEXTURE_CHANNELS_SHIFT)

static uint32_t scaled(const struct texture *texture)
{
    return texture->flags >> TEXTURE_MASK_SHIFT & 15u;
}

static bool is_same_transform(const struct texture *a, const struct texture *b)
{
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 3; j++)
            if (a->transform[i][j] != b->transform[i][j])
                return false;
    return true;
}

// Returns whether one texture lookup serves both: they sample the same image in the same way and
// scale different parameters of the same group.
static bool can_merge(const struct gltf_texture *a, const struct gltf_texture *b)
{
    const uint32_t differing = SCALES_MASK | CHANNELS_MASK;
    return texture_is_scale(&a->texture) && a->image == b->image && a->is_srgb == b->is_srgb &&
           a->green[0] == b->green[0] && a->green[1] == b->green[1] &&
           !(scaled(&a->texture) & scaled(&b->texture)) &&
           (a->texture.flags & ~differing) == (b->texture.flags & ~differing) &&
           is_same_transform(&a->texture, &b->texture);
}

static bool append_texture(struct gltf_material_reader *reader, const struct gltf_texture *texture,
                           struct err *err)
{
    struct gltf_material *state = reader->state;
    for (struct gltf_texture *other = state->first_texture; other; other = other->next)
        if (can_merge(other, texture)) {
            // The flags can be combined, because the channels of parameters that a texture does not
            // scale are 0.
            other->texture.flags |= texture->texture.flags;
            return true;
        }
    struct gltf_document *document = &reader->load->document;
    struct gltf_texture *copy = ARENA_NEW(&document->arena, struct gltf_texture, 1);
    if (!copy)
        return gltf_no_memory(document, "textures", sizeof *copy, err);
    *copy = *texture;
    if (state->last_texture)
        state->last_texture->next = copy;
    else
        state->first_texture = copy;
    state->last_texture = copy;
    return true;
}

bool gltf_texture_scales(const struct gltf_material_reader *reader, uint32_t parameter)
{
    for (struct gltf_texture *t = reader->state->first_texture; t; t = t->next)
        if (texture_scales_parameter(&t->texture, parameter))
            return true;
    return false;
}

// Reads the image of a texture. EXT_texture_webp names one that replaces the other, which is for
// programs without WebP.
static bool read_source(const struct gltf_document *document, const struct json_node *texture,
                        uint32_t *image, struct err *err)
{
    struct json_node extensions, webp;
    uint32_t replacement;
    if (!gltf_read_index(texture, "source", document->counts[GLTF_IMAGES], image, err) ||
        !gltf_read_extension(texture, "EXT_texture_webp", &extensions, &webp, err) ||
        !gltf_read_index(&webp, "source", document->counts[GLTF_IMAGES], &replacement, err))
        return false;
    if (replacement != GLTF_NONE && image_reads_webp())
        *image = replacement;
    return true;
}

bool gltf_texture_read(struct gltf_material_reader *reader, const struct json_node *object,
                       const char *key, const struct gltf_texture_use *use, struct err *err)
{
    const struct gltf_document *document = &reader->load->document;
    struct json_node info;
    uint32_t index;
    if (!gltf_read_object(object, key, &info, err))
        return false;
    if (!info.value)
        return true;
    if (!gltf_require(&info, "index", err) ||
        !gltf_read_index(&info, "index", document->counts[GLTF_TEXTURES], &index, err))
        return false;
    const struct json_node node = gltf_item(document, GLTF_TEXTURES, index);
    struct gltf_texture texture = {
        .is_srgb = use->is_srgb,
        .green = {use->green[0], use->green[1]},
        .texture.flags = use->flags,
    };
    if (!read_source(document, &node, &texture.image, err) ||
        !read_sampler(document, &node, &texture.texture.flags, err) ||
        !read_coordinates(&info, &texture.texture, err))
        return false;
    if (texture.image == GLTF_NONE) {
        // Perhaps only an unsupported extension names the image.
        reader->load->tally.textures_without_image++;
        return true;
    }
    return append_texture(reader, &texture, err);
}

// --- textures of the scene -----------------------------------------------------------------------

// Removes factors without effect: those on a parameter that is 0, and those on 1 - parameter if the
// parameter is 1. Returns false when the texture has no effect left.
static bool keep_what_matters(const struct material *material, struct texture *texture)
{
    if (!texture_is_scale(texture))
        return true;
    uint32_t group = texture_group(texture);
    for (uint32_t i = 0; i < 4; i++) {
        bool is_inverted = texture->flags >> (TEXTURE_INVERT_SHIFT + i) & 1u;
        if (material->parameters[4 * group + i] == (is_inverted ? 1.0f : 0.0f))
            texture->flags &= ~(1u << (TEXTURE_MASK_SHIFT + i) | 1u << (TEXTURE_INVERT_SHIFT + i));
    }
    return scaled(texture) != 0;
}

// The distinct images of the used textures.
struct image_list {
    struct gltf_image *images;
    uint32_t count;
    uint32_t *by_source; // [2 source + is_srgb]: 1 + index in `images`; 0: none
};

static void find_image(struct image_list *list, const struct gltf_texture *texture, uint32_t *index)
{
    // Images with changed green are few, so they are not looked up; the scene stores equal ones
    // once.
    bool is_changed = texture->green[0] != 0 || texture->green[1] != 0;
    uint32_t *known = is_changed ? NULL : &list->by_source[2 * texture->image + texture->is_srgb];
    *index = known && *known ? *known - 1 : list->count;
    if (*index < list->count)
        return;
    if (known)
        *known = list->count + 1;
    list->images[list->count++] = (struct gltf_image){
        .source = texture->image,
        .is_srgb = texture->is_srgb,
        .green = {texture->green[0], texture->green[1]},
    };
}

// Called for each texture that has an effect on a used material.
typedef bool visit_fn(struct gltf_load *load, struct image_list *list, struct material *material,
                      struct gltf_texture *texture, struct err *err);

static bool visit_textures(struct gltf_load *load, struct image_list *list, visit_fn *visit,
                           struct err *err)
{
    for (uint32_t i = 0; i < load->document.counts[GLTF_MATERIALS]; i++) {
        struct gltf_texture *texture = load->materials[i].first_texture;
        struct material *material = &load->scene->materials[load->first_material + i];
        for (; texture && load->materials[i].is_used; texture = texture->next)
            if (keep_what_matters(material, &texture->texture) &&
                !visit(load, list, material, texture, err))
                return false;
    }
    return true;
}

static bool count_texture(struct gltf_load *load, struct image_list *list,
                          struct material *material, struct gltf_texture *texture, struct err *err)
{
    (void)load, (void)material, (void)texture, (void)err;
    list->count++;
    return true;
}

static bool list_texture(struct gltf_load *load, struct image_list *list, struct material *material,
                         struct gltf_texture *texture, struct err *err)
{
    (void)load, (void)material, (void)err;
    find_image(list, texture, &texture->texture.image);
    return true;
}

static bool add_texture(struct gltf_load *load, struct image_list *list, struct material *material,
                        struct gltf_texture *texture, struct err *err)
{
    texture->texture.image = list->images[texture->texture.image].index;
    return material_add_texture(load->scene, material, &texture->texture, err) ||
           err_prepend(err, "%s", load->document.source->path);
}

bool gltf_textures_load(struct gltf_load *load, struct err *err)
{
    struct gltf_document *document = &load->document;
    struct image_list list = {0};
    if (!visit_textures(load, &list, count_texture, err))
        return false;
    uint64_t sources = 2 * (uint64_t)document->counts[GLTF_IMAGES];
    list.images = ARENA_NEW(&document->arena, struct gltf_image, list.count);
    list.by_source = ARENA_NEW(&document->arena, uint32_t, sources);
    if (!list.images || !list.by_source)
        return gltf_no_memory(document, "textures",
                              list.count * sizeof *list.images + sources * sizeof *list.by_source,
                              err);
    list.count = 0;
    return visit_textures(load, &list, list_texture, err) &&
           gltf_images_load(load, list.images, list.count, err) &&
           visit_textures(load, &list, add_texture, err);
}
