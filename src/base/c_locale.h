// Reads and writes numbers as in the C locale, whatever decimal point the process's locale uses.
#ifndef LAMPYRIS_BASE_C_LOCALE_H
#define LAMPYRIS_BASE_C_LOCALE_H

float c_locale_strtof(const char *text);
double c_locale_strtod(const char *text);

// A change of the thread's locale. c_locale_begin() sets the C locale, and c_locale_end() restores
// the former one. The library needs this, because its caller may have set another locale. On
// Windows, where threads have no locale of their own by default, it changes nothing.
struct c_locale {
    void *own, *former;
};
struct c_locale c_locale_begin(void);
void c_locale_end(struct c_locale locale);

#endif
