// Information about the machine and its operating system.
#ifndef LAMPYRIS_BASE_SYSTEM_H
#define LAMPYRIS_BASE_SYSTEM_H

#include <stddef.h>
#include <stdint.h>

// Returns the number of processors that this process may use, at least 1.
unsigned system_processors(void);
// Write a name for display; "unknown" if the system provides none.
void system_processor_name(char *out, size_t size);
void system_name(char *out, size_t size);
// Returns the number of threads that were running or waiting for a processor in the last minute, on
// average; NaN if not known.
double system_load(void);

#endif
