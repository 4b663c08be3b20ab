// Writes text results to stdout.
#ifndef LAMPYRIS_REPORT_TEXT_OUT_H
#define LAMPYRIS_REPORT_TEXT_OUT_H

#include "base/printable.h"
#include <stdio.h>

// Prints text that may come from a file. Characters that base/printable.h masks are printed as '?'.
static inline void print_words(const char *text)
{
    while (*text) {
        bool stays;
        size_t length = printable_character(text, &stays);
        if (stays)
            fwrite(text, 1, length, stdout);
        else
            putchar('?');
        text += length;
    }
}

static inline void print_line(const char *label, const char *text)
{
    fputs(label, stdout);
    print_words(text);
    putchar('\n');
}

// Prints where --report has written its files; prints nothing if `folder` is NULL.
static inline void print_report(const char *folder)
{
    if (!folder)
        return;
    fputs("wrote   ", stdout);
    print_words(folder);
    puts("/report.html, with results.csv and results.json");
}

#endif
