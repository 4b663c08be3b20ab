#include "report/machine.h"

#include "base/parallel.h"
#include "report/json_out.h"
#include <stdio.h>
#include <string.h>
#include <sys/utsname.h>
#include <unistd.h>

// "model name : ..." of Linux; other systems have no such file.
static void read_processor(char *out, size_t size)
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

static double machine_memory_bytes(void)
{
    long pages = sysconf(_SC_PHYS_PAGES), page = sysconf(_SC_PAGESIZE);
    return pages > 0 && page > 0 ? (double)pages * (double)page : 0.0;
}

struct machine machine_describe(void)
{
    struct machine machine = {.threads = cpu_count(), .memory_bytes = machine_memory_bytes()};
    struct utsname system;
    read_processor(machine.processor, sizeof machine.processor);
    if (uname(&system) == 0)
        snprintf(machine.system, sizeof machine.system, "%s %s, %s", system.sysname, system.release,
                 system.machine);
    else
        snprintf(machine.system, sizeof machine.system, "unknown");
    return machine;
}

json_t *machine_json(const struct gpu *gpu)
{
    struct machine machine = machine_describe();
    return json_pack("{s:o, s:i, s:f, s:o, s:o, s:o, s:s}", "processor",
                     json_words(machine.processor), "threads", (int)machine.threads, "memory_bytes",
                     machine.memory_bytes, "system", json_words(machine.system), "device",
                     json_words(gpu->info.name), "driver", json_words(gpu->info.driver), "version",
                     LAMPYRIS_VERSION);
}
