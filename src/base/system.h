// The machine and its system.
#ifndef LAMPYRIS_BASE_SYSTEM_H
#define LAMPYRIS_BASE_SYSTEM_H

#include <stddef.h>
#include <stdint.h>

// The number of processors that this process may run on, at least 1.
unsigned system_processors(void);
// Names for people, "unknown" where the system has none.
void system_processor_name(char *out, size_t size);
void system_name(char *out, size_t size);
// How many threads have wanted a processor in the last minute; NaN where that is not known.
double system_load(void);

#endif
