// The help texts and the manual, generated from the tables of commands and options.
#ifndef LAMPYRIS_CLI_HELP_H
#define LAMPYRIS_CLI_HELP_H

#include <stdio.h>

struct command;

// The commands, and the options of every command.
void help_program(FILE *out);
// The options of a command that matter most, on one screen of 80 columns and at most 40 lines.
void help_common(FILE *out, const struct command *command);
// All options of a command by groups, and those of all commands; but for those for tests.
void help_command(FILE *out, const struct command *command);
void help_everything(FILE *out);
// A manual page in roff: of a command, or (NULL) of the program with all its commands and options.
void help_manual(FILE *out, const struct command *command);

#endif
