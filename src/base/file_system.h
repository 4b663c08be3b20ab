// File operations by name. Paths are UTF-8 with "/" as separator on every system. Functions that
// fail set errno.
#ifndef LAMPYRIS_BASE_FILE_SYSTEM_H
#define LAMPYRIS_BASE_FILE_SYSTEM_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#ifdef _WIN32
#define PATH_SEPARATORS "/\\" // separators that users may write in paths
#define PATH_BEGINS_WITH_DRIVE(path) ((path)[1] == ':')
#else
#define PATH_SEPARATORS "/"
#define PATH_BEGINS_WITH_DRIVE(path) false
#endif

enum file_kind {
    FILE_REGULAR,
    FILE_FOLDER,
    FILE_PIPE,
    FILE_CHARACTER_DEVICE,
    FILE_BLOCK_DEVICE,
    FILE_SOCKET,
};

struct file_status {
    enum file_kind kind;
    unsigned permissions; // for owner, group and others, as in chmod(1); 0: the system has none
    uint64_t size;
    uint64_t device, number; // together they identify a file
    uint64_t changed_ns;     // last change of the content, comparable with clock_wall_ns()
};

bool file_status(const char *path, struct file_status *out); // follows links
bool file_exists(const char *path);
bool file_is_regular(const char *path);
bool file_is_special(const char *path); // whether the path exists and is not a regular file
bool file_is_link(const char *path);
bool file_is_writable(const char *path);
bool file_is_executable(const char *path); // whether a program may be run, or a folder searched
static inline bool file_status_same(const struct file_status *a, const struct file_status *b)
{
    return a->device == b->device && a->number == b->number;
}

// Returns the absolute path with links resolved, allocated with malloc; NULL if the file does not
// exist.
char *file_real_path(const char *path);
// Returns the target of a link, allocated with malloc; NULL if the path is not a link.
char *file_read_link(const char *path);

bool file_remove(const char *path);
bool file_touch(const char *path); // sets the time of modification to now
// Replaces `to` atomically: whoever opens `to` finds either the old content or the new one.
bool file_rename(const char *from, const char *to);

// Opens a file as fopen() does. file_stream_temporary() opens a file for reading and writing. Only
// this process can see that file, and it is removed when it is closed.
FILE *file_stream(const char *path, const char *mode);
FILE *file_stream_temporary(void);
// Returns the size of the stream's file, and moves the stream to the file's beginning.
bool file_stream_size(FILE *file, uint64_t *bytes);

bool folder_create(const char *path);
bool folder_remove(const char *path); // the folder must be empty
// Creates a new folder in the system's folder for temporary files, accessible only to this user.
// Returns its path, allocated with malloc.
char *folder_create_temporary(void);
// Makes renames in a folder durable. Returns true on systems without such an operation.
bool folder_sync(const char *path);

// Reads the names in a folder, without "." and "..", in no particular order. folder_open() returns
// NULL if the folder cannot be read.
struct folder_reader *folder_open(const char *path);
const char *folder_next(struct folder_reader *folder); // valid until the next call; NULL: no more
                                                       // names
void folder_close(struct folder_reader *folder);       // accepts NULL

// Gets the number of bytes that this user may still write to the file system of `path`; returns
// false if it is not known.
bool file_system_space(const char *path, uint64_t *bytes);
// Raises this process's limit on the size of a file (ulimit -f) as far as it may, and returns it;
// UINT64_MAX if there is no limit.
uint64_t file_size_limit_raise(void);

#endif
