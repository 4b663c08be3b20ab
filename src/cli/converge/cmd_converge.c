#include "cli/commands.h"

#include "cli/converge/converge.h"

// Measures. If the device fails, the results so far are reported nevertheless.
static bool measure(struct converge *c, struct err *err)
{
    if (converge_measure(c, err))
        return true;
    if (err->code != ERR_GPU || c->replicates_done == 0)
        return false;
    c->failure = *err;
    c->stopped = true;
    return true;
}

static bool run(struct converge *c, struct err *err)
{
    const struct options *options = c->options;
    if (!converge_prepare(c, err) ||
        (options->study.report && !converge_check_files(c, options->study.report, err)) ||
        !converge_reference(c, err) || !measure(c, err))
        return false;
    if (c->replicates_done == 0)
        return err_set(err, ERR_STOPPED, "stopped before the first replicate was complete");
    return converge_conclude(c, err) &&
           (!options->study.report || converge_write(c, options->study.report, err));
}

int cmd_converge(const struct options *options)
{
    struct converge c = {.options = options};
    struct err err = {0};
    int code = EXIT_CODE_OK;
    bool ok = run(&c, &err);
    if (ok && c.gpu.validation_messages > 0)
        ok = err_set(&err, ERR_BUG, "the validation layers reported %u messages",
                     c.gpu.validation_messages);
    progress_end(options->progress);
    if (ok && options->json)
        code = converge_print_json(&c);
    else if (ok && !options->quiet)
        converge_print(&c);
    if (ok && c.failure.code != ERR_NONE) {
        err = c.failure;
        ok = false;
    }
    converge_finish(&c);
    return ok ? code : command_fail(&err);
}
