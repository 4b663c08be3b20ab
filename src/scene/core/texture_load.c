// Loads images as textures. Each image is read and decoded once, and its texels are checked.
#include "scene/core/texture_load.h"

#include "base/file.h"
#include "base/hash.h"
#include "image/image.h"
#include <math.h>
#include <string.h>

#define SIDE_MAX 65535 // gpu_texture.size stores each side in 16 bits

// --- texels --------------------------------------------------------------------------------------

static void decode_codes(const uint8_t codes[4], const float values[256][4], float out[4])
{
    for (int c = 0; c < 4; c++)
        out[c] = values[codes[c]][c];
}

// Statistics of the texels of an image.
struct judgement {
    double sum[4];
    float greatest;
    size_t zeroed; // number of invalid texels, which become 0
    bool has_alpha;
};

// Texels scale parameters or are mapped from [0, 1], so negative ones are invalid.
static bool is_usable(const float texel[4])
{
    for (int c = 0; c < 4; c++)
        if (!(texel[c] >= 0 && isfinite(texel[c])))
            return false;
    return true;
}

static void judge_texel(const float texel[4], struct judgement *judgement)
{
    for (int c = 0; c < 4; c++) {
        judgement->sum[c] += (double)texel[c];
        judgement->greatest = fmaxf(judgement->greatest, texel[c]);
    }
    judgement->has_alpha |= texel[3] < 1;
}

// Checks texels and computes their statistics. The values of codes are in [0, 1]. Invalid floats
// become 0, with alpha 1.
static void judge_texels(const struct image_texels *texels, const struct progress *progress,
                         struct judgement *out)
{
    size_t count = (size_t)texels->width * texels->height;
    *out = (struct judgement){0};
    for (size_t i = 0; i < count && !progress_stops_at(progress, i); i++) {
        float texel[4];
        if (texels->values) {
            decode_codes((const uint8_t *)texels->texels + 4 * i, texels->values, texel);
        } else {
            float *given = (float *)texels->texels + 4 * i;
            if (!is_usable(given)) {
                given[0] = given[1] = given[2] = 0;
                given[3] = 1;
                out->zeroed++;
            }
            for (int c = 0; c < 4; c++)
                texel[c] = given[c];
        }
        judge_texel(texel, out);
    }
}

// --- images --------------------------------------------------------------------------------------

struct texture_file {
    const char *name;
    const void *data;
    size_t size;
    uint64_t hash; // hash of the file and of the decoding parameters
};

static bool find_image(const struct scene *scene, uint64_t hash, uint32_t *index)
{
    for (uint32_t i = 0; i < scene->image_count; i++) {
        *index = i;
        if (scene->images[i].hash == hash)
            return true;
    }
    return false;
}

static bool add_image(struct scene *scene, const struct texture_file *file,
                      const struct image_texels *texels, uint32_t *index, struct err *err)
{
    struct judgement judgement;
    judge_texels(texels, scene->progress, &judgement);
    if (!scene_goes_on(scene, 0, err))
        return false;
    size_t count = (size_t)texels->width * texels->height;
    struct texture_image *image = scene_add_image(scene, index);
    const char *name = arena_strdup(&scene->arena, file->name);
    if (!image || !name)
        return err_memory(err, "a texture", sizeof *image);
    *image = (struct texture_image){
        .name = name,
        .width = texels->width,
        .height = texels->height,
        .has_alpha = judgement.has_alpha,
        .greatest = judgement.greatest,
        .zeroed = judgement.zeroed,
        .texels = texels->texels,
        .values = (const float(*)[4])texels->values,
        .is_srgb = texels->is_srgb,
        .green = {0, 1},
        .hash = file->hash,
    };
    for (int c = 0; c < 4; c++)
        image->mean[c] = (float)(judgement.sum[c] / (double)count);
    return judgement.zeroed == 0 ||
           scene_note(scene, "%s: %zu of %zu texels were negative or not finite and are black",
                      name, judgement.zeroed, count) ||
           err_memory(err, "a note", 0);
}

static bool load_file(struct scene *scene, struct texture_file *file, bool is_srgb, uint32_t *index,
                      struct err *err)
{
    const struct image_read_params params = {
        .path = file->name,
        .progress = scene->progress,
        .side_max = SIDE_MAX,
        .is_linear = !is_srgb,
    };
    // If the encoding makes no difference, uses with both encodings share one image.
    const uint8_t decoding = is_srgb && image_has_encoding(file->data, file->size, file->name);
    struct image_texels texels;
    scene->hash = hash_bytes(scene->hash, file->data, file->size);
    file->hash = hash_bytes(hash_bytes(HASH_INIT, file->data, file->size), &decoding, 1);
    return find_image(scene, file->hash, index) ||
           (image_decode_texels(file->data, file->size, &params, &scene->arena, &texels, err) &&
            add_image(scene, file, &texels, index, err));
}

