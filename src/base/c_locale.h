// Numbers as the C locale writes them, whatever the process's locale takes for a decimal point.
#ifndef LAMPYRIS_BASE_C_LOCALE_H
#define LAMPYRIS_BASE_C_LOCALE_H

float c_locale_strtof(const char *text);
double c_locale_strtod(const char *text);

#endif
