// `lampyris check SCENE`: finds what makes a scene difficult or wrong to render; prints text or
// JSON.
#include "cli/check/check_command.h"

#include "base/file_inputs.h"
#include "base/log.h"
#include "cli/check/scene_check.h"
#include "cli/commands.h"
#include "cli/scene_options.h"
#include "render/render.h"
#include "report/html.h"
#include "report/json_out.h"
#include "report/text_out.h"
#include "scene/json/scene_write.h"
#include <math.h>
#include <stdio.h>

// The default local relMSE for the outlook.
#define USUAL_ERROR 1e-3

// Counts the findings of level `wrong` that remain, in the file of --fix if there is one.
static uint32_t count_wrong(const struct scene_check *check)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < check->findings.count; i++) {
        const struct scene_finding *finding = &check->findings.items[i];
        bool is_fixed = check->options->check.fix && finding->change;
        count += finding->level == FINDING_WRONG && !is_fixed;
    }
    return count;
}

// --- text output ---------------------------------------------------------------------------------

void scene_check_print_share(double share, FILE *out)
{
    if (share == 0.0)
        fputs(", not in the picture", out);
    else if (!isnan(share))
        fprintf(out, share < 0.01 ? ", %.1f %% of the picture" : ", %.0f %% of the picture",
                100.0 * share);
}

static void print_finding(const struct scene_finding *finding)
{
    printf("\n%-8s  ", finding_level_names[finding->level]);
    print_words(finding->name);
    scene_check_print_share(finding->share, stdout);
    putchar('\n');
    print_line("  where   ", finding->place);
    print_line("  seen    ", finding->figure);
    print_line("  so      ", finding->consequence);
    print_line("  remedy  ", finding->remedy);
}

// Returns the number of decimals with which x has at least three significant digits: "410", "41.0",
// "1180".
static int decimals(double x)
{
    return x >= 100.0 ? 0 : x >= 10.0 ? 1 : 2;
}

void scene_check_print_outlook(const struct scene_outlook *outlook, FILE *out)
{
    double memory = (double)outlook->device_bytes / 1048576.0;
    if (isnan(outlook->samples))
        fprintf(out, "the cost of local relMSE %g is not known (%s); %.1f MiB on the device\n",
                outlook->error, outlook->reason, memory);
    else
        fprintf(out,
                "local relMSE %g takes %s %.0f spp, %.*f s of rendering and %.1f MiB on the "
                "device%s%s\n",
                outlook->error, outlook->reason ? "at most" : "about", ceil(outlook->samples),
                decimals(outlook->seconds), outlook->seconds, memory,
                outlook->reason ? "; at most, since " : "", outlook->reason ? outlook->reason : "");
}

static void print_changes(const struct scene_check *check)
{
    uint32_t count = 0;
    if (!check->options->check.fix)
        return;
    putchar('\n');
    for (uint32_t i = 0; i < check->findings.count; i++) {
        const struct scene_finding *finding = &check->findings.items[i];
        if (!finding->change)
            continue;
        count++;
        printf("changed   ");
        print_words(finding->name);
        print_line(": ", finding->change);
    }
    if (count == 0)
        puts("No change was necessary.");
    print_line("wrote     ", check->options->check.fix);
    if (check->is_outside)
        puts("note      the scene names files outside of its folder, so loading it needs "
             "--allow-outside-paths");
}

static void print_text(const struct scene_check *check)
{
    const struct scene_findings *findings = &check->findings;
    uint32_t wrong = 0;
    for (uint32_t i = 0; i < findings->count; i++)
        wrong += findings->items[i].level == FINDING_WRONG;
    print_words(check->scene.path);
    if (findings->count == 0) {
        printf(": nothing found that makes its picture wrong, noisy or slow; ");
        scene_check_print_outlook(&findings->outlook, stdout);
        return print_changes(check);
    }
    printf(": %u finding%s, %u of which make%s the picture wrong\n", findings->count,
           findings->count == 1 ? "" : "s", wrong, wrong == 1 ? "s" : "");
    for (uint32_t i = 0; i < findings->count; i++)
        print_finding(&findings->items[i]);
    printf("\noutlook   ");
    scene_check_print_outlook(&findings->outlook, stdout);
    print_changes(check);
}

// --- JSON output ---------------------------------------------------------------------------------

