// Open files, as numbers. -1 is none. What fails leaves its reason in errno.
#ifndef LAMPYRIS_BASE_FILE_HANDLE_H
#define LAMPYRIS_BASE_FILE_HANDLE_H

#include "base/file_system.h"
#include <stddef.h>

// For reading. Never blocks, also where the path is a pipe's or a device's.
int file_handle_open(const char *path);
// A new file for reading and writing, or EEXIST.
int file_handle_create(const char *path, unsigned permissions);
// A new file in the folder without a name: gone when the process ends, in whatever way, unless it
// is named before. Not every system and file system has them.
int file_handle_create_unnamed(const char *folder, unsigned permissions);
bool file_handle_name(int handle, const char *path);
// An existing pipe or device for writing. ENXIO: a pipe that nobody reads.
int file_handle_open_stream(const char *path);
bool file_handle_close(int handle);

bool file_handle_status(int handle, struct file_status *out);
bool file_handle_set_permissions(int handle, unsigned permissions);
// Up to `size` bytes, fewer only at the end of the file; -1 on failure.
int64_t file_handle_read(int handle, void *data, size_t size);
bool file_handle_write(int handle, const void *data, size_t size);
bool file_handle_rewind(int handle);
bool file_handle_sync(int handle); // all of it is on the disk

// Opens, or creates, a file and locks it until the handle is closed or its process ends, in
// whatever way. -1 with EWOULDBLOCK where another handle, in this process or another, has the lock.
// Where the file system has no locks, is_locked is false, and errno says why.
int file_handle_lock(const char *path, bool *is_locked);
// Removes the file and lifts the lock, in the order that leaves no other's file removed.
void file_handle_unlock(int handle, const char *path);

#endif
