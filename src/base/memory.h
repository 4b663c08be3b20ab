// The host's memory: how much the machine leaves to this process, and how much of that the process
// may take. Memory belongs to the process, as standard error does, so that there is one budget for
// all of it, whatever asks: arenas, decoders, libraries. It is asked before memory is allocated,
// and refuses what exceeds it. Any thread may call.
#ifndef LAMPYRIS_BASE_MEMORY_H
#define LAMPYRIS_BASE_MEMORY_H

#include "base/err.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// Bytes that the process can still have: the least of what the machine can give without swapping
// (MemAvailable), what the limits of its control group and of those above it leave (version 1 and
// 2), and what RLIMIT_AS and RLIMIT_DATA leave. UINT64_MAX where nothing of that is known.
uint64_t memory_available(void);
// The same with "proc" and "sys" of the folder `root` in place of the system's, without RLIMIT.
uint64_t memory_available_in(const char *root);

// What RLIMIT_AS and RLIMIT_DATA (`ulimit -v`, `ulimit -d`) leave; UINT64_MAX without them.
uint64_t memory_limits_left(void);

// Three quarters of what is available: the rest is for the libraries, the driver and the others.
uint64_t memory_default_budget(void);

// What all that is counted below may add up to, in bytes; 0: no limit, as at the start.
void memory_set_budget(uint64_t bytes);
uint64_t memory_budget(void);
uint64_t memory_used(void); // of it

// Takes bytes from the budget, or gives them back. False, and nothing taken, where too few are
// left.
bool memory_take(uint64_t bytes);
void memory_give(uint64_t bytes);
// Gives back bytes that were taken but that the system did not have, and counts the failure.
void memory_fail(uint64_t bytes);
// Whether so many bytes could be taken, which are taken later. ERR_BUDGET where not.
bool memory_check(uint64_t bytes, const char *what, struct err *err);

// calloc(1, bytes) and free, from the budget. Fit for libraries that ask for such functions.
void *memory_alloc(size_t bytes);
void memory_free(void *data); // accepts NULL

// How often memory_take or memory_alloc have failed so far. A library that hides the failure, or
// takes it for bad input, is found out by comparing the counts before and after.
uint64_t memory_failures(void);

// Of the last failure since the previous call: the bytes that the budget refused, or 0 where it was
// the system, and what was left of the budget then. err_memory asks, to say which it was.
uint64_t memory_refused(uint64_t *left);

// What the process has now, and the most that it had so far, of the budget or not; 0 where it is
// not known.
uint64_t memory_resident(void);
uint64_t memory_peak(void);
// All of the machine's, 0 where it is not known.
uint64_t memory_physical(void);
// What malloc() gave for `data`, which may be more than it was asked for.
size_t memory_block_bytes(void *data);

// "1.5 GiB", "48 bytes".
struct memory_text {
    char text[24];
};
struct memory_text memory_print(uint64_t bytes);

#endif
