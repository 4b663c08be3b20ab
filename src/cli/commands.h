// The commands of the program: their names and arguments.
#ifndef LAMPYRIS_CLI_COMMANDS_H
#define LAMPYRIS_CLI_COMMANDS_H

#include "cli/exit_code.h"
#include "cli/options.h"

enum command_id {
    COMMAND_RENDER,
    COMMAND_MERGE,
    COMMAND_SUBMIT,
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
    const char *summary;     // half a line for lists, such as "render a scene to pictures"
    const char *arguments;   // "SCENE", for the usage line
    const char *description; // description for the help, in sentences
    const char *examples;    // one per line
    // Meanings of the exit codes from EXIT_CODE_OK to EXIT_CODE_OUTPUT for this command. NULL: the
    // code has the meaning that it has for all commands; "": the command does not return the code.
    const char *exits[EXIT_CODE_OUTPUT + 1];
    uint32_t min_arguments, max_arguments;
};

extern const struct command commands[COMMAND_TOTAL];

// Finds a command by name. Returns NULL if there is none; *err then suggests a similar name.
const struct command *command_find(const char *name, struct err *err);

// Each of these functions runs a command whose options have been parsed and checked, and returns
// the exit code. It prints its result to stdout, and reports an error through command_fail().
int cmd_render(const struct options *options);
int cmd_merge(const struct options *options);
int cmd_submit(const struct options *options);
int cmd_converge(const struct options *options);
int cmd_bench(const struct options *options);
int cmd_compare(const struct options *options);
int cmd_check(const struct options *options);
int cmd_info(const struct options *options);
int cmd_view(const struct options *options); // replaces the process by lampyris-view
int cmd_devices(const struct options *options);
int cmd_help(const struct options *options);

#endif
