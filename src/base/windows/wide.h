// Functions shared by the files of this folder. Names are UTF-8 in the program and UTF-16 in
// Windows.
#ifndef LAMPYRIS_BASE_WINDOWS_WIDE_H
#define LAMPYRIS_BASE_WINDOWS_WIDE_H

#include <stdbool.h>
#include <wchar.h>

// Convert a text and allocate the result with malloc(). Return NULL, with errno set, when out of
// memory or if the text is not valid.
wchar_t *wide_from(const char *text);
char *wide_to(const wchar_t *text);
// Converts a path: "\" becomes "/", and the prefix "\\?\" of long paths is omitted.
char *wide_to_path(const wchar_t *path);

// Sets errno according to GetLastError(); returns false.
bool wide_fail(void);

#endif
