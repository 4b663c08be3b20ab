#include "report/csv_out.h"

#include "base/file.h"
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
    char *text = NULL;
    size_t size = 0;
    FILE *file = open_memstream(&text, &size);
    if (!file)
        return err_memory(err, path, 0);
    print(context, file);
    bool ok =
        fclose(file) == 0 ? file_write_atomic(path, text, size, err) : err_memory(err, path, size);
    free(text);
    return ok;
}
