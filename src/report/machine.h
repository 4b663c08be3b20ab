// Describes the machine on which a measurement was made.
#ifndef LAMPYRIS_REPORT_MACHINE_H
#define LAMPYRIS_REPORT_MACHINE_H

#include "gpu/gpu.h"
#include <jansson.h>

struct machine {
    char processor[128], system[256];
    unsigned threads;
    double memory_bytes;
};

// Returns a description in which unknown values are "unknown" or 0.
struct machine machine_describe(void);
// Returns {processor, threads, memory_bytes, system, device, driver, version}.
json_t *machine_json(const struct gpu *gpu);

#endif
