#define _GNU_SOURCE // for uselocale
#include "base/c_locale.h"

#include <locale.h>
#include <stdlib.h>
#ifdef __APPLE__
#include <xlocale.h>
#endif

struct c_locale c_locale_begin(void)
{
    const locale_t locale = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    return (struct c_locale){locale, locale ? uselocale(locale) : (locale_t)0};
}

void c_locale_end(struct c_locale locale)
{
    if (!locale.own)
        return;
    uselocale((locale_t)locale.former);
    freelocale((locale_t)locale.own);
}

float c_locale_strtof(const char *text)
{
    const struct c_locale locale = c_locale_begin();
    const float value = strtof(text, NULL);
    c_locale_end(locale);
    return value;
}

double c_locale_strtod(const char *text)
{
    const struct c_locale locale = c_locale_begin();
    const double value = strtod(text, NULL);
    c_locale_end(locale);
    return value;
}
