// The host's memory: how much is available to this process, and how much of it the process may use.
// There is one budget for the whole process, shared by arenas, decoders and libraries. It is
// checked before memory is allocated, and requests that exceed it are refused. Any thread may call.
#ifndef LAMPYRIS_BASE_MEMORY_H
#define LAMPYRIS_BASE_MEMORY_H

#include "base/err.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// Returns the bytes that the process can still allocate: the least of the memory available without
// swapping (MemAvailable), the rest of the limits of its control group and the groups above it
// (versions 1 and 2), and the rest of RLIMIT_AS and RLIMIT_DATA. UINT64_MAX if none of these is
// known.
uint64_t memory_available(void);
// As memory_available(), but reads "proc" and "sys" in the folder `root` in place of the system's,
// and ignores RLIMIT_AS and RLIMIT_DATA.
uint64_t memory_available_in(const char *root);

// Returns the rest of RLIMIT_AS and RLIMIT_DATA (`ulimit -v`, `ulimit -d`); UINT64_MAX without
// limits.
uint64_t memory_limits_left(void);

// Returns three quarters of the available memory, leaving the rest for libraries, the driver and
// other programs.
uint64_t memory_default_budget(void);

// Sets the budget, in bytes, for the sum of all memory counted below. 0, the initial state, means
// that there is no limit.
void memory_set_budget(uint64_t bytes);
uint64_t memory_budget(void);
uint64_t memory_used(void); // bytes of the budget in use

// Takes bytes from the budget, or gives them back. Taking returns false, and takes nothing, if
// fewer are left.
bool memory_take(uint64_t bytes);
void memory_give(uint64_t bytes);
// Gives back bytes that were taken but could not be allocated by the system, and counts the
// failure.
void memory_fail(uint64_t bytes);
// Checks, without taking them, whether this many bytes could be taken now. ERR_BUDGET if not.
bool memory_check(uint64_t bytes, const char *what, struct err *err);

// These functions do what calloc(1, bytes) and free() do, and count the memory against the budget.
// Libraries require these signatures.
void *memory_alloc(size_t bytes);
void memory_free(void *data); // accepts NULL

// Returns how many requests for memory have failed so far. If the number grows during a call of a
// library, memory was short, even if the library hid that or blamed its input.
uint64_t memory_failures(void);

// Describes the last failure since the previous call, for the message of err_memory(). Returns the
// bytes that the budget refused, or 0 if the system refused them. *left receives the rest of the
// budget at that time.
uint64_t memory_refused(uint64_t *left);

// Return the resident memory of the process now, and its maximum so far, whether counted in the
// budget or not; 0 if not known.
uint64_t memory_resident(void);
uint64_t memory_peak(void);
// Returns the machine's total memory; 0 if not known.
uint64_t memory_physical(void);
// Returns the size of the block that malloc() returned for `data`, which may exceed the requested
// size.
size_t memory_block_bytes(void *data);

// A size as text, such as "1.5 GiB" or "48 bytes".
struct memory_text {
    char text[24];
};
struct memory_text memory_print(uint64_t bytes);

#endif
