// The automatic exposure.
#ifndef LAMPYRIS_VIEWER_CORE_EXPOSURE_H
#define LAMPYRIS_VIEWER_CORE_EXPOSURE_H

#include "base/err.h"

struct viewer;

// Starts the computation of an automatic exposure, because the image or its light has changed.
void viewer_begin_exposure(struct viewer *viewer);
// Computes the exposure if it is due. Returns false if the device failed.
bool viewer_find_exposure(struct viewer *viewer, struct err *err);

#endif
