// Makes the help texts and the manual pages from the tables of commands and options.
#ifndef LAMPYRIS_CLI_HELP_H
#define LAMPYRIS_CLI_HELP_H

#include <stdio.h>

struct command;

// Prints all commands, and the options that every command has.
void help_program(FILE *out);
// Prints the most important options of a command, on one screen of 80 columns and at most 40 lines.
void help_common(FILE *out, const struct command *command);
// Prints all options of a command by groups, including those of every command, but not those for
// tests.
void help_command(FILE *out, const struct command *command);
void help_everything(FILE *out);
// Prints a manual page in roff: of a command or, if it is NULL, of the program with all commands
// and options.
void help_manual(FILE *out, const struct command *command);

#endif
