// Applies changes of the scene and the settings, and decides what has to be rebuilt.
#ifndef LAMPYRIS_VIEWER_CORE_CHANGES_H
#define LAMPYRIS_VIEWER_CORE_CHANGES_H

#include "viewer/core/edit.h"

struct shown;
struct viewer;

// Record what must be rebuilt before the next samples, for both sides or for one.
void viewer_changed(struct viewer *viewer, enum change change);
void viewer_side_changed(struct viewer *viewer, uint32_t side, enum change change);
// Applies the recorded changes. Returns false if the device failed.
bool viewer_apply_changes(struct viewer *viewer, struct err *err);
// Returns the AOV_* flags of the layers that renderers must compute for these display settings.
uint32_t viewer_aovs(const struct shown *shown);
// Disables the denoiser after a failure and shows the reason; denoising is only a preview, so the
// viewer can go on. Returns false if the device is lost or if the device did not cause the failure.
bool viewer_stop_denoising(struct viewer *viewer, struct err *err);
// Frees the resources of a side on the device.
void viewer_close_side(struct viewer *viewer, uint32_t side);

#endif
