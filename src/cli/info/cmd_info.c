// lampyris info: prints the contents of a scene, the kernels that it needs, and the memory that it
// takes.
#include "cli/commands.h"

#include "base/memory.h"
#include "cli/info/device_fits.h"
#include "cli/scene_options.h"
#include "cli/sharing.h"
#include "flatten/geometry.h"
#include "render/render.h"
#include "render/tables/light_choice.h"
#include "report/json_out.h"
#include "report/text_out.h"
#include "shared/types.h"
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

struct info {
    const struct options *options;
    struct scene scene;
    struct gpu gpu;
    struct renderer renderer; // prepared only: it has no device memory
    struct emitter_counts emitters;
    struct geometry geometry; // used with --device all only
    struct device_fits fits;  // results for all devices; empty without --device all
    uint32_t camera;
};

static uint32_t count_materials(const struct scene *scene, uint32_t model)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < scene->material_count; i++)
        count += scene->materials[i].model == model;
    return count;
}

// Counts the materials that are shaded by a simpler model than their own.
static uint32_t count_reduced(const struct scene *scene)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < scene->material_count; i++)
        count += material_shading_model(&scene->materials[i]) != scene->materials[i].model;
    return count;
}

static uint32_t count_lights(const struct scene *scene, uint32_t kind)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < scene->light_count; i++)
        count += scene->lights[i].kind == kind && !scene->lights[i].hidden;
    return count;
}

static void print_materials(const struct scene *scene)
{
    printf("materials %u", scene->material_count);
    const char *separator = ": ";
    for (uint32_t model = 0; model < MATERIAL_MODEL_COUNT; model++) {
        uint32_t count = count_materials(scene, model);
        if (count > 0) {
            printf("%s%u %s", separator, count, material_model_names[model]);
            separator = ", ";
        }
    }
    uint32_t reduced = count_reduced(scene);
    if (reduced > 0)
        printf("; %u of them shaded as %s", reduced, material_model_names[MATERIAL_LAMBERT]);
    putchar('\n');
    if (scene->texture_count > 0)
        printf("textures  %u, of %u images\n", scene->texture_count, scene->image_count);
    for (uint32_t i = 0; i < scene->image_count; i++) {
        const struct texture_image *image = &scene->images[i];
        printf("  %5u x %-5u %s%s ", image->width, image->height,
               image->values ? "8-bit codes" : "floats", image->has_alpha ? ", alpha" : "");
        print_line(" ", image->name);
    }
}

static void print_buffer(const struct planned_buffer *buffer)
{
    printf("  %-12s %12s", buffer->name, memory_print(buffer->bytes * buffer->copies).text);
    if (buffer->parts > 1)
        printf(" (in %u bindings)", buffer->parts);
    puts(buffer->copies > 1 ? " (in several buffers)" : "");
}

// Prints the bounds of the scene relative to the origin of the flat scene, in metres.
static void print_bounds(const struct flat_scene *flat)
{
    double low[3], high[3];
    if (!(flat->bounds_min[0] <= flat->bounds_max[0])) {
        puts("bounds    none");
        return;
    }
    for (int c = 0; c < 3; c++) {
        low[c] = (double)flat->bounds_min[c] / flat->scale;
        high[c] = (double)flat->bounds_max[c] / flat->scale;
    }
    printf("bounds    (%g %g %g) to (%g %g %g), relative to (%g %g %g)\n", low[0], low[1], low[2],
           high[0], high[1], high[2], flat->origin[0], flat->origin[1], flat->origin[2]);
    if (flat->scale != 1.0)
        printf("unit      %g m, in which single precision represents the scene\n",
               1.0 / flat->scale);
}

