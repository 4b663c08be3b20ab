#include "base/terminal.h"

#include <io.h>
#include <windows.h>

static HANDLE console_of(FILE *stream)
{
    return (HANDLE)_get_osfhandle(_fileno(stream));
}

bool terminal_is(FILE *stream)
{
    DWORD mode;
    return GetConsoleMode(console_of(stream), &mode);
}

// Consoles understand escape sequences since Windows 10, once this is enabled.
bool terminal_is_smart(FILE *stream)
{
    DWORD mode;
    const HANDLE console = console_of(stream);
    return GetConsoleMode(console, &mode) &&
           SetConsoleMode(console, mode | ENABLE_VIRTUAL_TERMINAL_PROCESSING);
}

int terminal_columns(FILE *stream)
{
    CONSOLE_SCREEN_BUFFER_INFO info;
    const bool is_known = GetConsoleScreenBufferInfo(console_of(stream), &info);
    return is_known ? info.srWindow.Right - info.srWindow.Left + 1 : 80;
}
