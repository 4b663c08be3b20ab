// Automatic exposure.
#ifndef LAMPYRIS_VIEWER_CORE_EXPOSURE_H
#define LAMPYRIS_VIEWER_CORE_EXPOSURE_H

#include "base/err.h"

struct viewer;

// The image or its light has changed: an automatic exposure is computed anew.
void viewer_begin_exposure(struct viewer *viewer);
// Computes it when it is due.
bool viewer_find_exposure(struct viewer *viewer, struct err *err);

#endif
