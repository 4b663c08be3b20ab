// Lists the causes of an image's bias, which is the part of the error that remains for any number
// of samples. The error estimated from half-buffers does not include it.
#ifndef LAMPYRIS_JOB_BIAS_H
#define LAMPYRIS_JOB_BIAS_H

#include "job/job.h"

enum { JOB_MAX_BIASES = 9 };

struct job_bias {
    const char *kind; // name of the setting that causes the bias
    char text[200];
    bool is_idle; // counters show that the setting has not changed this image
};

// Returns the number of biases. A limit of --max-bounces is not listed, because it was requested.
uint32_t job_list_biases(const struct job *job, struct job_bias list[JOB_MAX_BIASES]);

// Returns whether the paths of all pixels have the same depth in a sample. The errors of pixels are
// then not independent, so parts of the image do not give an interval.
bool job_shares_depths(const struct job *job);

#endif
