// Parses JSON documents, and controls the memory of jansson. On its own, jansson reports a failed
// allocation as a syntax error, omits data for which it had no memory, or writes out of bounds.
#ifndef LAMPYRIS_JSON_JSON_PARSE_H
#define LAMPYRIS_JSON_JSON_PARSE_H

#include "base/err.h"
#include "base/file.h"
#include <jansson.h>

// From now on jansson's memory counts against the budget of the process (memory.h), and its failed
// allocations do no harm to json_parse(). Call it before jansson allocates anything. It concerns
// all of the process: only a program may call it, not a library, whose caller may use jansson, too.
void json_use_budget(void);
// What it makes jansson call.
void *json_allocate(size_t bytes);
void json_deallocate(void *data);

// Returns whether an allocation of jansson's has failed in this thread since the previous call, but
// for those of parsers: if so, something may be missing from what was built since.
bool json_lost_memory(void);

// Returns the document, or NULL with *err set: ERR_INPUT with file, line and column, or an error of
// memory.
json_t *json_parse(const char *path, const struct file_bytes *text, size_t flags, struct err *err);

// Frees the result of json_dumps(). Accepts NULL.
void json_release(char *dumped);

#endif
