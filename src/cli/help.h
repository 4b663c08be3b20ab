// The help texts and the manual, made from the tables of commands and options.
#ifndef LAMPYRIS_CLI_HELP_H
#define LAMPYRIS_CLI_HELP_H

#include <stdio.h>

struct command;

void help_program(FILE *out);
void help_command(FILE *out, const struct command *command);
// A manual page in roff: of a command, or (NULL) of the program with all its commands and options.
void help_manual(FILE *out, const struct command *command);

#endif
