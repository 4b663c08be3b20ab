// What tuning found: a table for people, one JSON object for machines.
#include "cli/bench/tune.h"

#include "base/parallel.h"
#include "cli/commands.h"
#include "report/json_out.h"
#include "report/text_out.h"
#include <inttypes.h>
#include <math.h>
#include <stdio.h>

const char *const tune_stage_names[TUNE_STAGES] = {
    [TUNE_WAVE] = "wave",
    [TUNE_WORKGROUP] = "workgroup",
    [TUNE_CONFIRM] = "confirm",
};

static const char *verdict(const struct tune_candidate *candidate)
{
    if (candidate->rounds == 0)
        return "does not fit";
    static const char *const words[] = {
        [CURVE_NOT_TOLD_APART] = "not told apart",
        [CURVE_BETTER] = "faster",
        [CURVE_WORSE] = "slower",
    };
    return words[curve_judge(candidate->speed)];
}

static void print_contest(const struct tune *t, enum tune_stage stage)
{
    const struct tune_contest *c = &t->contests[stage];
    if (c->count == 0)
        return;
    printf("%-9s %10s %9s %7s   speed, beside waves of %u in workgroups of %u\n",
           stage == TUNE_CONFIRM ? "at last" : tune_stage_names[stage], "wave", "workgroup",
           "rounds", c->base.wave, c->base.workgroup);
    for (uint32_t i = 0; i < c->count; i++) {
        const struct tune_candidate *candidate = &c->candidates[i];
        const struct interval *speed = &candidate->speed;
        printf("%-9s %10u %9u %7u", "", candidate->sizes.wave, candidate->sizes.workgroup,
               candidate->rounds);
        if (isfinite(speed->value))
            printf("   %.3f [%.3f, %.3f]", speed->value, speed->low, speed->high);
        printf("   %s\n", verdict(candidate));
    }
}

void tune_print(const struct tune *t)
{
    printf("device    %s (%s)\n", t->gpu.info.name, t->gpu.info.kind);
    for (uint32_t i = 0; i < t->scene_count; i++) {
        const struct gpu_frame *frame = &t->scenes[i].renderer.frame;
        printf("scene     %u x %u, %" PRIu64, frame->width, frame->height, t->samples);
        print_line(" spp: ", t->scenes[i].scene.path);
    }
    for (int stage = 0; stage < TUNE_STAGES; stage++)
        print_contest(t, (enum tune_stage)stage);
    const struct interval *speed = &t->contests[TUNE_CONFIRM].candidates[0].speed;
    if (t->confirmed)
        printf("found     waves of %u paths, workgroups of %u threads: %.3f [%.3f, %.3f] times as "
               "fast as the default, %u and %u\n",
               t->best.wave, t->best.workgroup, speed->value, speed->low, speed->high,
               t->usual.wave, t->usual.workgroup);
    else
        printf("found     nothing that is faster beyond noise than the default: waves of %u paths, "
               "workgroups of %u threads\n",
               t->usual.wave, t->usual.workgroup);
    // On a CPU the others' threads compete with those of the driver, and small waves win by it.
    if (t->gpu.info.is_cpu && t->load > 0.5 * cpu_count())
        printf("note      the machine was busy (load %.1f): what is found holds for such times\n",
               t->load);
    printf("time      %.1f s\n", t->seconds);
    print_line("kept in   ", t->cache.path);
}

static json_t *sizes_json(struct tuned sizes)
{
    return json_pack("{s:I, s:I}", "wave", (json_int_t)sizes.wave, "workgroup",
                     (json_int_t)sizes.workgroup);
}

static json_t *candidates_json(const struct tune *t)
{
    json_t *array = json_array();
    for (int stage = 0; stage < TUNE_STAGES; stage++) {
        const struct tune_contest *c = &t->contests[stage];
        for (uint32_t i = 0; i < c->count; i++) {
            const struct tune_candidate *candidate = &c->candidates[i];
            json_array_append_new(
                array, json_pack("{s:s, s:I, s:I, s:o, s:b, s:i, s:o, s:s}", "stage",
                                 tune_stage_names[stage], "wave", (json_int_t)candidate->sizes.wave,
                                 "workgroup", (json_int_t)candidate->sizes.workgroup, "beside",
                                 sizes_json(c->base), "fits", candidate->fits, "rounds",
                                 (int)candidate->rounds, "speed", json_interval(candidate->speed),
                                 "verdict", verdict(candidate)));
        }
    }
    return array;
}

static json_t *scenes_json(const struct tune *t)
{
    json_t *array = json_array();
    for (uint32_t i = 0; i < t->scene_count; i++) {
        const struct tune_scene *scene = &t->scenes[i];
        char hash[20];
        snprintf(hash, sizeof hash, "%016" PRIx64, scene->image_hash);
        json_array_append_new(
            array, json_pack("{s:o, s:I, s:I, s:s}", "scene", json_words(scene->scene.path),
                             "width", (json_int_t)scene->renderer.frame.width, "height",
                             (json_int_t)scene->renderer.frame.height, "image_hash", hash));
    }
    return array;
}

int tune_print_json(const struct tune *t)
{
    const struct interval none = {NAN, NAN, NAN};
    struct interval speed = t->confirmed ? t->contests[TUNE_CONFIRM].candidates[0].speed : none;
    return json_print(
        json_pack("{s:s, s:o, s:o, s:o, s:o, s:I, s:f, s:o, s:o, s:o, s:o, s:o, s:o}", "version",
                  LAMPYRIS_VERSION, "command", json_words(t->options->command_line), "device",
                  json_words(t->gpu.info.name), "driver", json_words(t->gpu.info.driver), "scenes",
                  scenes_json(t), "spp", (json_int_t)t->samples, "seconds", t->seconds, "load",
                  json_number(t->load), "candidates", candidates_json(t), "usual",
                  sizes_json(t->usual), "found", sizes_json(t->best), "speed", json_interval(speed),
                  "file", json_words(t->cache.path)));
}
