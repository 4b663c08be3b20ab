#include "base/c_locale.h"

#include <stdlib.h>

// The program sets no locale, and a Windows process begins in the C locale.
float c_locale_strtof(const char *text)
{
    return strtof(text, NULL);
}

double c_locale_strtod(const char *text)
{
    return strtod(text, NULL);
}
