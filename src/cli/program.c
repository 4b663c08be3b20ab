#include "cli/program.h"

#include "base/file_inputs.h"
#include "base/log.h"
#include "base/memory.h"
#include "base/signals.h"
#include "cli/commands.h"
#include "cli/help.h"
#include "cli/options.h"
#include "cli/progress_bar.h"
#include "json/json_parse.h"
#include <errno.h>
#include <stdio.h>
#include <string.h>

static int (*const run_command[COMMAND_TOTAL])(const struct options *options) = {
    [COMMAND_RENDER] = cmd_render,     [COMMAND_MERGE] = cmd_merge, [COMMAND_SUBMIT] = cmd_submit,
    [COMMAND_CONVERGE] = cmd_converge, [COMMAND_BENCH] = cmd_bench, [COMMAND_COMPARE] = cmd_compare,
    [COMMAND_CHECK] = cmd_check,       [COMMAND_INFO] = cmd_info,   [COMMAND_VIEW] = cmd_view,
    [COMMAND_DEVICES] = cmd_devices,   [COMMAND_HELP] = cmd_help,
};

static int run(const struct options *options, program_command_fn command)
{
    if (options->version)
        printf("lampyris %s\n", LAMPYRIS_VERSION);
    else if (options->help_all && options->command)
        help_command(stdout, options->command);
    else if (options->help_all)
        help_everything(stdout);
    else if (options->help && options->command)
        help_common(stdout, options->command);
    else if (options->help)
        help_program(stdout);
    else
        return command ? command(options) : run_command[options->command - commands](options);
    return EXIT_CODE_OK;
}

static int fail_parsing(const struct options *options, const struct err *err)
{
    int code = command_fail(err);
    if (err->code == ERR_USAGE)
        fprintf(stderr, "Try \"lampyris%s%s --help\".\n", options->command ? " " : "",
                options->command ? options->command->name : "");
    return code;
}

// Output that could not be written is a failure, which takes precedence over the result's own exit
// code. A closed pipe needs no message.
static int finish_stdout(int code)
{
    if (fflush(stdout) == 0 && !ferror(stdout))
        return code;
    if (errno != EPIPE)
        log_message(LOG_ERROR, "standard output: cannot write: %s", strerror(errno));
    return code == EXIT_CODE_OK || code == EXIT_CODE_CHECK_FAILED ? EXIT_CODE_OUTPUT : code;
}

int program_run(int argc, char **argv, program_command_fn command)
{
    signals_install();
    json_use_budget();
    struct progress_bar bar;
    progress_bar_init(&bar, stderr);
    log_configure(LOG_WARN, progress_bar_log, &bar);
    struct progress progress = progress_bar_listener(&bar);

    struct file_inputs inputs;
    file_inputs_begin(&inputs);
    struct options options;
    struct err err = {0};
    int code;
    if (options_parse(argc, argv, &options, &err)) {
        log_configure(options.log_level, progress_bar_log, &bar);
        bar.is_quiet = options.quiet;
        options.progress = &progress;
        memory_set_budget(options.memory ? options.memory : memory_default_budget());
        code = run(&options, command);
    } else {
        code = fail_parsing(&options, &err);
    }
    progress_bar_finish(&bar);
    code = finish_stdout(code);
    options_finish(&options);
    file_inputs_end(&inputs);
    return code == EXIT_CODE_OK ? signal_exit_code() : code;
}
