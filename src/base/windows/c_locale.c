#include "base/c_locale.h"

#include <stdlib.h>

// The program sets no locale, and a Windows process begins in the C locale.
struct c_locale c_locale_begin(void)
{
    return (struct c_locale){0};
}

void c_locale_end(struct c_locale locale)
{
    (void)locale;
}

float c_locale_strtof(const char *text)
{
    return strtof(text, NULL);
}

double c_locale_strtod(const char *text)
{
    return strtod(text, NULL);
}
