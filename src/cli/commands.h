// The commands of the program: what they are called, what they take and who runs them.
#ifndef LAMPYRIS_CLI_COMMANDS_H
#define LAMPYRIS_CLI_COMMANDS_H

#include "base/err.h"
#include "cli/options.h"

// How the program ends. 128 + N for signal N, as shells do (130 for SIGINT, 143 for SIGTERM ...).
enum exit_code {
    EXIT_CODE_OK = 0,
    EXIT_CODE_CHECK_FAILED = 1, // compare: a limit was exceeded
    EXIT_CODE_INPUT = 2,        // command line or a file that was read
    EXIT_CODE_DEVICE = 3,       // device, driver, memory
    EXIT_CODE_OUTPUT = 4,       // a file that was to be written
    EXIT_CODE_NO_VULKAN = 69,   // EX_UNAVAILABLE of sysexits.h: no loader or no driver
};

enum command_id {
    COMMAND_RENDER,
    COMMAND_CONVERGE,
    COMMAND_BENCH,
    COMMAND_COMPARE,
    COMMAND_INFO,
    COMMAND_VIEW,
    COMMAND_DEVICES,
    COMMAND_HELP,
    COMMAND_TOTAL
};

// Runs a command whose options were parsed and checked; returns the exit code. Prints its result to
// stdout, and its failure through command_fail.
typedef int (*command_fn)(const struct options *options);

struct command {
    const char *name;
    const char *summary;     // half a line for lists: "render a scene to pictures"
    const char *arguments;   // "SCENE", for the usage line
    const char *description; // sentences, for the help
    const char *examples;    // one a line
    uint32_t min_arguments, max_arguments;
    command_fn run;
};

extern const struct command commands[COMMAND_TOTAL];

// NULL when there is none of that name; err then says which one may have been meant.
const struct command *command_find(const char *name, struct err *err);

int exit_code(enum err_code code);
// Reports the error through the log and returns its exit code.
int command_fail(const struct err *err);

int cmd_render(const struct options *options);
int cmd_converge(const struct options *options);
int cmd_bench(const struct options *options);
int cmd_compare(const struct options *options);
int cmd_info(const struct options *options);
int cmd_view(const struct options *options); // becomes lampyris-view
int cmd_devices(const struct options *options);
int cmd_help(const struct options *options);

#endif
