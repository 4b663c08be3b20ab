#include "cli/commands.h"

#include "base/file.h"
#include "base/log.h"
#include "cli/bench/bench.h"
#include "report/html.h"
#include "report/json_out.h"

// Measures. If the device fails, the results so far are reported nevertheless.
static bool measure(struct bench *b, struct err *err)
{
    if (b->options->bench.kernel ? bench_measure_kernel(b, err) : bench_measure(b, err))
        return true;
    if (err->code != ERR_GPU || b->repeats_done == 0)
        return false;
    log_warn("the device failed: %u of %u repetitions were complete and are reported",
             b->repeats_done, b->repeats);
    b->failure = *err;
    b->stopped = true;
    return true;
}

static bool run(struct bench *b, struct err *err)
{
    const struct options *options = b->options;
    if (options->bench.kernel && !bench_check_kernel(&options->bench, err))
        return false;
    if (options->study.report && !file_make_folder(options->study.report, err))
        return false;
    if (!bench_prepare(b, err) || (options->bench.baseline && !bench_load_baseline(b, err)))
        return false;
    if (options->study.report && !html_check_files(options->study.report, &b->arena, err))
        return false;
    if (!measure(b, err))
        return false;
    if (b->repeats_done == 0)
        return err_set(err, ERR_STOPPED, "stopped before every variant was timed once");
    return bench_conclude(b, err) && (!options->bench.baseline || bench_compare_baseline(b, err)) &&
           (!options->study.report || bench_write(b, options->study.report, err));
}

static int judge(const struct bench *b)
{
    if (b->differs)
        command_fail(&b->difference);
    return b->differs || bench_is_slower(b) ? EXIT_CODE_CHECK_FAILED : EXIT_CODE_OK;
}

int cmd_bench(const struct options *options)
{
    struct bench b = {.options = options};
    struct err err = {0};
    int code = EXIT_CODE_OK;
    bool ok = run(&b, &err);
    if (ok && b.gpu.validation_messages > 0)
        ok = err_set(&err, ERR_BUG, "the validation layers reported %u messages",
                     b.gpu.validation_messages);
    progress_end(options->progress);
    if (ok && options->json)
        code = command_print(bench_json(&b));
    else if (ok && !options->quiet)
        bench_print(&b);
    if (ok && code == EXIT_CODE_OK)
        code = judge(&b);
    if (ok && b.failure.code != ERR_NONE) {
        err = b.failure;
        ok = false;
    }
    bench_finish(&b);
    return ok ? code : command_fail(&err);
}
