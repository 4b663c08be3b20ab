// Loads the images of a glTF document (section 3.8.3): locates them, identifies them by their
// content, and decodes them in parallel.
#include "scene/gltf/gltf_material.h"

#include "base/hash.h"
#include "base/parallel.h"
#include "image/image.h"
#include "scene/core/texture_load.h"
#include "scene/gltf/gltf_accessor.h"
#include "scene/gltf/gltf_buffer.h"
#include <assert.h>
#include <string.h>

// --- bytes ---------------------------------------------------------------------------------------

struct image_source {
    struct json_node node;
    struct file_bytes bytes;
    const char *name; // for messages: a file's path, or the image's place in the document
    bool is_file, is_mislabelled;
};

// Finds the bytes from "uri" or "bufferView", exactly one of which must be given. Files, decoded
// URIs and names are stored in `arena`.
static bool find_bytes(const struct gltf_document *document, struct image_source *source,
                       struct arena *arena, struct err *err)
{
    const struct json_node *node = &source->node;
    const struct json_node uri = node_member(node, "uri"), view = node_member(node, "bufferView");
    uint32_t index;
    if (!uri.value == !view.value)
        return node_fail(node, err, "expected one of \"uri\" and \"bufferView\"");
    if (!gltf_read_index(node, "bufferView", document->counts[GLTF_BUFFER_VIEWS], &index, err))
        return false;
    if (view.value ? !gltf_view_bytes(document, index, &source->bytes, err)
                   : !gltf_uri_load(document, &uri, arena, &source->bytes, &source->name, err))
        return false;
    source->is_file = source->name != NULL;
    if (!source->is_file)
        source->name = arena_printf(arena, "%s: images[%zu]", document->source->path, node->index);
    return source->name || err_memory(err, "a name", 0);
}

// Adds the image's place in the document to a message that begins with a file's name; the name of
// an embedded image already contains this place. Returns false.
static bool fail_image(const struct image_source *source, struct err *err)
{
    return source->is_file ? node_prepend(&source->node, err) : err_false();
}

// Returns the MIME type of a PNG, WebP or JPEG file.
static const char *mime_type(const struct file_bytes *bytes)
{
    static const uint8_t png_magic[4] = {0x89, 'P', 'N', 'G'};
    if (bytes->size >= 4 && memcmp(bytes->data, png_magic, sizeof png_magic) == 0)
        return "image/png";
    const bool is_webp = bytes->size >= 4 && memcmp(bytes->data, "RIFF", 4) == 0;
    return is_webp ? "image/webp" : "image/jpeg";
}

// Checks the format. The content determines it; "mimeType" is only compared with it. A file of
// another format may belong to an extension that is not supported.
static bool check_content(struct image_source *source, struct err *err)
{
    const struct file_bytes *bytes = &source->bytes;
    const char *claimed = NULL;
    if (!node_read_string(&source->node, "mimeType", &claimed, err))
        return false;
    if (!image_has_encoding(bytes->data, bytes->size, source->name)) {
        err_set(err, ERR_INPUT, "%s: expected a PNG, JPEG or WebP file", source->name);
        return fail_image(source, err);
    }
    source->is_mislabelled = claimed && strcmp(claimed, mime_type(bytes)) != 0;
    return true;
}

// --- texels --------------------------------------------------------------------------------------

// An image that one thread decodes into a scene of its own.
struct image_job {
    struct gltf_image *image;
    const struct gltf_document *document;
    const struct progress *progress;
    struct scene scene;
    struct err err;
    bool ok, is_mislabelled, is_strict;
};

// Replaces green by mix(ends[0], ends[1], green), so that a parameter with a minimum and a maximum
// needs only one factor on the texel: in the values of codes, or in the texels. Both belong to the
// job. The replacement commutes with linear interpolation between texels.
static void map_green(struct texture_image *image, const float ends[2])
{
    float *values = (void *)image->values, *floats = (void *)image->texels;
    const float step = ends[1] - ends[0];
    size_t count = (size_t)image->width * image->height;
    for (size_t i = 1; i < 4 * 256 && values; i += 4)
        values[i] = float_from_half(half_from_float(ends[0] + step * values[i]));
    for (size_t i = 1; i < 4 * count && !values; i += 4)
        floats[i] = ends[0] + step * floats[i];
    image->green[0] = ends[0];
    image->green[1] = step;
    image->mean[1] = ends[0] + step * image->mean[1];
    image->hash = hash_bytes(image->hash, ends, 2 * sizeof *ends);
}

