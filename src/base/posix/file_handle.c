#define _GNU_SOURCE // for O_TMPFILE
#include "base/file_handle.h"

#include "base/posix/file_status.h"
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <sys/file.h>
#include <unistd.h>

// O_NONBLOCK lets the opening of a FIFO without a writer return at once. It has no effect on
// regular files.
int file_handle_open(const char *path)
{
    return open(path, O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
}

int file_handle_create(const char *path, unsigned permissions)
{
    return open(path, O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, (mode_t)permissions);
}

#ifdef O_TMPFILE

// Returns the path in /proc through which a file without a name can get one.
static void link_of(int handle, char path[64])
{
    snprintf(path, 64, "/proc/self/fd/%d", handle);
}

int file_handle_create_unnamed(const char *folder, unsigned permissions)
{
    char link[64];
    const int handle = open(folder, O_RDWR | O_TMPFILE | O_CLOEXEC, (mode_t)permissions);
    link_of(handle, link);
    if (handle < 0 || access(link, F_OK) == 0)
        return handle;
    close(handle);
    return -1;
}

bool file_handle_name(int handle, const char *path)
{
    char link[64];
    link_of(handle, link);
    return linkat(AT_FDCWD, link, AT_FDCWD, path, AT_SYMLINK_FOLLOW) == 0;
}

#else

int file_handle_create_unnamed(const char *folder, unsigned permissions)
{
    (void)folder, (void)permissions;
    errno = ENOTSUP;
    return -1;
}

bool file_handle_name(int handle, const char *path)
{
    (void)handle, (void)path;
    errno = ENOTSUP;
    return false;
}

#endif

// Opens without blocking, because opening a pipe without a reader would block for ever. Writing to
// it blocks as usual.
int file_handle_open_stream(const char *path)
{
    const int handle = open(path, O_WRONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
    const int flags = handle >= 0 ? fcntl(handle, F_GETFL) : -1;
    if (flags >= 0 && fcntl(handle, F_SETFL, flags & ~O_NONBLOCK) >= 0)
        return handle;
    const int reason = errno;
    if (handle >= 0)
        close(handle);
    errno = reason;
    return -1;
}

bool file_handle_close(int handle)
{
    return close(handle) == 0;
}

bool file_handle_status(int handle, struct file_status *out)
{
    struct stat status;
    if (fstat(handle, &status) != 0)
        return false;
    *out = file_status_from(&status);
    return true;
}

bool file_handle_set_permissions(int handle, unsigned permissions)
{
    return fchmod(handle, (mode_t)permissions) == 0;
}

int64_t file_handle_read(int handle, void *data, size_t size)
{
    size_t done = 0;
    while (done < size) {
        const ssize_t got = read(handle, (char *)data + done, size - done);
        if (got < 0 && errno == EINTR)
            continue;
        if (got < 0)
            return -1;
        if (got == 0)
            break;
        done += (size_t)got;
    }
    return (int64_t)done;
}

bool file_handle_write(int handle, const void *data, size_t size)
{
    for (const char *at = data; size > 0;) {
        const ssize_t written = write(handle, at, size);
        if (written < 0 && errno == EINTR)
            continue;
        if (written < 0)
            return false;
        at += written;
        size -= (size_t)written;
    }
    return true;
}

bool file_handle_rewind(int handle)
{
    return lseek(handle, 0, SEEK_SET) == 0;
}

// Uses F_FULLFSYNC on macOS, where fsync() leaves data in the disk's cache.
bool file_handle_sync(int handle)
{
#ifdef F_FULLFSYNC
    if (fcntl(handle, F_FULLFSYNC) == 0)
        return true;
#endif
    return fsync(handle) == 0;
}

// Returns whether the path still leads to the open file. A former holder of the lock may have
// removed the file after it was opened here and before it was locked.
static bool is_current(int handle, const char *path)
{
    struct file_status opened, named;
    return file_handle_status(handle, &opened) && file_status(path, &named) &&
           file_status_same(&opened, &named);
}

int file_handle_lock(const char *path, bool *is_locked)
{
    for (;;) {
        // flock() needs only read permission, so another user's file can be locked, too.
        const int handle = open(path, O_RDONLY | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
        if (handle < 0)
            return -1;
        *is_locked = flock(handle, LOCK_EX | LOCK_NB) == 0;
        if (*is_locked ? is_current(handle, path) : errno != EWOULDBLOCK)
            return handle;
        const bool is_taken = !*is_locked;
        close(handle);
        errno = EWOULDBLOCK;
        if (is_taken)
            return -1;
    }
}

void file_handle_unlock(int handle, const char *path)
{
    unlink(path); // removed while it is still locked; afterwards it may belong to the next holder
    close(handle);
}
