// Applies changes: decides what has to be rebuilt.
#ifndef LAMPYRIS_VIEWER_CORE_CHANGES_H
#define LAMPYRIS_VIEWER_CORE_CHANGES_H

#include "viewer/core/edit.h"

struct shown;
struct viewer;

// Records what has to be rebuilt before the next samples, for both sides, or for one.
void viewer_changed(struct viewer *viewer, enum change change);
void viewer_side_changed(struct viewer *viewer, uint32_t side, enum change change);
// Applies the recorded changes. Returns false if the device failed.
bool viewer_apply_changes(struct viewer *viewer, struct err *err);
// Returns the AOV_* that renderers need to display it.
uint32_t viewer_aovs(const struct shown *shown);
// Disables the denoiser after a failure and reports the reason, since it is only a preview. Returns
// false if the device is lost, or if the failure was not the device's.
bool viewer_stop_denoising(struct viewer *viewer, struct err *err);
// Frees a side's resources on the device.
void viewer_close_side(struct viewer *viewer, uint32_t side);

#endif
