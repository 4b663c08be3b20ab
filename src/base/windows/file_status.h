// What files known by name and open ones share.
#ifndef LAMPYRIS_BASE_WINDOWS_FILE_STATUS_H
#define LAMPYRIS_BASE_WINDOWS_FILE_STATUS_H

#include "base/file_system.h"

// Of a HANDLE. False with errno.
bool file_status_from(void *handle, struct file_status *out);

// A handle for looking at a file or folder, links followed unless `of_link`; INVALID_HANDLE_VALUE
// with errno where there is none. All of our handles let others read, rename and remove the file.
void *file_look_at(const char *path, bool of_link);

#endif
