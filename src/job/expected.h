// Recognises the parts of a render by a hash, which is known before the first part exists. A folder
// may have parts of an earlier render under the same names.
#ifndef LAMPYRIS_JOB_EXPECTED_H
#define LAMPYRIS_JOB_EXPECTED_H

#include "job/merge.h"

#define EXPECTED_HASH_BYTES 17 // 16 digits and the end of the string

// Computes the hash of everything that all parts of a render have in common, with its number of
// samples, but without the device and driver, and without the integrator if the job is to choose
// it. `job` must be a shard after job_init(); a device is not needed.
bool expected_hash(struct job *job, char out[EXPECTED_HASH_BYTES], struct err *err);
// Fails with ERR_INPUT if the file `path` exists and is not a part of this render, so that a shard
// would not continue from it.
bool expected_check_file(struct job *job, const char *path, struct err *err);
// Fails with ERR_INPUT if the parts are not of the render with this hash; NULL: any render.
bool expected_check_parts(const struct merge *merge, const char *hash, struct err *err);

#endif