bool texture_image_load(struct scene *scene, const struct texture_source *source, uint32_t *index,
                        struct err *err)
{
    struct texture_file file = {
        .name = source->name   ? source->name
                : source->path ? source->path
                               : "image",
        .data = source->data,
        .size = source->size,
    };
    struct arena scratch = {0};
    bool ok = true;
    if (source->path) {
        struct file_bytes bytes;
        ok = file_read(&scratch, source->path, 0, &bytes, err);
        if (ok) {
            file.data = bytes.data;
            file.size = bytes.size;
        }
    }
    ok = ok && load_file(scene, &file, source->is_srgb, index, err);
    arena_finish(&scratch);
    return ok;
}

// --- missing images ------------------------------------------------------------------------------

static const float missing_color[3] = {1.0f, 0.0f, 0.5f};

bool texture_image_missing(struct scene *scene, const struct err *reason, uint32_t *index,
                           struct err *err)
{
    if (scene->is_strict) {
        if (err)
            *err = *reason;
        return false;
    }
    uint64_t hash =
        hash_bytes(hash_bytes(HASH_INIT, "missing", 7), reason->msg, strlen(reason->msg));
    scene->hash = hash_bytes(scene->hash, &hash, sizeof hash);
    if (find_image(scene, hash, index))
        return true;
    struct texture_image *image = scene_add_image(scene, index);
    float(*texel)[4] = arena_alloc(&scene->arena, 1, sizeof *texel);
    const char *name = arena_strdup(&scene->arena, reason->msg);
    if (!image || !texel || !name)
        return err_memory(err, "a texture", sizeof *image);
    *image = (struct texture_image){
        .name = name,
        .width = 1,
        .height = 1,
        .is_missing = true,
        .texels = texel,
        .mean = {missing_color[0], missing_color[1], missing_color[2], 1},
        .greatest = 1,
        .hash = hash,
    };
    memcpy(texel, image->mean, sizeof *texel);
    return true;
}

bool material_mark_missing(const struct scene *scene, struct material *material)
{
    bool any = false;
    for (uint32_t i = 0; i < material->texture_count; i++)
        any |= scene->images[scene->textures[material->first_texture + i].image].is_missing;
    if (!any)
        return false;
    const char *name = material->name;
    material_init(material);
    material->name = name;
    memcpy(material->base_color, missing_color, sizeof missing_color);
    return true;
}

bool material_is_missing(const struct material *material)
{
    return memcmp(material->base_color, missing_color, sizeof missing_color) == 0;
}

// --- textures ------------------------------------------------------------------------------------

// Adds a note if the image has texels above 1, which lib/texture.glsl clamps so that parameters
// stay in their range.
static bool note_if_cut(struct scene *scene, const struct material *material,
                        const struct texture *texture, struct err *err)
{
    const struct texture_image *image = &scene->images[texture->image];
    bool is_cut = texture_is_scale(texture) && texture_group(texture) != GROUP_EMISSION &&
                  image->greatest > 1;
    return !is_cut ||
           scene_note(scene, "material \"%s\": texels of %s above 1 count as 1", material->name,
                      image->name) ||
           err_memory(err, "a note", 0);
}

bool material_add_texture(struct scene *scene, struct material *material,
                          const struct texture *texture, struct err *err)
{
    if (material->texture_count == 0)
        material->first_texture = scene->texture_count;
    if (material->first_texture + material->texture_count != scene->texture_count)
        return err_set(err, ERR_BUG, "material \"%s\": its textures are not the last ones",
                       material->name);
    struct texture *added = scene_add_texture(scene, NULL);
    if (!added)
        return err_memory(err, "a texture", sizeof *added);
    *added = *texture;
    material->texture_count++;
    return note_if_cut(scene, material, texture, err);
}

void texture_texel(const struct texture_image *image, uint64_t index, float out[4])
{
    if (image->values)
        decode_codes((const uint8_t *)image->texels + 4 * index, image->values, out);
    else
        memcpy(out, (const float *)image->texels + 4 * index, 4 * sizeof *out);
}

uint32_t texture_scales(uint32_t group, const int channel[4])
{
    uint32_t flags = TEXTURE_USE_SCALE << TEXTURE_USE_SHIFT | group << TEXTURE_GROUP_SHIFT;
    for (uint32_t i = 0; i < 4; i++)
        if (channel[i] >= 0)
            flags |= 1u << (TEXTURE_MASK_SHIFT + i) | (uint32_t)channel[i]
                                                          << (TEXTURE_CHANNELS_SHIFT + 2 * i);
    return flags;
}

void texture_transform(struct texture *texture, const double offset[2], const double scale[2],
                       double angle)
{
    const double rotation[2][2] = {{cos(angle), sin(angle)}, {-sin(angle), cos(angle)}};
    for (int i = 0; i < 2; i++) {
        for (int j = 0; j < 2; j++)
            texture->transform[i][j] = (float)(rotation[i][j] * scale[j]);
        texture->transform[i][2] = (float)offset[i];
    }
}
