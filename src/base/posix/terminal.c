#include "base/terminal.h"

#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

bool terminal_is(FILE *stream)
{
    return isatty(fileno(stream));
}

bool terminal_is_smart(FILE *stream)
{
    const char *name = getenv("TERM");
    return terminal_is(stream) && name && strcmp(name, "dumb") != 0;
}

int terminal_columns(FILE *stream)
{
    struct winsize window;
    const bool is_known = ioctl(fileno(stream), TIOCGWINSZ, &window) == 0 && window.ws_col > 0;
    return is_known ? window.ws_col : 80;
}
