// Text results on stdout.
#ifndef LAMPYRIS_APP_TEXT_OUT_H
#define LAMPYRIS_APP_TEXT_OUT_H

#include <stdio.h>

// Prints text that may come from a file: control characters, which could steer a terminal, as '?'.
static inline void print_words(const char *text)
{
    for (; *text; text++)
        putchar((unsigned char)*text < 0x20 || *text == 0x7f ? '?' : *text);
}

static inline void print_line(const char *label, const char *text)
{
    fputs(label, stdout);
    print_words(text);
    putchar('\n');
}

// Says where --report has written; folder NULL: nowhere.
static inline void print_report(const char *folder)
{
    if (!folder)
        return;
    fputs("wrote   ", stdout);
    print_words(folder);
    puts("/report.html, with results.csv and results.json");
}

#endif
