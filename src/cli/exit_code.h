// The exit codes of the program.
#ifndef LAMPYRIS_CLI_EXIT_CODE_H
#define LAMPYRIS_CLI_EXIT_CODE_H

#include "base/err.h"
#include <jansson.h>

// The exit codes. After signal N the exit code is 128 + N, as in shells (130 for SIGINT, 143 for
// SIGTERM ...).
enum exit_code {
    EXIT_CODE_OK = 0,
    EXIT_CODE_CHECK_FAILED = 1, // compare: a limit was exceeded; check: a check failed; bench: a
                                // row is slower; merge --status: samples are missing
    EXIT_CODE_INPUT = 2,        // the command line or an input file is wrong
    EXIT_CODE_DEVICE = 3,       // the device, its driver or the system's memory failed
    EXIT_CODE_OUTPUT = 4,       // an output file could not be written
    EXIT_CODE_NO_VULKAN = 69,   // EX_UNAVAILABLE of sysexits.h: no loader or no driver
};

int exit_code(enum err_code code);
// Reports the error through the log. Returns its exit code.
int command_fail(const struct err *err);
// Prints the object and releases it. Reports an error, if one occurs. Returns the exit code.
int command_print(json_t *object);

#endif
