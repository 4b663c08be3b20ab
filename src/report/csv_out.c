#include "report/csv_out.h"

#include "base/file.h"
#include "base/memory_stream.h"
#include <math.h>
#include <stdlib.h>

void csv_words(FILE *file, const char *text)
{
    fputc('"', file);
    for (; *text; text++) {
        if (*text == '"')
            fputc('"', file);
        fputc(*text, file);
    }
    fputc('"', file);
}

void csv_number(FILE *file, double value)
{
    if (isfinite(value))
        fprintf(file, "%.9g", value);
}

bool csv_write(const char *path, csv_print_fn print, const void *context, struct err *err)
{
    struct memory_stream stream;
    if (!memory_stream_open(&stream))
        return err_memory(err, path, 0);
    print(context, stream.file);
    bool ok = memory_stream_close(&stream) ? file_write_atomic(path, stream.text, stream.size, err)
                                           : err_memory(err, path, stream.size);
    memory_stream_finish(&stream);
    return ok;
}
