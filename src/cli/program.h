// Runs a program from its command line to its exit code.
#ifndef LAMPYRIS_CLI_PROGRAM_H
#define LAMPYRIS_CLI_PROGRAM_H

struct options;
typedef int (*program_command_fn)(const struct options *options);

// Parses the command line and runs the command that it names, or `command` instead unless it is
// NULL. Returns main's exit code.
int program_run(int argc, char **argv, program_command_fn command);

#endif
