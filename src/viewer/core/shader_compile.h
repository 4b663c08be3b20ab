// Compiles kernels from source while the program runs: by glslangValidator, with the build's
// arguments, in a process of its own and without a shell.
#ifndef LAMPYRIS_VIEWER_CORE_SHADER_COMPILE_H
#define LAMPYRIS_VIEWER_CORE_SHADER_COMPILE_H

#include "base/err.h"
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define SHADER_UNITS_MAX 32u

struct shader_code {
    uint32_t users; // for the caller, who frees it
    size_t bytes;
    uint32_t words[];
};

// The state of a kernel after its last compilation.
struct shader_unit {
    const char *name; // name of its file, without ".comp"
    char *files;      // files that were read, each path ended by NUL, the list by an empty path;
                      // NULL: not known
    uint64_t hash;    // hash of these files
};

enum shader_outcome { SHADER_UNCHANGED, SHADER_COMPILED, SHADER_FAILED };

struct shader_result {
    enum shader_outcome outcome;
    struct shader_code *code; // COMPILED only. This and `unit` are freed by the caller
    struct shader_unit unit;  // COMPILED only: the new state
};

struct shader_job {
    const char *folder; // folder of the sources; absolute
    bool ballot;        // the variant
    const struct shader_unit *units;
    uint32_t count;
    const atomic_bool *is_cancelled;
};

// Returns why kernels of this folder cannot be compiled, or NULL.
const char *shader_why_not(const char *folder);

// Compiles the units whose files have changed. Returns false if some failed, with a line
// "FILE:LINE: what is wrong" for each error in `errors`, FILE relative to the folder; or if it was
// cancelled. `results` then still has those that did not fail. May be called by any thread.
bool shader_compile(const struct shader_job *job, struct shader_result *results, char *errors,
                    size_t size, struct err *err);

#endif
