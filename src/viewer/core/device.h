// Opens the device, and recovers from its loss.
#ifndef LAMPYRIS_VIEWER_CORE_DEVICE_H
#define LAMPYRIS_VIEWER_CORE_DEVICE_H

#include "base/err.h"

struct viewer;

bool viewer_open_device(struct viewer *viewer, struct err *err);
void viewer_close_device(struct viewer *viewer);
// Opens a lost device again; all images start from the beginning. Returns false on failure.
bool viewer_recover(struct viewer *viewer, struct err *err);

#endif
