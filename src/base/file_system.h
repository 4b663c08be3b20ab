// File operations by name. Paths are UTF-8 with "/" as separator on every system. Functions that
// fail set errno.
#ifndef LAMPYRIS_BASE_FILE_SYSTEM_H
#define LAMPYRIS_BASE_FILE_SYSTEM_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#ifdef _WIN32
#define PATH_SEPARATORS "/\\" // separators that users may write
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
    unsigned permissions; // bits of owner, group and others, see chmod(1); 0 where there are none
    uint64_t size;
    uint64_t device, number; // identify a file
    uint64_t changed_ns;     // when its content changed: comparable with clock_wall_ns()
};

bool file_status(const char *path, struct file_status *out); // links are followed
bool file_exists(const char *path);
bool file_is_regular(const char *path);
bool file_is_special(const char *path); // there, and no regular file
bool file_is_link(const char *path);
bool file_is_writable(const char *path);
bool file_is_executable(const char *path); // a program, or a folder to look into
static inline bool file_status_same(const struct file_status *a, const struct file_status *b)
{
    return a->device == b->device && a->number == b->number;
}

// Returns the absolute path with links resolved, allocated with malloc; NULL if the file does not
// exist.
char *file_real_path(const char *path);
// Returns the target of a link, allocated with malloc; NULL if it is no link.
char *file_read_link(const char *path);

bool file_remove(const char *path);
bool file_touch(const char *path); // sets the time of modification to now
// At one stroke: whoever opens `to` finds the old content or the new one.
bool file_rename(const char *from, const char *to);

// fopen(), and a stream that reads and writes a file that nobody else sees and that is gone once
// it is closed.
FILE *file_stream(const char *path, const char *mode);
FILE *file_stream_temporary(void);
// The size of its file, whose beginning is then what is read next.
bool file_stream_size(FILE *file, uint64_t *bytes);

bool folder_create(const char *path);
bool folder_remove(const char *path); // an empty one
// A new one in the folder for temporary files, from malloc; only this user may look into it.
char *folder_create_temporary(void);
// Makes what was renamed into it durable. True where the system has no such request.
bool folder_sync(const char *path);

// The names in a folder, without "." and "..", in no order. NULL where it cannot be read.
struct folder_reader *folder_open(const char *path);
const char *folder_next(struct folder_reader *folder); // until the next call; NULL: no more
void folder_close(struct folder_reader *folder);       // accepts NULL

// Bytes that this user may still write where `path` is; false where that is not known.
bool file_system_space(const char *path, uint64_t *bytes);
// Sets the limit of a file's size as high as this process may, and returns it (ulimit -f);
// UINT64_MAX: none.
uint64_t file_size_limit_raise(void);

#endif
