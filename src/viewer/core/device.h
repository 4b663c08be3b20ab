// The device, which may be lost.
#ifndef LAMPYRIS_VIEWER_CORE_DEVICE_H
#define LAMPYRIS_VIEWER_CORE_DEVICE_H

#include "base/err.h"

struct viewer;

bool viewer_open_device(struct viewer *viewer, struct err *err);
void viewer_close_device(struct viewer *viewer);
// After a lost device: opens it again; all pictures begin anew. False: it could not be had.
bool viewer_recover(struct viewer *viewer, struct err *err);

#endif
