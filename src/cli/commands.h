// The commands of the program: what they are called and what they take.
#ifndef LAMPYRIS_CLI_COMMANDS_H
#define LAMPYRIS_CLI_COMMANDS_H

#include "cli/exit_code.h"
#include "cli/options.h"

enum command_id {
    COMMAND_RENDER,
    COMMAND_CONVERGE,
    COMMAND_BENCH,
    COMMAND_COMPARE,
    COMMAND_CHECK,
    COMMAND_INFO,
    COMMAND_VIEW,
    COMMAND_DEVICES,
    COMMAND_HELP,
    COMMAND_TOTAL
};

struct command {
    const char *name;
    const char *summary;     // half a line for lists: "render a scene to pictures"
    const char *arguments;   // "SCENE", for the usage line
    const char *description; // sentences, for the help
    const char *examples;    // one a line
    uint32_t min_arguments, max_arguments;
};

extern const struct command commands[COMMAND_TOTAL];

// NULL when there is none of that name; err then says which one may have been meant.
const struct command *command_find(const char *name, struct err *err);

// Each runs the command whose options were parsed and checked, and returns the exit code. It prints
// its result to stdout, and its failure through command_fail.
int cmd_render(const struct options *options);
int cmd_converge(const struct options *options);
int cmd_bench(const struct options *options);
int cmd_compare(const struct options *options);
int cmd_check(const struct options *options);
int cmd_info(const struct options *options);
int cmd_view(const struct options *options); // becomes lampyris-view
int cmd_devices(const struct options *options);
int cmd_help(const struct options *options);

#endif
