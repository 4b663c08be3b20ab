// Describes the state of the viewer for scripts and tests.
#ifndef LAMPYRIS_VIEWER_SCRIPT_STATE_H
#define LAMPYRIS_VIEWER_SCRIPT_STATE_H

#include "base/err.h"
#include "report/json_out.h"
#include <stdint.h>

struct viewer;

// Returns the whole state; docs/viewer.md lists its keys. "times" contains all values that differ
// between runs. The caller owns the reference. Returns NULL when out of memory.
json_t *state_json(const struct viewer *viewer);
// Finds the value for the key of a command `expect`: "camera.fov_degrees", "sides.0.samples", or
// "item.view.exposure" for the value of a control. Returns a borrowed reference, or NULL if there
// is no such value.
const json_t *state_find(const json_t *state, const char *key);

// Computes a hash of the display values of the image on the screen, without the panel. Returns
// false if the device failed.
bool state_hash_picture(struct viewer *viewer, uint64_t *hash, struct err *err);

#endif
