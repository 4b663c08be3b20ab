// A lock on an output file, so that two runs do not write one picture in turn.
#ifndef LAMPYRIS_BASE_FILE_LOCK_H
#define LAMPYRIS_BASE_FILE_LOCK_H

#include "base/err.h"
#include <stdbool.h>

// The lock is on a small hidden file beside the output: the output itself cannot carry
// it, because it may not exist yet and is replaced at the end. The system lifts the lock with the
// process, however that ends; a file left behind by a killed one locks nothing and is used again.
struct file_lock {
    int handle; // -1 where there is none
    char *path; // of the hidden file; NULL where there is none
};

// Fails at once (ERR_OUTPUT) when another holder, in this process or another, has the lock of the
// same output. Devices and pipes have no lock, nor have files on systems without locks.
bool file_lock_take(struct file_lock *lock, const char *output, struct err *err);
// Removes the hidden file. Accepts NULL and {0}.
void file_lock_release(struct file_lock *lock);

#endif
