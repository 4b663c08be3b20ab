// Text from files and command lines, made fit for a terminal.
#ifndef LAMPYRIS_BASE_PRINTABLE_H
#define LAMPYRIS_BASE_PRINTABLE_H

#include <stdbool.h>
#include <stddef.h>

// Replaces, in place, each character that is not seen or that changes how others are seen by one
// '?': control characters (C0, DEL, C1), separators of lines and paragraphs, directional controls
// such as U+202E and whatever else renderers ignore by default, such as zero-width spaces; and each
// byte that is not UTF-8, since terminals may take 0x80 to 0x9f for C1. What is left is one line
// whose characters stand in the order in which they are read, and looks like itself only.
void printable_mask(char *text);

// The bytes of the character that begins here, at least one; whether it is one that stays.
size_t printable_character(const char *text, bool *stays);

#endif
