// The file of `render --trace`: how a picture became better while it was rendered. CSV or JSON, as
// the name says.
#ifndef LAMPYRIS_CLI_RENDER_TRACE_FILE_H
#define LAMPYRIS_CLI_RENDER_TRACE_FILE_H

#include "base/arena.h"
#include "base/err.h"
#include <jansson.h>
#include <stddef.h>
#include <stdint.h>

// What there was at one time. Not finite where not known.
struct trace_row {
    double spp;             // of the picture, a pixel; on average, where pixels have their own
    double frames;          // rendered so far; 0 without frames
    double seconds;         // of rendering, of all runs
    double judging_seconds; // of reading the film and finding its error, in this run so far
    double msamples_per_s;  // since the beginning
    double closest_rays, shadow_rays;
    double local_relmse, ci_low, ci_high, at_most; // as the half-buffers tell it
    // Against a reference.
    double true_local_relmse, true_relmse, true_mse, true_smape, true_psnr;
    const char *reason; // why there is no interval; NULL where there is
};

struct trace {
    // 16 hexadecimal digits each: of all that decides what the samples are, and of the picture that
    // they are compared with ("" without one). Rows of other renders do not belong into the file.
    const char *render, *reference;
    struct trace_row *rows; // in the order that they were seen; room for TRACE_ROWS_MAX
    uint32_t count;
};

#define TRACE_ROWS_MAX 4096u

// ERR_USAGE unless the name ends in .csv or .json.
bool trace_check_format(const char *path, struct err *err);
// Writes all of it atomically. JSON: `head` with the rows added; it stays the caller's.
bool trace_write(const char *path, const struct trace *trace, json_t *head, struct err *err);
// Reads the rows into trace->rows; texts live in `arena`. ERR_INPUT when they belong to another
// render than trace->render and trace->reference say.
bool trace_read(const char *path, struct trace *trace, struct arena *arena, struct err *err);

#endif
