// This process and child processes.
#ifndef LAMPYRIS_BASE_PROCESS_H
#define LAMPYRIS_BASE_PROCESS_H

#include "base/err.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

// Must be the first call in main(). Makes the arguments UTF-8, and consoles display UTF-8.
void process_begin(int *argc, char ***argv);
uint64_t process_id(void);
// Finds the file of the running program. Returns false if it is not known.
bool process_own_path(char *out, size_t size);

// Returns whether the system finds a program of this name in PATH.
bool program_is_installed(const char *name);

// A running child process; {0} is none.
struct process {
    intptr_t handle;
};

struct process_params {
    const char *const *arguments; // the program's name first, NULL last
    FILE *in;                     // becomes the child's standard input; NULL: none
    FILE *out;                    // receives the child's standard output
    bool has_errors_in_out;       // standard error goes to `out`, too; false: it is inherited
};

// Starts a program. Fails with ERR_SYSTEM.
bool process_start(struct process *process, const struct process_params *params, struct err *err);
// Wait until the child has ended, or test whether it has. Once it has, the struct becomes {0}, and
// *is_well is whether it exited with 0.
void process_wait(struct process *process, bool *is_well);
bool process_has_ended(struct process *process, bool *is_well);
// Kills the child. Accepts {0}.
void process_kill(struct process *process);

// Replaces this process by a program; returns only on failure, with the reason in errno. If the
// system cannot replace a process, runs the program and exits with its code.
void process_become(const char *program, char **arguments);

#endif
