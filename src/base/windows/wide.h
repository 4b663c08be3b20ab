// What the files of this folder share: names are UTF-8 in the program, and UTF-16 in Windows.
#ifndef LAMPYRIS_BASE_WINDOWS_WIDE_H
#define LAMPYRIS_BASE_WINDOWS_WIDE_H

#include <stdbool.h>
#include <wchar.h>

// From malloc; NULL, with errno set, without memory or where the text is not valid.
wchar_t *wide_from(const char *text);
char *wide_to(const wchar_t *text);
// The same of a path: "\\" becomes "/", and a long path's prefix "\\?\" is left out.
char *wide_to_path(const wchar_t *path);

// Sets errno by what GetLastError() says; false.
bool wide_fail(void);

#endif
