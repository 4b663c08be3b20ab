// Describes the viewer's state for scripts and tests.
#ifndef LAMPYRIS_VIEWER_SCRIPT_STATE_H
#define LAMPYRIS_VIEWER_SCRIPT_STATE_H

#include "base/err.h"
#include "report/json_out.h"
#include <stdint.h>

struct viewer;

// Returns the whole state: docs/viewer.md lists the keys. Values that differ from run to run are in
// "times". The caller owns the reference; NULL when out of memory.
json_t *state_json(const struct viewer *viewer);
// Finds the value that the key of an `expect` names: "camera.fov_degrees", "sides.0.samples", or
// "item.view.exposure" for the value of a control; NULL if it does not exist. A borrowed reference.
const json_t *state_find(const json_t *state, const char *key);

// Hashes the display values of the image on the screen, without the panel. Returns false if the
// device failed.
bool state_hash_picture(struct viewer *viewer, uint64_t *hash, struct err *err);

#endif
