// Functions shared by the files of this folder: names are UTF-8 in the program, and UTF-16 in
// Windows.
#ifndef LAMPYRIS_BASE_WINDOWS_WIDE_H
#define LAMPYRIS_BASE_WINDOWS_WIDE_H

#include <stdbool.h>
#include <wchar.h>

// Both convert a text into memory from malloc; NULL, with errno set, without memory or if the text
// is not valid.
wchar_t *wide_from(const char *text);
char *wide_to(const wchar_t *text);
// Converts a path: "\\" becomes "/", and a long path's prefix "\\?\" is left out.
char *wide_to_path(const wchar_t *path);

// Sets errno according to GetLastError(); returns false.
bool wide_fail(void);

#endif
