// Writes tables of comma-separated values (RFC 4180).
#ifndef LAMPYRIS_REPORT_CSV_OUT_H
#define LAMPYRIS_REPORT_CSV_OUT_H

#include "base/err.h"
#include <stdio.h>

// Writes a quoted text; quotation marks in it are doubled.
void csv_words(FILE *file, const char *text);
void csv_number(FILE *file, double value); // writes nothing if the value is not finite

// Writes the output of `print` to a file atomically.
typedef void (*csv_print_fn)(const void *context, FILE *file);
bool csv_write(const char *path, csv_print_fn print, const void *context, struct err *err);

#endif
