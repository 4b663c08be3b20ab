#define _GNU_SOURCE // uselocale
#include "base/c_locale.h"

#include <locale.h>
#include <stdlib.h>
#ifdef __APPLE__
#include <xlocale.h>
#endif

// Returns the C locale, which the thread uses from here on, or none.
static locale_t enter(locale_t *before)
{
    const locale_t locale = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    *before = locale ? uselocale(locale) : (locale_t)0;
    return locale;
}

static void leave(locale_t locale, locale_t before)
{
    if (!locale)
        return;
    uselocale(before);
    freelocale(locale);
}

float c_locale_strtof(const char *text)
{
    locale_t before;
    const locale_t locale = enter(&before);
    const float value = strtof(text, NULL);
    leave(locale, before);
    return value;
}

double c_locale_strtod(const char *text)
{
    locale_t before;
    const locale_t locale = enter(&before);
    const double value = strtod(text, NULL);
    leave(locale, before);
    return value;
}
