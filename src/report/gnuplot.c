#include "report/gnuplot.h"

#include "base/file_system.h"
#include "base/process.h"
#include <errno.h>
#include <stdio.h>
#include <string.h>

// Runs gnuplot with `in` as its input and `out` as its output. Its error messages go to stderr.
static bool run(FILE *in, FILE *out, struct err *err)
{
    const char *const arguments[] = {"gnuplot", NULL};
    struct process process;
    bool is_well;
    if (!process_start(&process,
                       &(struct process_params){.arguments = arguments, .in = in, .out = out}, err))
        return false;
    process_wait(&process, &is_well);
    return is_well || err_set(err, ERR_SYSTEM, "gnuplot failed");
}

static bool read_all(FILE *file, struct arena *arena, char **out, struct err *err)
{
    uint64_t size;
    if (!file_stream_size(file, &size))
        return err_set(err, ERR_SYSTEM, "the output of gnuplot cannot be read: %s",
                       strerror(errno));
    *out = size > 0 ? ARENA_NEW(arena, char, (size_t)size + 1) : NULL;
    if (size > 0 && !*out)
        return err_memory(err, "a plot", size);
    return (size > 0 && fread(*out, 1, (size_t)size, file) == (size_t)size) ||
           err_set(err, ERR_SYSTEM, "gnuplot printed nothing");
}

bool gnuplot_run(const char *script, struct arena *arena, char **out, struct err *err)
{
    FILE *in = file_stream_temporary(), *printed = file_stream_temporary();
    bool ok = in && printed && fputs(script, in) >= 0 && fflush(in) == 0;
    if (ok) {
        rewind(in);
        ok = run(in, printed, err) && read_all(printed, arena, out, err);
    } else
        err_set(err, ERR_SYSTEM, "a temporary file for gnuplot cannot be written: %s",
                strerror(errno));
    if (in)
        fclose(in);
    if (printed)
        fclose(printed);
    return ok;
}