static bool decode(struct image_job *job, struct arena *scratch, struct err *err)
{
    struct image_source source = {
        .node = gltf_item(job->document, GLTF_IMAGES, job->image->source),
    };
    uint32_t index;
    struct err reason = {0};
    if (!find_bytes(job->document, &source, scratch, &reason)) {
        if (reason.is_missing)
            return texture_image_missing(&job->scene, &reason, &index, err);
        *err = reason;
        return false;
    }
    if (!check_content(&source, err))
        return false;
    job->is_mislabelled = source.is_mislabelled;
    const struct texture_source texels = {
        .data = source.bytes.data,
        .size = source.bytes.size,
        .name = source.name,
        .is_srgb = job->image->is_srgb,
    };
    if (!texture_image_load(&job->scene, &texels, &index, err))
        return fail_image(&source, err);
    if (job->image->green[0] != 0 || job->image->green[1] != 0)
        map_green(&job->scene.images[index], job->image->green);
    return true;
}

static void run_job(struct image_job *job)
{
    struct arena scratch = {0};
    job->scene = (struct scene){
        .hash = HASH_INIT,
        .progress = job->progress,
        .is_strict = job->is_strict,
    };
    job->err = (struct err){0};
    job->ok = decode(job, &scratch, &job->err);
    arena_finish(&scratch);
}

// --- parallel decoding ---------------------------------------------------------------------------

static void run_jobs(void *context, size_t begin, size_t end, unsigned thread)
{
    struct image_job *jobs = context;
    (void)thread;
    for (size_t i = begin; i < end; i++)
        run_job(&jobs[i]);
}

static bool find_image(const struct scene *scene, uint64_t hash, uint32_t *index)
{
    for (*index = 0; *index < scene->image_count; ++*index)
        if (scene->images[*index].hash == hash)
            return true;
    return false;
}

// Copies the decoded image into the scene, unless the scene has it already.
static bool adopt_image(struct gltf_load *load, struct image_job *job, struct err *err)
{
    struct scene *scene = load->scene;
    const struct texture_image *image = &job->scene.images[0];
    load->tally.mislabelled_images += job->is_mislabelled;
    scene->hash = hash_bytes(scene->hash, &job->scene.hash, sizeof job->scene.hash);
    if (find_image(scene, image->hash, &job->image->index))
        return true;
    size_t bytes = (size_t)texture_image_bytes(image), values_bytes = 256 * sizeof *image->values;
    void *texels = arena_alloc(&scene->arena, bytes, 1);
    void *values = image->values ? arena_alloc(&scene->arena, values_bytes, 1) : NULL;
    const char *name = arena_strdup(&scene->arena, image->name);
    struct texture_image *added = scene_add_image(scene, &job->image->index);
    if (!texels || (image->values && !values) || !name || !added)
        return gltf_no_memory(&load->document, "an image", bytes + values_bytes, err);
    memcpy(texels, image->texels, bytes);
    if (values)
        memcpy(values, image->values, values_bytes);
    *added = *image;
    added->texels = texels;
    added->values = values;
    added->name = name;
    return true;
}

// Releases the images, so that they can be decoded again one at a time, each with all of the
// available memory.
static void release(struct image_job *jobs, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        scene_finish(&jobs[i].scene);
        jobs[i].ok = false;
    }
}

static bool run_round(struct gltf_load *load, struct image_job *jobs, size_t count, struct err *err)
{
    assert(count > 0);
    parallel_for(count, 1, 0, run_jobs, jobs);
    bool ok = true;
    for (size_t i = 0; i < count; i++) {
        if (ok && !jobs[i].ok && jobs[i].err.code != ERR_STOPPED) {
            release(&jobs[i], count - i);
            run_job(&jobs[i]);
        }
        if (ok && !jobs[i].ok)
            *err = jobs[i].err;
        ok = ok && jobs[i].ok && adopt_image(load, &jobs[i], err);
        scene_finish(&jobs[i].scene);
    }
    return ok;
}

bool gltf_images_load(struct gltf_load *load, struct gltf_image *images, size_t count,
                      struct err *err)
{
    size_t threads = cpu_count(), room = count < threads ? count : threads;
    struct image_job *jobs = ARENA_NEW(&load->document.arena, struct image_job, room);
    if (!jobs)
        return gltf_no_memory(&load->document, "images", room * sizeof *jobs, err);
    for (size_t done = 0; done < count;) {
        size_t round = count - done < room ? count - done : room;
        for (size_t i = 0; i < round; i++)
            jobs[i] = (struct image_job){
                .image = &images[done + i],
                .document = &load->document,
                .progress = load->scene->progress,
                .is_strict = load->scene->is_strict,
            };
        if (!run_round(load, jobs, round, err))
            return false;
        done += round;
        progress_report(load->progress, "Decoding images", (double)done / (double)count);
    }
    return true;
}
