// The exposure that is found from the picture.
#ifndef LAMPYRIS_VIEWER_CORE_EXPOSURE_H
#define LAMPYRIS_VIEWER_CORE_EXPOSURE_H

#include "base/err.h"

struct viewer;

// The picture or its light is another one: where the exposure is automatic, it is found anew.
void viewer_begin_exposure(struct viewer *viewer);
// Finds it when it is time to.
bool viewer_find_exposure(struct viewer *viewer, struct err *err);

#endif
