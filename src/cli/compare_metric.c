#include "cli/compare_metric.h"

#include <string.h>

const char *const compare_metric_names[METRIC_TOTAL] = {
    [METRIC_MSE] = "mse",
    [METRIC_RMSE] = "rmse",
    [METRIC_RELMSE] = "relmse",
    [METRIC_LOCAL_RELMSE] = "local-relmse",
    [METRIC_SMAPE] = "smape",
    [METRIC_PSNR] = "psnr",
    [METRIC_SSIM] = "ssim",
    [METRIC_FLIP] = "flip",
    [METRIC_HDR_FLIP] = "hdr-flip",
    [METRIC_MAX] = "max",
    [METRIC_NONFINITE] = "nonfinite",
    [METRIC_DIFFERING] = "differing",
};

int compare_metric_find(const char *name, size_t length)
{
    for (int i = 0; i < METRIC_TOTAL; i++)
        if (strlen(compare_metric_names[i]) == length &&
            memcmp(compare_metric_names[i], name, length) == 0)
            return i;
    return -1;
}

bool compare_greater_is_better(enum compare_metric metric)
{
    return metric == METRIC_PSNR || metric == METRIC_SSIM;
}

bool compare_limit_holds(double value, const struct compare_limit *limit)
{
    return limit->is_minimum ? value >= limit->value : value <= limit->value;
}
