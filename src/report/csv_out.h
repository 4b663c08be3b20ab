// Writes tables of comma-separated values (RFC 4180).
#ifndef LAMPYRIS_REPORT_CSV_OUT_H
#define LAMPYRIS_REPORT_CSV_OUT_H

#include "base/err.h"
#include <stdio.h>

void csv_words(FILE *file, const char *text); // in quotes, which are doubled inside
void csv_number(FILE *file, double value);    // empty if it is not finite

// Writes what `print` prints into a file, at one stroke.
typedef void (*csv_print_fn)(const void *context, FILE *file);
bool csv_write(const char *path, csv_print_fn print, const void *context, struct err *err);

#endif
