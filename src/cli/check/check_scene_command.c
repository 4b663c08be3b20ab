#include "cli/check/check_command.h"

#include "check/check_scene.h"
#include "cli/commands.h"
#include "cli/scene_options.h"
#include "gpu/gpu.h"
#include "render/render.h"
#include "report/json_out.h"
#include "report/text_out.h"
#include <stdio.h>

static void print_text(const struct scene_findings *findings)
{
    for (uint32_t i = 0; i < findings->count; i++) {
        const struct scene_finding *finding = &findings->items[i];
        print_words(finding->name);
        print_line(": ", finding->place);
        print_line("  seen     ", finding->figure);
        print_line("  follows  ", finding->consequence);
        print_line("  remedy   ", finding->remedy);
    }
    if (findings->count == 0)
        puts("Nothing in this scene is stiff or extreme.");
}

static int print_json(const struct options *options, const struct scene_findings *findings)
{
    json_t *list = json_array();
    for (uint32_t i = 0; i < findings->count; i++) {
        const struct scene_finding *finding = &findings->items[i];
        json_array_append_new(
            list,
            json_pack("{s:o, s:o, s:o, s:o, s:o, s:o}", "name", json_words(finding->name), "place",
                      json_words(finding->place), "figure", json_words(finding->figure),
                      "consequence", json_words(finding->consequence), "remedy",
                      json_words(finding->remedy), "share", json_number(finding->share)));
    }
    return command_print(
        json_pack("{s:o, s:o}", "scene", json_words(options->scene.path), "findings", list));
}

static bool gather(const struct options *options, struct gpu *gpu, struct scene *scene,
                   struct arena *arena, struct scene_findings *findings, struct err *err)
{
    uint32_t camera;
    if (!options_load_scene(&options->scene, options->progress, scene, &camera, err) ||
        !gpu_open(&options->device.gpu, gpu, err))
        return false;
    struct renderer_params params = options_renderer_params(&options->device, gpu, scene, camera);
    params.progress = options->progress;
    return check_scene(&params, arena, findings, err);
}

int check_scene_command(const struct options *options)
{
    struct gpu gpu = {0};
    struct scene scene = {0};
    struct arena arena = {0};
    struct scene_findings findings = {0};
    struct err err = {0};
    int code = EXIT_CODE_OK;
    bool ok = gather(options, &gpu, &scene, &arena, &findings, &err);
    progress_end(options->progress);
    if (!ok)
        code = command_fail(&err);
    else if (options->json)
        code = print_json(options, &findings);
    else
        print_text(&findings);
    if (code == EXIT_CODE_OK && findings.count > 0)
        code = EXIT_CODE_CHECK_FAILED;
    arena_finish(&arena);
    scene_finish(&scene);
    gpu_close(&gpu);
    return code;
}
