// Functions that file_system.c and file_handle.c share.
#ifndef LAMPYRIS_BASE_WINDOWS_FILE_STATUS_H
#define LAMPYRIS_BASE_WINDOWS_FILE_STATUS_H

#include "base/file_system.h"

// Reads the status of a HANDLE; returns false with errno set on failure.
bool file_status_from(void *handle, struct file_status *out);

// Opens a handle to query a file or folder, following links unless `of_link`. Returns
// INVALID_HANDLE_VALUE with errno set on failure. All of the program's handles let other processes
// read, rename and remove the file.
void *file_look_at(const char *path, bool of_link);

#endif
