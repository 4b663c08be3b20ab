// Open files, identified by numbers; -1 is no file. Functions that fail set errno.
#ifndef LAMPYRIS_BASE_FILE_HANDLE_H
#define LAMPYRIS_BASE_FILE_HANDLE_H

#include "base/file_system.h"
#include <stddef.h>

// Opens a file for reading. Never blocks, even if the path is a pipe or a device.
int file_handle_open(const char *path);
// Creates a new file for reading and writing. Fails with EEXIST if the path exists.
int file_handle_create(const char *path, unsigned permissions);
// Creates a new file without a name in the folder. Unless it gets a name, it vanishes when its
// handle is closed. Not every system and file system supports this.
int file_handle_create_unnamed(const char *folder, unsigned permissions);
bool file_handle_name(int handle, const char *path);
// Opens an existing pipe or device for writing. Fails with ENXIO for a pipe without a reader.
int file_handle_open_stream(const char *path);
bool file_handle_close(int handle);

bool file_handle_status(int handle, struct file_status *out);
bool file_handle_set_permissions(int handle, unsigned permissions);
// Reads up to `size` bytes and returns their number, which is smaller only at the end of the file;
// -1 on failure.
int64_t file_handle_read(int handle, void *data, size_t size);
bool file_handle_write(int handle, const void *data, size_t size);
bool file_handle_rewind(int handle);
bool file_handle_sync(int handle); // makes all data written durable

// Opens or creates a file and locks it until the handle is closed or its process ends. Returns -1
// with EWOULDBLOCK if another handle, in any process, has the lock. If the file system does not
// support locks, sets *is_locked to false and errno to the reason.
int file_handle_lock(const char *path, bool *is_locked);
// Removes the file and releases the lock. Never removes a file that another holder has locked.
void file_handle_unlock(int handle, const char *path);

#endif
