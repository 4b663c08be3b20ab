// One run of `lampyris bench`: where the time of rendering goes, by kernel and by bounce, for each
// scene and each variant.
#ifndef LAMPYRIS_APP_BENCH_H
#define LAMPYRIS_APP_BENCH_H

#include "curve.h"
#include "render.h"
#include "variants.h"

#endif
