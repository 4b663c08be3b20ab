// Locks an output file, so that two runs do not write the same file.
#ifndef LAMPYRIS_BASE_FILE_LOCK_H
#define LAMPYRIS_BASE_FILE_LOCK_H

#include "base/err.h"
#include <stdbool.h>

// The lock is held on a small hidden file next to the output, because the output itself may not
// exist yet and is replaced at the end. The system releases the lock when the process ends in any
// way; a hidden file left behind by a killed process is not locked and is used again.
struct file_lock {
    int handle; // -1 if nothing is locked
    char *path; // path of the hidden file; NULL if there is none
};

// Fails at once with ERR_OUTPUT when another holder, in this process or another, has the lock of
// the same output. Devices, pipes and files on systems without locks are not locked.
bool file_lock_take(struct file_lock *lock, const char *output, struct err *err);
// Waits up to `seconds` for another holder, and says so, before it fails.
bool file_lock_take_within(struct file_lock *lock, const char *output, double seconds,
                           struct err *err);
// Removes the hidden file that a killed process has left next to the output, unless it is locked.
void file_lock_remove_stale(const char *output);
// Removes the hidden file. Accepts NULL and {0}.
void file_lock_release(struct file_lock *lock);

#endif