static void print_text(const struct info *info)
{
    const struct scene *scene = &info->scene;
    const struct flat_scene *flat = &info->renderer.flat;
    const struct settings *s = &scene->settings;
    print_line("", scene->path);
    printf("geometry  %u triangles (%u meshes, %u instances), %u analytic shapes%s\n",
           flat->triangle_count, scene->mesh_count, scene->instance_count, flat->shape_count,
           scene->has_ground ? ", the last of which is the ground that was added" : "");
    if (flat->dropped_degenerate || flat->skipped_instances)
        printf("dropped   %u triangles without area, %u instances with a singular transform\n",
               flat->dropped_degenerate, flat->skipped_instances);
    sharing_print(flat, info->renderer.specialization.features);
    print_bounds(flat);
    print_materials(scene);
    printf("emitters  %u triangles", info->emitters.triangles);
    for (uint32_t kind = 0; kind < SHAPE_KIND_COUNT; kind++)
        if (info->emitters.shapes[kind])
            printf(", %u %s", info->emitters.shapes[kind], geometry_name(1u << kind));
    putchar('\n');
    if (emitters_total(&info->emitters) > 0 && s->nee)
        printf("nee       shadow rays are sent to %s\n",
               light_choice_print(s->light_choice, emitters_total(&info->emitters),
                                  &info->renderer.lamps)
                   .text);
    if (scene->light_count > 0)
        printf("lights    %u point, %u spot, %u directional\n", count_lights(scene, LIGHT_POINT),
               count_lights(scene, LIGHT_SPOT), count_lights(scene, LIGHT_DIRECTIONAL));
    printf("cameras   %u", scene->camera_count);
    for (uint32_t i = 0; i < scene->camera_count; i++) {
        const char *name = scene->cameras[i].name;
        fputs(i ? ", " : ": ", stdout);
        print_words(name && *name ? name : "unnamed");
    }
    printf("\nsettings  %u x %u, %" PRIu64 " spp, %u bounces, seed %u\n", s->width, s->height,
           s->spp, s->max_bounces, s->seed);
    for (uint32_t i = 0; i < scene->note_count; i++)
        print_line("note      ", scene->notes[i]);
    const struct bvh_stats *b = &info->renderer.bvh.stats;
    printf("BVH       %u nodes of %u bytes, depth %u, SAH cost %.2f, %.1f KiB, ", b->node_count,
           (unsigned)bvh_node_bytes(info->renderer.bvh.format), b->depth, b->sah_cost,
           (double)b->bytes / 1024.0);
    if (b->cached_seconds > 0.0)
        printf("from the cache, %.3f s instead of %.3f s\n", b->build_seconds, b->cached_seconds);
    else
        printf("built in %.3f s\n", b->build_seconds);
    printf("device    %s (%s)\n", info->gpu.info.name, info->gpu.info.kind);
    printf("memory    %.1f MiB planned, wave of %u paths%s; at most %.1f MiB per buffer\n",
           (double)info->renderer.plan.total_bytes / 1048576.0, info->renderer.plan.wave_slots,
           memory_plan_in_flight(&info->renderer.plan),
           (double)info->gpu.max_storage_range / 1048576.0);
    for (uint32_t i = 0; i < BINDING_COUNT; i++) {
        const struct planned_buffer *buffer = &info->renderer.plan.buffers[i];
        if (buffer->name)
            print_buffer(buffer);
    }
    device_fits_print(&info->fits);
    printf("features ");
    for (int bit = 0; bit < 32; bit++) {
        const char *name = feature_name(1u << bit);
        if (name && (info->renderer.specialization.features >> bit & 1u))
            printf(" [%s]", name);
    }
    for (uint32_t bit = 1; bit < GEOMETRY_END; bit <<= 1)
        if (info->renderer.specialization.geometry & bit)
            printf(" [%s]", geometry_name(bit));
    if (info->renderer.specialization.parts)
        fputs(" [split buffers]", stdout);
    putchar('\n');
}

