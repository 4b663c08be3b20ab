// Lists the causes of bias of an image, the error that remains for any number of samples: the error
// from half-buffers is blind to it.
#ifndef LAMPYRIS_JOB_BIAS_H
#define LAMPYRIS_JOB_BIAS_H

#include "job/job.h"

enum { JOB_MAX_BIASES = 8 };

struct job_bias {
    const char *kind; // the setting that it comes from
    char text[200];
    bool is_idle; // counters show that it has not changed this image
};

// Returns their number. --max-bounces is not a bias, because it was requested.
uint32_t job_list_biases(const struct job *job, struct job_bias list[JOB_MAX_BIASES]);

// Returns whether the paths of all pixels share their depths, so that parts of the picture give no
// interval.
bool job_shares_depths(const struct job *job);

#endif
