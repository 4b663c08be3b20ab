// A function that file_system.c and file_handle.c share.
#ifndef LAMPYRIS_BASE_POSIX_FILE_STATUS_H
#define LAMPYRIS_BASE_POSIX_FILE_STATUS_H

#include "base/file_system.h"
#include <sys/stat.h>

struct file_status file_status_from(const struct stat *status);

#endif
