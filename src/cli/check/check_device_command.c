// `lampyris check` without a scene: runs the table of cases on a device.
#include "cli/check/check_command.h"

#include "base/clock.h"
#include "base/log.h"
#include "base/suggest.h"
#include "cli/check/device_check.h"
#include "cli/commands.h"
#include "report/html.h"
#include <stdio.h>
#include <string.h>

size_t device_check_outcomes(const struct device_check *d, enum check_outcome outcome)
{
    size_t count = 0;
    for (size_t i = 0; i < d->done; i++)
        count += d->rows[i].result.outcome == outcome;
    return count;
}

// Returns whether to run a case. A case that is named is run even if it takes long.
static bool is_wanted(const struct options *options, const struct check_group *group,
                      const struct check_case *this_case)
{
    const char *only = options->check.only;
    bool by_name = only && strcmp(only, group->name) != 0;
    if (options->check.reproducible)
        return group == &check_bits;
    return check_is_wanted(group, this_case, only) &&
           (!this_case->is_long || options->check.longer || options->check.list || by_name);
}

// Reports that --only names neither a group nor a case.
static bool fail_no_case(const char *name, struct err *err)
{
    struct suggestion suggestion = {.wanted = name};
    for (size_t g = 0; g < check_group_count; g++) {
        suggest_offer(&suggestion, check_groups[g]->name);
        for (size_t i = 0; i < check_groups[g]->count; i++)
            suggest_offer(&suggestion, check_groups[g]->cases[i].name);
    }
    if (suggestion.nearest)
        return err_set(err, ERR_USAGE,
                       "--only %s: there is no such group or case; did you mean \"%s\"?", name,
                       suggestion.nearest);
    return err_set(err, ERR_USAGE,
                   "--only %s: there is no such group or case; see lampyris check --list", name);
}

static bool choose_cases(struct device_check *d, struct err *err)
{
    size_t most = 0;
    for (size_t g = 0; g < check_group_count; g++)
        most += check_groups[g]->count;
    d->rows = ARENA_NEW(&d->arena, struct check_row, most);
    if (!d->rows)
        return err_memory(err, "the cases", most * sizeof *d->rows);
    for (size_t g = 0; g < check_group_count; g++)
        for (size_t i = 0; i < check_groups[g]->count; i++)
            if (is_wanted(d->options, check_groups[g], &check_groups[g]->cases[i]))
                d->rows[d->count++] = (struct check_row){.group = check_groups[g],
                                                         .this_case = &check_groups[g]->cases[i]};
    if (d->count > 0)
        return true;
    return fail_no_case(d->options->check.only, err);
}

// Opens the device. It is opened again if a case has lost it.
static bool provide_device(struct device_check *d, struct err *err)
{
    if (d->gpu.lost)
        return gpu_reopen(&d->gpu, err);
    return d->gpu.device || gpu_open(&d->options->device.gpu, &d->gpu, err);
}

static bool run_case(struct device_check *d, const struct check *check, struct check_row *row,
                     struct err *err)
{
    bool was_lost = false;
    for (;;) {
        if (!provide_device(d, err) || !check_run(check, row->this_case, &row->result, err))
            return false;
        struct check_result *result = &row->result;
        if (was_lost && !*result->why)
            snprintf(result->why, sizeof result->why,
                     "the device was lost and has been opened again");
        // The number of repetitions, over all cases together, is limited like that of a render
        // (--reopen).
        if (!result->is_lost || d->reopened == d->options->render.reopens)
            return true;
        d->reopened++;
        was_lost = true;
    }
}

static bool run_cases(struct device_check *d, struct err *err)
{
    // Renders inside of cases do not report progress, because the run reports the number of
    // finished cases.
    const struct progress *listener = d->options->progress;
    const struct progress quiet = {.should_stop = listener->should_stop,
                                   .context = listener->context};
    const struct check check = {.gpu = &d->gpu,
                                .longer = d->options->check.longer,
                                .arena = d->options->study.report ? &d->arena : NULL,
                                .progress = &quiet};
    uint64_t start = clock_ns();
    bool ok = true;
    for (size_t i = 0; i < d->count && ok; i++) {
        struct check_row *row = &d->rows[i];
        progress_report(listener, "Checking", (double)i / (double)d->count);
        ok = run_case(d, &check, row, err);
        if (!ok)
            break;
        d->done++;
        progress_pause(listener);
        if (!d->options->json && !d->options->quiet)
            device_check_print_row(d, i);
    }
    d->seconds = clock_seconds_since(start);
    return ok || err->code == ERR_STOPPED;
}

// Returns an exit code for failure if cases were not run because the device remained lost;
// otherwise EXIT_CODE_OK.
static int fail_if_lost(const struct device_check *d)
{
    struct err err;
    size_t count = 0, last = 0;
    for (size_t i = 0; i < d->done; i++) {
        count += d->rows[i].result.is_lost;
        last = d->rows[i].result.is_lost ? i : last;
    }
    if (count == 0)
        return EXIT_CODE_OK;
    err_set(&err, ERR_GPU, "%s; %zu case%s not run", d->rows[last].result.why, count,
            count == 1 ? " was" : "s were");
    return command_fail(&err);
}

static int tell(struct device_check *d, struct err *err)
{
    int code = EXIT_CODE_OK;
    if (d->options->json)
        code = command_print(device_check_json(d));
    else if (d->options->check.list)
        device_check_print_list(d);
    else
        device_check_print_end(d);
    if (d->options->study.report && !device_check_report(d, err))
        code = command_fail(err);
    if (code == EXIT_CODE_OK && device_check_outcomes(d, CHECK_FAILED) > 0)
        code = EXIT_CODE_CHECK_FAILED;
    return code == EXIT_CODE_OK ? fail_if_lost(d) : code;
}

int check_device_command(const struct options *options)
{
    struct device_check d = {.options = options};
    struct err err = {0}, of_report = {0};
    // Warnings about extreme scenes are hidden, because these scenes are extreme on purpose.
    if (!options_given(options, OPTION_LOG_LEVEL))
        log_set_level(LOG_ERROR);
    bool ok = html_check_file(options->study.report, &err) && choose_cases(&d, &err) &&
              (options->check.list || run_cases(&d, &err));
    progress_end(options->progress);
    // If the device is lost for good, the results so far are printed nevertheless.
    int code = ok || d.done > 0 ? tell(&d, &of_report) : EXIT_CODE_OK;
    if (!ok)
        code = command_fail(&err);
    gpu_close(&d.gpu);
    arena_finish(&d.arena);
    return code;
}
