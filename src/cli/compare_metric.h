// The metrics of `lampyris compare`, and the limits on them.
#ifndef LAMPYRIS_CLI_COMPARE_METRIC_H
#define LAMPYRIS_CLI_COMPARE_METRIC_H

#include <stdbool.h>
#include <stddef.h>

enum compare_metric {
    METRIC_MSE,
    METRIC_RMSE,
    METRIC_RELMSE,
    METRIC_LOCAL_RELMSE,
    METRIC_SMAPE,
    METRIC_PSNR,
    METRIC_SSIM,
    METRIC_FLIP,
    METRIC_HDR_FLIP,
    METRIC_MAX,
    METRIC_NONFINITE,
    METRIC_DIFFERING,
    METRIC_TOTAL
};

extern const char *const compare_metric_names[METRIC_TOTAL];

struct compare_limit {
    enum compare_metric metric;
    bool is_minimum;
    double value;
};

// Returns the metric with this name; -1 if there is none.
int compare_metric_find(const char *name, size_t length);
bool compare_greater_is_better(enum compare_metric metric);
// Returns whether a value is within the limit. NaN is not.
bool compare_limit_holds(double value, const struct compare_limit *limit);

#endif