static int print_json(const struct info *info)
{
    const struct scene *scene = &info->scene;
    const struct flat_scene *flat = &info->renderer.flat;
    const struct bvh_stats *b = &info->renderer.bvh.stats;
    json_t *buffers = json_object(), *features = json_array(), *left_out = json_array();
    for (uint32_t i = 0; i < BINDING_COUNT; i++) {
        const struct planned_buffer *buffer = &info->renderer.plan.buffers[i];
        json_int_t bytes = (json_int_t)buffer->bytes * buffer->copies;
        if (buffer->name)
            json_object_set_new(buffers, buffer->name, json_integer(bytes));
    }
    for (int bit = 0; bit < 32; bit++) {
        const char *name = feature_name(1u << bit);
        bool kept = info->renderer.specialization.features >> bit & 1u;
        if (name)
            json_array_append_new(kept ? features : left_out, json_string(name));
    }
    json_array_append_new(info->renderer.specialization.parts ? features : left_out,
                          json_string("split buffers"));
    for (uint32_t bit = 1; bit < GEOMETRY_END; bit <<= 1)
        json_array_append_new(info->renderer.specialization.geometry & bit ? features : left_out,
                              json_string(geometry_name(bit)));
    json_t *emitters = json_pack("{s:i}", "triangles", info->emitters.triangles);
    for (uint32_t kind = 0; kind < SHAPE_KIND_COUNT; kind++)
        if (shape_is_emitter(kind))
            json_object_set_new(emitters, geometry_name(1u << kind),
                                json_integer(info->emitters.shapes[kind]));
    json_t *models = json_object();
    for (uint32_t model = 0; model < MATERIAL_MODEL_COUNT; model++)
        json_object_set_new(models, material_model_names[model],
                            json_integer(count_materials(scene, model)));
    json_t *object = json_pack(
        "{s:o, s:i, s:o, s:i, s:i, s:i, s:i, s:o, s:i, s:i, s:i, s:i, s:o, s:{s:i, s:i, "
        "s:i}, s:i, s:o, s:{s:i, s:i, s:f, "
        "s:I, s:f, s:f}, s:{s:o, s:o}, s:{s:I, s:o}, s:i, s:i, s:i, s:i}",
        "scene", json_words(scene->path), "triangles", flat->triangle_count, "shared",
        sharing_json(flat, info->renderer.specialization.features), "shapes", flat->shape_count,
        "meshes", scene->mesh_count, "instances", scene->instance_count, "materials",
        scene->material_count, "models", models, "textures", scene->texture_count, "images",
        scene->image_count, "dropped_degenerate", flat->dropped_degenerate, "skipped_instances",
        flat->skipped_instances, "emitters", emitters, "lights", "point",
        count_lights(scene, LIGHT_POINT), "spot", count_lights(scene, LIGHT_SPOT), "directional",
        count_lights(scene, LIGHT_DIRECTIONAL), "cameras", scene->camera_count, "notes",
        json_word_list(scene->notes, scene->note_count), "bvh", "nodes", b->node_count, "depth",
        b->depth, "sah_cost", b->sah_cost, "bytes", (json_int_t)b->bytes, "build_seconds",
        b->build_seconds, "cached_seconds", b->cached_seconds, "features", "kept", features,
        "left_out", left_out, "memory", "device_bytes", (json_int_t)info->renderer.plan.total_bytes,
        "buffers", buffers, "wave", info->renderer.plan.wave_slots, "waves_in_flight",
        info->renderer.plan.waves, "workgroup", info->renderer.specialization.workgroup,
        "shaded_as_diffuse", count_reduced(scene));
    if (info->fits.count > 0)
        json_object_set_new(object, "devices", device_fits_json(&info->fits));
    return command_print(object);
}

static bool is_of_all_devices(const struct options *options)
{
    const char *device = options->device.gpu.device;
    return device && strcmp(device, "all") == 0;
}

// Plans the render on all devices, with one hierarchy. The device that would be chosen is described
// in detail unless the scene does not fit there.
static bool look_at_devices(struct info *info, struct renderer_params *params, struct err *err)
{
    const struct geometry_params geometry = {
        .scene = &info->scene,
        .bvh = params->bvh,
        .instancing = params->instancing,
        .bvh_cache = params->bvh_cache,
        .progress = params->progress,
        .camera = &info->scene.cameras[info->camera],
    };
    if (!geometry_create(&geometry, &info->geometry, err))
        return false;
    params->geometry = &info->geometry;
    return device_fits_find(info->options, &info->scene, &info->geometry, info->camera, &info->fits,
                            err);
}

static bool gather(const struct options *options, struct info *info, struct err *err)
{
    struct gpu_params of_gpu = options->device.gpu;
    if (is_of_all_devices(options))
        of_gpu.device = NULL;
    if (!options_load_scene(&options->scene, options->progress, &info->scene, &info->camera, err) ||
        !gpu_open(&of_gpu, &info->gpu, err))
        return false;
    struct renderer_params params =
        options_renderer_params(&options->device, &info->gpu, &info->scene, info->camera);
    params.progress = options->progress;
    if (is_of_all_devices(options) && !look_at_devices(info, &params, err))
        return false;
    if (!renderer_prepare(&params, &info->renderer, err))
        return false;
    info->emitters = emitters_count(&info->scene, &info->renderer.flat);
    return true;
}

// Prints on which devices the scene fits if it cannot be described in detail.
static void print_fits(const struct info *info)
{
    if (info->fits.count > 0 && info->options->json)
        command_print(json_pack("{s:o, s:o}", "scene", json_words(info->scene.path), "devices",
                                device_fits_json(&info->fits)));
    else
        device_fits_print(&info->fits);
}

int cmd_info(const struct options *options)
{
    struct info info = {.options = options};
    struct err err = {0};
    int code = EXIT_CODE_OK;
    bool ok = gather(options, &info, &err);
    progress_end(options->progress);
    if (!ok) {
        print_fits(&info);
        code = command_fail(&err);
    } else if (options->json)
        code = print_json(&info);
    else
        print_text(&info);
    renderer_finish(&info.renderer);
    geometry_finish(&info.geometry);
    gpu_close(&info.gpu);
    scene_finish(&info.scene);
    return code;
}
