// Returns the results of a render: layers, files, and a list of the renderer's parts.
#include "library/library.h"

#include "base/clock.h"
#include "base/file.h"
#include "image/image.h"
#include "output/layers.h"
#include "output/metadata.h"
#include "render/parts.h"
#include <stdio.h>
#include <string.h>

// --- layers --------------------------------------------------------------------------------------

static void list_layers(const struct lampyris_render *render, struct image_layer *out,
                        uint32_t *count)
{
    struct layers others;
    const struct film_image *film = &render->job.film;
    layers_list(film, render->wishes.aovs, &others);
    out[0] = (struct image_layer){"radiance", film->mean, NULL, IMAGE_LAYER_FLOAT};
    memcpy(out + 1, others.list, others.count * sizeof *out);
    *count = others.count + 1;
}

static uint32_t channel_count(const struct image_layer *layer)
{
    uint32_t count = 0;
    while (layer->channels && layer->channels[count])
        count++;
    return layer->channels ? count : 3;
}

static const char *channel_names(const struct image_layer *layer, struct arena *arena)
{
    const char *names = layer->channels ? layer->channels[0] : "R,G,B";
    for (uint32_t i = 1; layer->channels && names && i < channel_count(layer); i++)
        names = arena_printf(arena, "%s,%s", names, layer->channels[i]);
    return names;
}

static bool layer_at(struct lampyris_render *render, uint32_t index, struct lampyris_layer *out,
                     struct err *err)
{
    struct image_layer layers[LAYERS_MAX + 1];
    uint32_t count;
    if (!render_need_film(render, err))
        return false;
    list_layers(render, layers, &count);
    if (index >= count)
        return err_set(err, ERR_USAGE, "there is no layer %u; expected an index below %u", index,
                       count);
    const struct lampyris_layer layer = {
        .name = layers[index].name,
        .channel_count = channel_count(&layers[index]),
        .channels = channel_names(&layers[index], &render->texts),
        .is_integer = layers[index].type == IMAGE_LAYER_UINT,
    };
    return layer.channels ? library_give(out, &layer, sizeof layer, err)
                          : err_memory(err, "names of channels", 64);
}

enum lampyris_status lampyris_render_layer(struct lampyris_render *render, uint32_t index,
                                           struct lampyris_layer *out)
{
    struct lampyris_context *context = render->context;
    return library_enter(context)
               ? library_leave(context, layer_at(render, index, out, &context->err))
               : LAMPYRIS_INPUT;
}

static bool fail_unknown_layer(const char *name, const struct image_layer *layers, uint32_t count,
                               struct err *err)
{
    char known[256] = "";
    for (uint32_t i = 0; i < count; i++) {
        size_t used = strlen(known);
        snprintf(known + used, sizeof known - used, "%s%s", i ? ", " : "", layers[i].name);
    }
    return err_set(err, ERR_USAGE, "the render has no layer \"%s\"; expected one of %s", name,
                   known);
}

static void copy_layer(const struct image_layer *layer, uint32_t width, uint32_t height, char *to,
                       size_t pixel_stride, size_t row_stride)
{
    size_t bytes = channel_count(layer) * sizeof(float);
    size_t pixel = pixel_stride ? pixel_stride : bytes;
    size_t row = row_stride ? row_stride : pixel * width;
    const char *from = layer->values;
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = 0; x < width; x++)
            memcpy(to + y * row + x * pixel, from + ((size_t)y * width + x) * bytes, bytes);
}

static bool read_layer(struct lampyris_render *render, const char *name, void *to,
                       size_t pixel_stride, size_t row_stride, struct err *err)
{
    struct image_layer layers[LAYERS_MAX + 1];
    uint32_t count, i = 0;
    if (!render_need_film(render, err))
        return false;
    list_layers(render, layers, &count);
    while (i < count && strcmp(layers[i].name, name) != 0)
        i++;
    if (i == count)
        return fail_unknown_layer(name, layers, count, err);
    const struct film_image *film = &render->job.film;
    copy_layer(&layers[i], film->width, film->height, to, pixel_stride, row_stride);
    return true;
}

enum lampyris_status lampyris_render_read(struct lampyris_render *render, const char *layer,
                                          void *to, size_t pixel_stride, size_t row_stride)
{
    struct lampyris_context *context = render->context;
    return library_enter(context)
               ? library_leave(context, read_layer(render, layer, to, pixel_stride, row_stride,
                                                   &context->err))
               : LAMPYRIS_INPUT;
}

// --- files ---------------------------------------------------------------------------------------

static bool describe(const struct lampyris_render *render, float exposure, struct arena *arena,
                     struct metadata *out, struct err *err)
{
    const struct job *job = &render->job;
    const struct scene_load_params load = {0};
    const char *repeat = repeat_command(render, arena);
    const struct metadata_params params = {
        .job = job,
        .load = &load,
        .settings = &render->adapted.settings,
        .film = &job->film,
        .error = &job->error,
        .seconds = &job->seconds,
        .ended_by = job_ended_by(job),
        .command = "liblampyris",
        .repeat = repeat,
        .samples = job_samples(job),
        .image_hash = job->image_hash,
        .exposure = exposure,
        .camera = render->wishes.camera,
    };
    return metadata_make(&params, arena, out, err);
}

