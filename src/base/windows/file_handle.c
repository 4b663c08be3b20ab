#include "base/file_handle.h"

#include "base/windows/file_status.h"
#include "base/windows/wide.h"
#include <errno.h>
#include <fcntl.h>
#include <io.h>
#include <limits.h>
#include <stdlib.h>
#include <windows.h>

#define SHARE_ALL (FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE)

static HANDLE system_handle(int handle)
{
    return (HANDLE)_get_osfhandle(handle);
}

static int open_wide(const char *path, DWORD access, DWORD sharing, DWORD creation, DWORD flags)
{
    wchar_t *wide = wide_from(path);
    if (!wide)
        return -1;
    HANDLE handle = CreateFileW(wide, access, sharing, NULL, creation, flags, NULL);
    free(wide);
    if (handle == INVALID_HANDLE_VALUE) {
        wide_fail();
        return -1;
    }
    const int out = _open_osfhandle((intptr_t)handle, _O_BINARY | _O_NOINHERIT);
    if (out < 0)
        CloseHandle(handle);
    return out;
}

// Folders are opened, too, so that callers can distinguish them from files.
int file_handle_open(const char *path)
{
    return open_wide(path, GENERIC_READ, SHARE_ALL, OPEN_EXISTING, FILE_FLAG_BACKUP_SEMANTICS);
}

int file_handle_create(const char *path, unsigned permissions)
{
    (void)permissions; // files inherit the permissions of their folder
    return open_wide(path, GENERIC_READ | GENERIC_WRITE | DELETE, SHARE_ALL, CREATE_NEW,
                     FILE_ATTRIBUTE_NORMAL);
}

// Windows has no files without a name.
int file_handle_create_unnamed(const char *folder, unsigned permissions)
{
    (void)folder, (void)permissions;
    errno = ENOSYS;
    return -1;
}

bool file_handle_name(int handle, const char *path)
{
    (void)handle, (void)path;
    errno = ENOSYS;
    return false;
}

int file_handle_open_stream(const char *path)
{
    return open_wide(path, GENERIC_WRITE, SHARE_ALL, OPEN_EXISTING, 0);
}

bool file_handle_close(int handle)
{
    return _close(handle) == 0;
}

bool file_handle_status(int handle, struct file_status *out)
{
    return file_status_from(system_handle(handle), out);
}

bool file_handle_set_permissions(int handle, unsigned permissions)
{
    (void)handle, (void)permissions;
    return true;
}

int64_t file_handle_read(int handle, void *data, size_t size)
{
    size_t done = 0;
    while (done < size) {
        const size_t left = size - done;
        const int got =
            _read(handle, (char *)data + done, left < INT_MAX ? (unsigned)left : INT_MAX);
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
        const int written = _write(handle, at, size < INT_MAX ? (unsigned)size : INT_MAX);
        if (written <= 0)
            return false;
        at += written;
        size -= (size_t)written;
    }
    return true;
}

bool file_handle_rewind(int handle)
{
    return _lseeki64(handle, 0, SEEK_SET) == 0;
}

bool file_handle_sync(int handle)
{
    return FlushFileBuffers(system_handle(handle)) || wide_fail();
}

// Opening without sharing is the lock. The system removes the file when the handle is closed.
int file_handle_lock(const char *path, bool *is_locked)
{
    *is_locked = true;
    return open_wide(path, GENERIC_READ | DELETE, 0, OPEN_ALWAYS, FILE_FLAG_DELETE_ON_CLOSE);
}

void file_handle_unlock(int handle, const char *path)
{
    (void)path;
    _close(handle);
}
