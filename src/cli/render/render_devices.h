// Several devices of this machine that render one picture (--device 0,1): each has a thread, a
// renderer and a film. The scene and its hierarchy are shared.
#ifndef LAMPYRIS_CLI_RENDER_RENDER_DEVICES_H
#define LAMPYRIS_CLI_RENDER_RENDER_DEVICES_H

#include "flatten/geometry.h"
#include "job/crew.h"
#include "job/job.h"

struct device_worker;

struct render_devices {
    struct crew crew; // workers: all but the first device
    struct device_worker *workers;
    uint32_t started; // threads
    struct geometry geometry;
    struct arena arena;
};

// Returns how many devices a list of indices has; 1 for anything else.
uint32_t render_devices_count(const char *text);
// Returns the i-th of them, from 0; NULL when out of memory.
const char *render_devices_name(const char *text, uint32_t i, struct arena *arena);

// Makes room for the workers, and prepares the geometry for all. `params` are those of the job,
// with its scene; its renderer.geometry and crew are set. *out must not be moved, and must be
// finished, after the job, in any case.
bool render_devices_create(const char *text, struct job_params *params, struct render_devices *out,
                           struct err *err);
// Opens the devices of the workers, whose job has the same goal, and starts them: they create their
// renderers while the job creates its own. The job's device is open.
bool render_devices_start(struct render_devices *devices, const struct gpu_params *gpu,
                          const char *text, const struct job_params *params, struct err *err);
// Ends the workers; waits until each has finished the block that it renders.
void render_devices_finish(struct render_devices *devices); // accepts NULL and {0}

#endif
