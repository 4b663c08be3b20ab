// This process and others.
#ifndef LAMPYRIS_BASE_PROCESS_H
#define LAMPYRIS_BASE_PROCESS_H

#include "base/err.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

// What main() begins with: afterwards arguments are UTF-8, and consoles show UTF-8.
void process_begin(int *argc, char ***argv);
uint64_t process_id(void);
// The file of the program that runs; false where that is not known.
bool process_own_path(char *out, size_t size);

// Whether the system finds a program of this name where it looks for them (PATH).
bool program_is_installed(const char *name);

// A program that runs beside this one. {0} is none.
struct process {
    intptr_t handle;
};

struct process_params {
    const char *const *arguments; // the program's name first, NULL last
    FILE *in;                     // what it reads; NULL: nothing
    FILE *out;                    // where it writes
    bool has_errors_in_out;       // else its messages go where ours go
};

// ERR_SYSTEM.
bool process_start(struct process *process, const struct process_params *params, struct err *err);
// Waits until it has ended, or looks whether it has; then it is none, and `is_well` says whether it
// exited with 0.
void process_wait(struct process *process, bool *is_well);
bool process_has_ended(struct process *process, bool *is_well);
// Ends it at once. Accepts none.
void process_kill(struct process *process);

// Runs a program in place of this one; returns where it cannot be run, with the reason in errno.
// Where the system cannot replace a program, this one exits as the other does.
void process_become(const char *program, char **arguments);

#endif
