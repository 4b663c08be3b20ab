// The host's memory: how much is available to this process, and how much of that it may use. There
// is one budget for the whole process, which arenas, decoders and libraries share. It is asked
// before memory is allocated, and refuses requests that exceed it. Any thread may call.
#ifndef LAMPYRIS_BASE_MEMORY_H
#define LAMPYRIS_BASE_MEMORY_H

#include "base/err.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// Returns the bytes that the process can still get: the least of the memory available without
// swapping (MemAvailable), the rest of the limits of its control group and the groups above it
// (versions 1 and 2), and the rest of RLIMIT_AS and RLIMIT_DATA. UINT64_MAX if none of these is
// known.
uint64_t memory_available(void);
// Does the same with "proc" and "sys" of the folder `root` in place of the system's, without
// RLIMIT.
uint64_t memory_available_in(const char *root);

// Returns the rest of RLIMIT_AS and RLIMIT_DATA (`ulimit -v`, `ulimit -d`); UINT64_MAX without
// limits.
uint64_t memory_limits_left(void);

// Returns three quarters of the available memory: the rest is for libraries, the driver and other
// programs.
uint64_t memory_default_budget(void);

// Sets the limit for the sum of all memory counted below, in bytes; 0: no limit, the initial state.
void memory_set_budget(uint64_t bytes);
uint64_t memory_budget(void);
uint64_t memory_used(void); // part of the budget

// Takes bytes from the budget, or gives them back. Returns false, taking nothing, if too few are
// left.
bool memory_take(uint64_t bytes);
void memory_give(uint64_t bytes);
// Gives back bytes that were taken but that the system could not allocate, and counts the failure.
void memory_fail(uint64_t bytes);
// Checks whether this many bytes could be taken now; they are taken later. ERR_BUDGET if not.
bool memory_check(uint64_t bytes, const char *what, struct err *err);

// calloc(1, bytes) and free with the budget, in the form that libraries require.
void *memory_alloc(size_t bytes);
void memory_free(void *data); // accepts NULL

// Returns how often memory_take or memory_alloc have failed so far. A difference before and after a
// call shows that a library hid the failure, or took it for bad input.
uint64_t memory_failures(void);

// For the last failure since the previous call, returns the bytes that the budget refused, or 0 if
// the system refused them, and what was left of the budget. err_memory uses it for its message.
uint64_t memory_refused(uint64_t *left);

// Return the memory of the process now, and its maximum so far, inside the budget or not; 0 if not
// known.
uint64_t memory_resident(void);
uint64_t memory_peak(void);
// Returns the machine's total memory, 0 if not known.
uint64_t memory_physical(void);
// Returns the size of the block that malloc() returned for `data`, which may exceed the requested
// size.
size_t memory_block_bytes(void *data);

// A text such as "1.5 GiB", "48 bytes".
struct memory_text {
    char text[24];
};
struct memory_text memory_print(uint64_t bytes);

#endif
