// render --trace and --reference: what is seen of a render on its way.
#ifndef LAMPYRIS_CLI_RENDER_RENDER_TRACE_H
#define LAMPYRIS_CLI_RENDER_RENDER_TRACE_H

#include "cli/render/render_job.h"

// Reads the reference and compares its size with the picture's. Nothing without --reference.
bool job_open_reference(struct render_job *job, struct err *err);

// What of a render goes on from a checkpoint goes on from its trace. After the checkpoint is open;
// nothing without --trace.
bool job_trace_open(struct render_job *job, struct err *err);
// At how many samples (or rounds, or frames) the next row is due: 1, 2, 4, ...; UINT64_MAX without
// --trace.
uint64_t job_trace_next(const struct render_job *job, uint64_t done);
// Reads the film and adds a row.
bool job_trace_look(struct render_job *job, struct err *err);
// Adds a row of the film as it was read and judged last, and writes the file. One that cannot be
// written is a warning.
bool job_trace_add(struct render_job *job, struct err *err);
// The row of the finished picture.
bool job_trace_end(struct render_job *job, struct err *err);

#endif
