// Functions for streams that may be terminals.
#ifndef LAMPYRIS_BASE_TERMINAL_H
#define LAMPYRIS_BASE_TERMINAL_H

#include <stdbool.h>
#include <stdio.h>

bool terminal_is(FILE *stream);
// Returns whether the stream is a terminal that understands escape sequences (ECMA-48).
bool terminal_is_smart(FILE *stream);
int terminal_columns(FILE *stream); // 80 if it is not known

#endif
