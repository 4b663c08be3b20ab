// Formats numbers as in the C locale, whatever decimal point the process's locale uses.
#ifndef LAMPYRIS_BASE_C_LOCALE_H
#define LAMPYRIS_BASE_C_LOCALE_H

float c_locale_strtof(const char *text);
double c_locale_strtod(const char *text);

#endif
