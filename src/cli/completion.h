// Makes scripts with which shells complete command lines, from the tables of commands and options.
#ifndef LAMPYRIS_CLI_COMPLETION_H
#define LAMPYRIS_CLI_COMPLETION_H

#include "cli/commands.h"
#include "cli/options.h"
#include <stdio.h>

// A completion script for `program`. The command line of lampyris-view does not begin with the name
// of a command, so `only` names the command. Options for tests are left out.
struct completion {
    FILE *out;
    const struct command *only; // the command that the program runs; NULL: the first argument names
                                // it
    const char *program;
};

void completion_bash(const struct completion *completion);
void completion_zsh(const struct completion *completion);
void completion_fish(const struct completion *completion);

// The values that can complete an option, as far as the option table contains them.
struct completion_value {
    char words[OPTION_ARGUMENT_MAX]; // separated by blanks; "": none
    bool is_list;                    // the option takes several words, separated by commas
    bool files, folders;
};

struct completion_value completion_value(const struct option_def *def);

// Returns whether the script has the option for the command or, if `command` is NULL, for all
// commands.
bool completion_has(const struct option_def *def, const struct command *command);

// Returns a line that describes the option.
#define COMPLETION_LINE_MAX 160
const char *completion_line(const struct option_def *def, char out[COMPLETION_LINE_MAX]);

// Writes the text, with a backslash before each of these characters.
void completion_escaped(FILE *out, const char *text, const char *characters);

#endif
