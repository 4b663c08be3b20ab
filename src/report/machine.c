#include "report/machine.h"

#include "base/memory.h"
#include "base/parallel.h"
#include "base/system.h"
#include "report/json_out.h"
#include <stdio.h>
#include <string.h>

struct machine machine_describe(void)
{
    struct machine machine = {.threads = cpu_count(), .memory_bytes = (double)memory_physical()};
    system_processor_name(machine.processor, sizeof machine.processor);
    system_name(machine.system, sizeof machine.system);
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
