// Several devices of this machine that render one picture (--device 0,1). Each device has a thread,
// a renderer and a film. All devices share the scene and its hierarchy.
#ifndef LAMPYRIS_CLI_RENDER_RENDER_DEVICES_H
#define LAMPYRIS_CLI_RENDER_RENDER_DEVICES_H

#include "flatten/geometry.h"
#include "job/crew.h"
#include "job/job.h"

struct device_worker;

struct render_devices {
    struct crew crew; // its workers are all devices except the first
    struct device_worker *workers;
    uint32_t started; // number of threads that were started
    struct geometry geometry;
    struct arena arena;
};

// Returns the number of devices in a list such as "0,1", or 1 for any other text.
uint32_t render_devices_count(const char *text);
// Returns the text of device i, from 0, of the list. Returns NULL when out of memory.
const char *render_devices_name(const char *text, uint32_t i, struct arena *arena);

// Allocates the workers, and prepares the geometry that all devices share. `params` are the
// parameters of the job, with the scene. Sets params->renderer.geometry and params->crew. *out must
// not be moved. The caller must call render_devices_finish() in any case, after job_finish().
bool render_devices_create(const char *text, struct job_params *params, struct render_devices *out,
                           struct err *err);
// Opens the devices of the workers and starts their threads. The threads create the workers'
// renderers while the job creates its own. The job's device must be open. Devices with the same
// memory get equal shares of it.
bool render_devices_start(struct render_devices *devices, const struct gpu_params *gpu,
                          const char *text, const struct job_params *params, struct err *err);
// Ends the workers. Waits until each has finished its current block.
void render_devices_finish(struct render_devices *devices); // accepts NULL and {0}

#endif
