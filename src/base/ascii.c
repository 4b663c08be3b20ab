#include "base/ascii.h"

#include <stddef.h>

static char lower(char c)
{
    return c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : c;
}

// Returns the text after the prefix; NULL if the text does not begin with it.
static const char *skip(const char *text, const char *prefix)
{
    for (; *prefix; text++, prefix++)
        if (lower(*text) != lower(*prefix))
            return NULL;
    return text;
}

bool ascii_equal(const char *a, const char *b)
{
    const char *rest = skip(a, b);
    return rest && *rest == '\0';
}

bool ascii_begins(const char *text, const char *prefix)
{
    return skip(text, prefix) != NULL;
}
