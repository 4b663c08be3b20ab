// Compares words, ignoring the case of ASCII letters, whatever the locale.
#ifndef LAMPYRIS_BASE_ASCII_H
#define LAMPYRIS_BASE_ASCII_H

#include <stdbool.h>

bool ascii_equal(const char *a, const char *b);
bool ascii_begins(const char *text, const char *prefix);

#endif
