// Parses JSON documents, and controls the memory of jansson. On its own, jansson reports a failed
// allocation as a syntax error, omits data for which it had no memory, or writes out of bounds.
#ifndef LAMPYRIS_JSON_JSON_PARSE_H
#define LAMPYRIS_JSON_JSON_PARSE_H

#include "base/err.h"
#include "base/file.h"
#include <jansson.h>

// Makes jansson allocate by the two functions below. Its memory then counts against the budget of
// the process (memory.h), and a failed allocation does no harm to json_parse(). Call it before
// jansson allocates anything. It affects the whole process, so only a program may call it, not a
// library, whose caller may use jansson, too.
void json_use_budget(void);
// The allocation functions that json_use_budget() gives to jansson.
void *json_allocate(size_t bytes);
void json_deallocate(void *data);

// Returns whether an allocation by jansson has failed in this thread since the previous call, apart
// from those during json_parse(). If so, JSON values that were built since then may be incomplete.
bool json_lost_memory(void);

// Parses a document. Returns it, or NULL with *err set: ERR_INPUT with file, line and column for a
// syntax error, or an out-of-memory error.
json_t *json_parse(const char *path, const struct file_bytes *text, size_t flags, struct err *err);

// Frees the result of json_dumps(). Accepts NULL.
void json_release(char *dumped);

#endif
