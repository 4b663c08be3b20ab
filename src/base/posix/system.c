#define _GNU_SOURCE // for CPU_COUNT and sched_getaffinity
#include "base/system.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/utsname.h>
#include <unistd.h>
#ifdef __APPLE__
#include <sys/sysctl.h>
#else
#include <sched.h>
#endif

unsigned system_processors(void)
{
#ifndef __APPLE__
    cpu_set_t set;
    if (sched_getaffinity(0, sizeof set, &set) == 0 && CPU_COUNT(&set) > 0)
        return (unsigned)CPU_COUNT(&set);
#endif
    const long count = sysconf(_SC_NPROCESSORS_ONLN);
    return count > 0 ? (unsigned)count : 1;
}

#ifdef __APPLE__

void system_processor_name(char *out, size_t size)
{
    size_t length = size;
    if (sysctlbyname("machdep.cpu.brand_string", out, &length, NULL, 0) != 0)
        snprintf(out, size, "unknown");
}

#else

// Reads the first "model name : ..." in Linux's /proc/cpuinfo.
void system_processor_name(char *out, size_t size)
{
    char line[256];
    FILE *file = fopen("/proc/cpuinfo", "r");
    snprintf(out, size, "unknown");
    while (file && fgets(line, sizeof line, file)) {
        const char *value = strchr(line, ':');
        if (strncmp(line, "model name", 10) != 0 || !value)
            continue;
        value += 1 + strspn(value + 1, " \t");
        snprintf(out, size, "%.*s", (int)strcspn(value, "\n"), value);
        break;
    }
    if (file)
        fclose(file);
}

#endif

void system_name(char *out, size_t size)
{
    struct utsname system;
    if (uname(&system) == 0)
        snprintf(out, size, "%s %s, %s", system.sysname, system.release, system.machine);
    else
        snprintf(out, size, "unknown");
}

double system_load(void)
{
    double load;
    return getloadavg(&load, 1) == 1 ? load : (double)NAN;
}
