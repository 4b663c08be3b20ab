// What the reports for people and for machines share.
#ifndef LAMPYRIS_APP_RENDER_REPORT_H
#define LAMPYRIS_APP_RENDER_REPORT_H

#include "render_job.h"

double report_host_peak_bytes(void); // 0 where it is not known
double report_total_rays(const struct render_stats *stats);

extern const char *const report_class_names[CLASS_COUNT];

// Whether each feature, lobe, emitter, kernel and buffer (with its bytes, or what it would take)
// was kept.
typedef void (*report_feature_fn)(void *context, bool kept, const char *kind, const char *name,
                                  uint64_t bytes);
void report_each_feature(const struct renderer *r, report_feature_fn fn, void *context);

#endif