static json_t *finding_json(const struct scene_finding *finding)
{
    return json_pack("{s:o, s:s, s:o, s:o, s:o, s:o, s:o, s:o}", "name", json_words(finding->name),
                     "level", finding_level_names[finding->level], "place",
                     json_words(finding->place), "figure", json_words(finding->figure),
                     "consequence", json_words(finding->consequence), "remedy",
                     json_words(finding->remedy), "share", json_number(finding->share), "change",
                     finding->change ? json_words(finding->change) : json_null());
}

static int print_json(const struct scene_check *check)
{
    const struct scene_outlook *outlook = &check->findings.outlook;
    const char *fixed = check->options->check.fix;
    json_t *list = json_array();
    for (uint32_t i = 0; i < check->findings.count; i++)
        json_array_append_new(list, finding_json(&check->findings.items[i]));
    return command_print(json_pack(
        "{s:o, s:o, s:o, s:{s:f, s:o, s:o, s:I, s:o}, s:o}", "scene", json_words(check->scene.path),
        "device", json_words(check->gpu.info.name), "findings", list, "outlook", "local_relmse",
        outlook->error, "spp", json_number(outlook->samples), "seconds",
        json_number(outlook->seconds), "device_bytes", (json_int_t)outlook->device_bytes, "reason",
        outlook->reason ? json_words(outlook->reason) : json_null(), "fixed",
        fixed ? json_words(fixed) : json_null()));
}

// --- the command ---------------------------------------------------------------------------------

static bool run(struct scene_check *check, struct err *err)
{
    const struct options *options = check->options;
    const char *fix = options->check.fix;
    uint32_t camera;
    struct scene before;
    if (!options_load_scene(&options->scene, options->progress, &check->scene, &camera, err) ||
        !scene_snapshot(&check->arena, &check->scene, &before, err))
        return false;
    const struct scene_load_params load = options_scene_params(&options->scene, options->progress);
    const struct scene_write_params fixed = {
        .path = fix,
        .load = &load,
        .before = &before,
        .scene = &check->scene,
        .camera = &check->scene.cameras[camera],
        .is_outside = &check->is_outside,
    };
    if ((fix && !scene_write_check(&fixed, err)) || !html_check_file(options->study.report, err) ||
        !file_check_distinct(fix, options->study.report, err) ||
        !(check->gpu.device || gpu_open(&options->device.gpu, &check->gpu, err)))
        return false;
    struct check_scene_params params = {
        .renderer = options_renderer_params(&options->device, &check->gpu, &check->scene, camera),
        .scene = &check->scene,
        .error = options->render.error > 0.0 ? options->render.error : USUAL_ERROR,
        .fixes = fix != NULL,
    };
    params.renderer.progress = options->progress;
    return check_scene(&params, &check->arena, &check->findings, err) &&
           (!fix || scene_write(&fixed, err));
}

// If the device was lost, prepares to run the whole check again, which takes some seconds. Returns
// false if the check failed for another reason, or if the device was reopened as often as --reopen
// permits.
static bool run_again(struct scene_check *check, uint32_t reopened, struct err *err)
{
    struct err failure;
    if (!check->gpu.lost || err->code != ERR_GPU || reopened == check->options->render.reopens)
        return false;
    log_warn("%s: opening the device again, to check from the beginning", err->msg);
    if (!gpu_reopen(&check->gpu, &failure))
        return err_set(err, ERR_GPU, "%s; it could not be opened again: %s", err->msg, failure.msg);
    scene_finish(&check->scene);
    arena_finish(&check->arena);
    check->findings = (struct scene_findings){0};
    return true;
}

int check_scene_command(const struct options *options)
{
    struct scene_check check = {.options = options};
    struct err err = {0};
    int code = EXIT_CODE_OK;
    bool ok = run(&check, &err);
    for (uint32_t i = 0; !ok && run_again(&check, i, &err); i++)
        ok = run(&check, &err);
    progress_end(options->progress);
    if (!ok)
        code = command_fail(&err);
    else if (options->json)
        code = print_json(&check);
    else
        print_text(&check);
    if (ok && options->study.report && !scene_check_report(&check, &err))
        code = command_fail(&err);
    if (code == EXIT_CODE_OK && count_wrong(&check) > 0)
        code = EXIT_CODE_CHECK_FAILED;
    scene_finish(&check.scene);
    gpu_close(&check.gpu);
    arena_finish(&check.arena);
    return code;
}
