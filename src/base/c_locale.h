// Formats numbers as in the C locale, whatever decimal point the process's locale uses.
#ifndef LAMPYRIS_BASE_C_LOCALE_H
#define LAMPYRIS_BASE_C_LOCALE_H

float c_locale_strtof(const char *text);
double c_locale_strtod(const char *text);

// Puts this thread into the C locale, for calls into a library whose caller may have set another.
// Windows has no locale of a thread by default: there nothing is changed.
struct c_locale {
    void *own, *former;
};
struct c_locale c_locale_begin(void);
void c_locale_end(struct c_locale locale);

#endif
