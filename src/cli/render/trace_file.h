// The file of `render --trace`: the error during rendering. CSV or JSON, by the extension.
#ifndef LAMPYRIS_CLI_RENDER_TRACE_FILE_H
#define LAMPYRIS_CLI_RENDER_TRACE_FILE_H

#include "job/job.h"
#include <jansson.h>

// ERR_USAGE unless the name ends in .csv or .json.
bool trace_check_format(const char *path, struct err *err);
// Writes the complete file atomically. JSON: `head` with the rows added; the caller keeps it.
bool trace_write(const char *path, const struct trace *trace, json_t *head, struct err *err);
// Reads trace->rows, which live in `arena` with their texts. ERR_INPUT if they belong to another
// render than trace->render and trace->reference.
bool trace_read(const char *path, struct trace *trace, struct arena *arena, struct err *err);

#endif
