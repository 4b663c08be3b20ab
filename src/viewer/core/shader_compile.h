// Kernels from their source while the program runs: by glslangValidator, with the build's
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
    uint32_t users; // the caller's, who frees it
    size_t bytes;
    uint32_t words[];
};

// Knowledge of one kernel from the last time that it was compiled.
struct shader_unit {
    const char *name; // of its file, without ".comp"
    char *files;      // what was read, each path ended by NUL, all by an empty one; NULL: not known
    uint64_t hash;    // of these files
};

enum shader_outcome { SHADER_UNCHANGED, SHADER_COMPILED, SHADER_FAILED };

struct shader_result {
    enum shader_outcome outcome;
    struct shader_code *code; // COMPILED. These two are the caller's to free
    struct shader_unit unit;  // COMPILED: as above
};

struct shader_job {
    const char *folder; // of the sources; absolute
    bool ballot;        // the variant
    const struct shader_unit *units;
    uint32_t count;
    const atomic_bool *is_cancelled;
};

// Why kernels of this folder cannot be compiled, in words, or NULL.
const char *shader_why_not(const char *folder);

// Compiles those units whose files are others than before. False: some failed; `errors` has a line
// "FILE:LINE: what is wrong" for each fault, FILE as seen from the folder; or it was cancelled.
// Those that did not fail are in `results` all the same. Any thread.
bool shader_compile(const struct shader_job *job, struct shader_result *results, char *errors,
                    size_t size, struct err *err);

#endif
