// Makes text from files and command lines safe for a terminal.
#ifndef LAMPYRIS_BASE_PRINTABLE_H
#define LAMPYRIS_BASE_PRINTABLE_H

#include <stdbool.h>
#include <stddef.h>

// Replaces by '?', in place, each character that is invisible or changes how others are displayed:
// control characters (C0, DEL, C1), line and paragraph separators, directional controls such as
// U+202E, and all characters that renderers ignore by default, such as zero-width spaces. Each byte
// that is not UTF-8 is replaced, too, since terminals may take 0x80 to 0x9f for C1. The result is
// one line whose characters are displayed in their order.
void printable_mask(char *text);

// Returns the number of bytes of the character that begins here, at least 1. *stays tells whether
// printable_mask() keeps it.
size_t printable_character(const char *text, bool *stays);

// Quotes a word for a shell. Returns the end of the output. `out` must have room for 4 bytes per
// byte of the word, plus 3.
char *printable_quote(const char *word, char *out);

#endif