static bool write_picture(struct lampyris_render *render, const char *path, bool half_float,
                          struct arena *arena, struct err *err)
{
    const struct film_image *film = &render->job.film;
    const struct settings *settings = &render->adapted.settings;
    const struct image image = {film->width, film->height, film->mean};
    float exposure =
        settings->exposure_is_auto ? image_measure_exposure(&image) : settings->exposure;
    struct metadata metadata;
    struct layers layers = {0};
    layers_list(film, render->wishes.aovs, &layers);
    if (!describe(render, exposure, arena, &metadata, err))
        return false;
    bool has_layers = path_has_extension(path, "exr");
    const struct image_write_params params = {
        .path = path,
        .image = &image,
        .layers = layers.list,
        .layer_count = has_layers ? layers.count : 0,
        .attributes = metadata.list,
        .attribute_count = metadata.count,
        .half_float = half_float,
        .exposure_stops = exposure,
        .tone = (enum tone_curve)settings->tone_curve,
    };
    return image_write(&params, err);
}

static bool save(struct lampyris_render *render, const char *path,
                 const struct lampyris_save_params *params, struct err *err)
{
    struct lampyris_save_params given;
    struct arena scratch = {0};
    if (!library_take(&given, sizeof given, params, "lampyris_save_params", err) ||
        !image_check_format(path, err) || !render_need_film(render, err))
        return false;
    uint64_t start_ns = clock_ns();
    bool ok = write_picture(render, path, given.half_float, &scratch, err);
    job_add_time(&render->job, JOB_WRITING, start_ns);
    arena_finish(&scratch);
    return ok;
}

enum lampyris_status lampyris_render_save(struct lampyris_render *render, const char *path,
                                          const struct lampyris_save_params *params)
{
    struct lampyris_context *context = render->context;
    if (!library_enter(context))
        return LAMPYRIS_INPUT;
    bool ok = save(render, path, params, &context->err);
    if (!ok)
        err_locate(&context->err, path, "");
    return library_leave(context, ok);
}

static bool write_checkpoint(struct lampyris_render *render, const char *path, struct err *err)
{
    if (render->is_over)
        return err_set(err, ERR_GPU, "%s: the device failed, so no checkpoint can be made", path);
    return job_checkpoint_write(&render->job, path, err);
}

enum lampyris_status lampyris_render_checkpoint(struct lampyris_render *render, const char *path)
{
    struct lampyris_context *context = render->context;
    if (!library_enter(context))
        return LAMPYRIS_INPUT;
    bool ok = write_checkpoint(render, path, &context->err);
    if (!ok)
        err_locate(&context->err, path, "");
    return library_leave(context, ok);
}

enum lampyris_status lampyris_render_repeat(struct lampyris_render *render, const char **command)
{
    struct lampyris_context *context = render->context;
    *command = "";
    if (!library_enter(context))
        return LAMPYRIS_INPUT;
    bool ok = render_need_film(render, &context->err);
    const char *found = ok ? repeat_command(render, &render->texts) : NULL;
    *command = found ? found : "";
    return library_leave(context, ok);
}

// --- parts ---------------------------------------------------------------------------------------

struct part_list {
    struct lampyris_render *render;
    uint32_t capacity;
    bool failed;
};

static void add_part(void *context, const struct part *part)
{
    struct part_list *list = context;
    struct lampyris_render *render = list->render;
    struct lampyris_part *added = arena_append(&render->arena, &render->parts, &render->part_count,
                                               &list->capacity, sizeof *added, NULL);
    list->failed |= !added;
    if (!added)
        return;
    *added = (struct lampyris_part){
        .kind = part_kind_name(part->kind),
        .name = part->name,
        .reason = part->is_kept ? "" : part_reason(&render->job.renderer, part),
        .bytes = part->bytes,
        .is_left_out = !part->is_kept,
    };
}

static bool part_at(struct lampyris_render *render, uint32_t index, struct lampyris_part *out,
                    struct err *err)
{
    struct part_list list = {.render = render};
    if (render->part_count == 0)
        parts_visit(&render->job.renderer, add_part, &list);
    if (list.failed) {
        render->part_count = 0;
        return err_memory(err, "a list of parts", sizeof *render->parts);
    }
    if (index >= render->part_count)
        return err_set(err, ERR_USAGE, "there is no part %u; expected an index below %u", index,
                       render->part_count);
    return library_give(out, &render->parts[index], sizeof *out, err);
}

enum lampyris_status lampyris_render_part(struct lampyris_render *render, uint32_t index,
                                          struct lampyris_part *out)
{
    struct lampyris_context *context = render->context;
    return library_enter(context)
               ? library_leave(context, part_at(render, index, out, &context->err))
               : LAMPYRIS_INPUT;
}
