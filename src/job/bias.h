// Estimates what a picture lacks on average, however many samples it has: the error from
// half-buffers is blind to that.
#ifndef LAMPYRIS_JOB_BIAS_H
#define LAMPYRIS_JOB_BIAS_H

#include "job/job.h"

enum { JOB_MAX_BIASES = 8 };

struct job_bias {
    const char *kind; // the setting that it comes from
    char text[200];
    bool is_idle; // as counted, it has changed nothing of the picture
};

// How many there are. That --max-bounces ends paths is no bias but what was asked for.
uint32_t job_list_biases(const struct job *job, struct job_bias list[JOB_MAX_BIASES]);

// Returns whether the paths of all pixels share their depths, so that parts of the picture tell no
// interval.
bool job_shares_depths(const struct job *job);

#endif
