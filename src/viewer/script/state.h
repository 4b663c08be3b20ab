// Describes what the viewer shows and knows, for scripts and for tests.
#ifndef LAMPYRIS_VIEWER_SCRIPT_STATE_H
#define LAMPYRIS_VIEWER_SCRIPT_STATE_H

#include "base/err.h"
#include "report/json_out.h"
#include <stdint.h>

struct viewer;

// All of it: docs/viewer.md lists the keys. What differs from run to run is in "times". The
// caller's reference; NULL without memory.
json_t *state_json(const struct viewer *viewer);
// Finds what the key of an `expect` names in it: "camera.fov_degrees", "sides.0.samples", or
// "item.view.exposure" for the value of a control; NULL where there is none such. A borrowed
// reference.
const json_t *state_find(const json_t *state, const char *key);

// Hashes the display values of the picture on the screen, without the panel. False: the device
// failed.
bool state_hash_picture(struct viewer *viewer, uint64_t *hash, struct err *err);

#endif
