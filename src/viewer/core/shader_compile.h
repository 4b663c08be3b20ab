// Compiles kernels from source while the program runs. It starts glslangValidator with the build's
// arguments in a process of its own, without a shell.
#ifndef LAMPYRIS_VIEWER_CORE_SHADER_COMPILE_H
#define LAMPYRIS_VIEWER_CORE_SHADER_COMPILE_H

#include "base/err.h"
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define SHADER_UNITS_MAX 32u

struct shader_code {
    uint32_t users; // reference count, managed by the caller, who frees the code
    size_t bytes;
    uint32_t words[];
};

// The state of a kernel after its last compilation.
struct shader_unit {
    const char *name; // name of its source file without ".comp"
    // Paths of the files that were read. Each path ends with a NUL byte, and the list with an empty
    // path. NULL if they are not known.
    char *files;
    uint64_t hash; // hash of these files' contents
};

enum shader_outcome { SHADER_UNCHANGED, SHADER_COMPILED, SHADER_FAILED };

struct shader_result {
    enum shader_outcome outcome;
    struct shader_code *code; // valid if COMPILED; the caller frees this and `unit`
    struct shader_unit unit;  // valid if COMPILED: the new state
};

struct shader_job {
    const char *folder; // absolute path of the folder of the sources
    bool ballot;        // compiles the variant with subgroup ballot
    const struct shader_unit *units;
    uint32_t count;
    const atomic_bool *is_cancelled;
};

// Returns why the kernels in this folder cannot be compiled, or NULL if they can.
const char *shader_why_not(const char *folder);

// Compiles the units whose files have changed. Returns false if it was cancelled or if some units
// failed; `errors` then has a line "FILE:LINE: what is wrong" for each error, where FILE is
// relative to the folder, and `results` has the units that did not fail. Any thread may call this.
bool shader_compile(const struct shader_job *job, struct shader_result *results, char *errors,
                    size_t size, struct err *err);

#endif
