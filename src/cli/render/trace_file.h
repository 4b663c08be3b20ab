// Writes and reads the file of `render --trace`, which lists the error during rendering. Its
// extension chooses between CSV and JSON.
#ifndef LAMPYRIS_CLI_RENDER_TRACE_FILE_H
#define LAMPYRIS_CLI_RENDER_TRACE_FILE_H

#include "job/job.h"
#include <jansson.h>

// Fails with ERR_USAGE unless the name ends in .csv or .json.
bool trace_check_format(const char *path, struct err *err);
// Writes the complete file atomically. A JSON file has the members of `head`, to which the function
// adds the rows. The caller must release `head`.
bool trace_write(const char *path, const struct trace *trace, json_t *head, struct err *err);
// Reads trace->rows, which `arena` owns with their texts. Fails with ERR_INPUT if the hashes in the
// file differ from trace->render and trace->reference.
bool trace_read(const char *path, struct trace *trace, struct arena *arena, struct err *err);

#endif
