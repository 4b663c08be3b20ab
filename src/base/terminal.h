// Streams that people may read as they are written.
#ifndef LAMPYRIS_BASE_TERMINAL_H
#define LAMPYRIS_BASE_TERMINAL_H

#include <stdbool.h>
#include <stdio.h>

bool terminal_is(FILE *stream);
// One that also knows escape sequences (ECMA-48).
bool terminal_is_smart(FILE *stream);
int terminal_columns(FILE *stream); // 80 where it is not known

#endif
