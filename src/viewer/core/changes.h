// Tells what has to be done anew after a change.
#ifndef LAMPYRIS_VIEWER_CORE_CHANGES_H
#define LAMPYRIS_VIEWER_CORE_CHANGES_H

#include "viewer/core/edit.h"

struct shown;
struct viewer;

// Notes what has to be done anew before the next samples, for both sides, or for one.
void viewer_changed(struct viewer *viewer, enum change change);
void viewer_side_changed(struct viewer *viewer, uint32_t side, enum change change);
// Does what `changes` asks for. False: the device failed.
bool viewer_apply_changes(struct viewer *viewer, struct err *err);
// AOV_* that renderers have to have for it, and no others.
uint32_t viewer_aovs(const struct shown *shown);
// Switches the denoiser off after it failed, and says why, since it is only a preview. Returns false
// where the device is lost, or where it was no failure of the device's.
bool viewer_stop_denoising(struct viewer *viewer, struct err *err);
// Gives back what a side has on the device.
void viewer_close_side(struct viewer *viewer, uint32_t side);

#endif
