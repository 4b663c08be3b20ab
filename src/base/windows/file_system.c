#include "base/windows/file_status.h"

#include "base/windows/wide.h"
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <windows.h>

#define SHARE_ALL (FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE)
#define EPOCH UINT64_C(116444736000000000) // 1970, in units of 100 ns since 1601

static enum file_kind kind_of(HANDLE handle, DWORD attributes)
{
    const DWORD type = GetFileType(handle);
    return type == FILE_TYPE_PIPE                  ? FILE_PIPE
           : type == FILE_TYPE_CHAR                ? FILE_CHARACTER_DEVICE
           : attributes & FILE_ATTRIBUTE_DIRECTORY ? FILE_FOLDER
                                                   : FILE_REGULAR;
}

bool file_status_from(void *handle, struct file_status *out)
{
    BY_HANDLE_FILE_INFORMATION info = {0};
    *out = (struct file_status){.kind = kind_of(handle, 0)};
    if (out->kind != FILE_REGULAR)
        return true;
    if (!GetFileInformationByHandle(handle, &info))
        return wide_fail();
    const uint64_t changed =
        (uint64_t)info.ftLastWriteTime.dwHighDateTime << 32 | info.ftLastWriteTime.dwLowDateTime;
    *out = (struct file_status){
        .kind = kind_of(handle, info.dwFileAttributes),
        .size = (uint64_t)info.nFileSizeHigh << 32 | info.nFileSizeLow,
        .device = info.dwVolumeSerialNumber,
        .number = (uint64_t)info.nFileIndexHigh << 32 | info.nFileIndexLow,
        .changed_ns = changed > EPOCH ? (changed - EPOCH) * 100 : 0,
    };
    return true;
}

void *file_look_at(const char *path, bool of_link)
{
    wchar_t *wide = wide_from(path);
    if (!wide)
        return INVALID_HANDLE_VALUE;
    const DWORD flags =
        FILE_FLAG_BACKUP_SEMANTICS | (of_link ? FILE_FLAG_OPEN_REPARSE_POINT : 0); // opens folders
    HANDLE handle =
        CreateFileW(wide, FILE_READ_ATTRIBUTES, SHARE_ALL, NULL, OPEN_EXISTING, flags, NULL);
    free(wide);
    if (handle == INVALID_HANDLE_VALUE)
        wide_fail();
    return handle;
}

bool file_status(const char *path, struct file_status *out)
{
    HANDLE handle = file_look_at(path, false);
    if (handle == INVALID_HANDLE_VALUE)
        return false;
    const bool ok = file_status_from(handle, out);
    CloseHandle(handle);
    return ok;
}

bool file_exists(const char *path)
{
    struct file_status status;
    return file_status(path, &status);
}

bool file_is_regular(const char *path)
{
    struct file_status status;
    return file_status(path, &status) && status.kind == FILE_REGULAR;
}

bool file_is_special(const char *path)
{
    struct file_status status;
    return file_status(path, &status) && status.kind != FILE_REGULAR;
}

static DWORD attributes_of(const char *path)
{
    wchar_t *wide = wide_from(path);
    const DWORD attributes = wide ? GetFileAttributesW(wide) : INVALID_FILE_ATTRIBUTES;
    free(wide);
    return attributes;
}

bool file_is_link(const char *path)
{
    const DWORD attributes = attributes_of(path);
    return attributes != INVALID_FILE_ATTRIBUTES && attributes & FILE_ATTRIBUTE_REPARSE_POINT;
}

bool file_is_writable(const char *path)
{
    const DWORD attributes = attributes_of(path);
    errno = EACCES;
    return attributes == INVALID_FILE_ATTRIBUTES || !(attributes & FILE_ATTRIBUTE_READONLY) ||
           attributes & FILE_ATTRIBUTE_DIRECTORY;
}

bool file_is_executable(const char *path)
{
    return attributes_of(path) != INVALID_FILE_ATTRIBUTES;
}

char *file_real_path(const char *path)
{
    HANDLE handle = file_look_at(path, false);
    if (handle == INVALID_HANDLE_VALUE)
        return NULL;
    const DWORD length = GetFinalPathNameByHandleW(handle, NULL, 0, 0);
    wchar_t *wide = length > 0 ? malloc((length + 1) * sizeof *wide) : NULL;
    char *out = NULL;
    if (wide && GetFinalPathNameByHandleW(handle, wide, length + 1, 0) > 0)
        out = wide_to_path(wide);
    else
        errno = wide ? EIO : ENOMEM;
    free(wide);
    CloseHandle(handle);
    return out;
}

// Returns NULL, because Windows needs no targets of links: file_real_path() follows links.
char *file_read_link(const char *path)
{
    (void)path;
    return NULL;
}

bool file_remove(const char *path)
{
    wchar_t *wide = wide_from(path);
    const bool ok = wide && (DeleteFileW(wide) || wide_fail());
    free(wide);
    return ok;
}

bool file_touch(const char *path)
{
    wchar_t *wide = wide_from(path);
    HANDLE handle =
        wide ? CreateFileW(wide, FILE_WRITE_ATTRIBUTES, SHARE_ALL, NULL, OPEN_EXISTING, 0, NULL)
             : INVALID_HANDLE_VALUE;
    FILETIME now;
    free(wide);
    if (handle == INVALID_HANDLE_VALUE)
        return wide_fail();
    GetSystemTimePreciseAsFileTime(&now);
    const bool ok = SetFileTime(handle, NULL, NULL, &now) || wide_fail();
    CloseHandle(handle);
    return ok;
}

// The move is durable when this returns, so that folder_sync() has nothing to do. A file that
// another process reads cannot be replaced by a move; ReplaceFileW() can replace it.
bool file_rename(const char *from, const char *to)
{
    const DWORD flags = MOVEFILE_REPLACE_EXISTING | MOVEFILE_WRITE_THROUGH;
    wchar_t *old_name = wide_from(from), *new_name = wide_from(to);
    bool ok = old_name && new_name;
    if (ok && !MoveFileExW(old_name, new_name, flags))
        ok = (GetLastError() == ERROR_ACCESS_DENIED &&
              ReplaceFileW(new_name, old_name, NULL, REPLACEFILE_WRITE_THROUGH, NULL, NULL)) ||
             wide_fail();
    free(old_name);
    free(new_name);
    return ok;
}

FILE *file_stream(const char *path, const char *mode)
{
    wchar_t *wide = wide_from(path), *wide_mode = wide_from(mode);
    FILE *out = wide && wide_mode ? _wfopen(wide, wide_mode) : NULL;
    free(wide);
    free(wide_mode);
    return out;
}

// In the mode, "T" keeps the file in memory while there is enough, and "D" removes it with its last
// handle.
FILE *file_stream_temporary(void)
{
    wchar_t folder[MAX_PATH + 1], path[MAX_PATH + 16];
    if (GetTempPathW(MAX_PATH + 1, folder) == 0 || !GetTempFileNameW(folder, L"lam", 0, path)) {
        wide_fail();
        return NULL;
    }
    return _wfopen(path, L"w+bTD");
}

bool file_stream_size(FILE *file, uint64_t *bytes)
{
    const int64_t end = _fseeki64(file, 0, SEEK_END) == 0 ? _ftelli64(file) : -1;
    *bytes = end < 0 ? 0 : (uint64_t)end;
    return end >= 0 && _fseeki64(file, 0, SEEK_SET) == 0;
}

bool folder_create(const char *path)
{
    wchar_t *wide = wide_from(path);
    const bool ok = wide && (CreateDirectoryW(wide, NULL) || wide_fail());
    free(wide);
    return ok;
}

bool folder_remove(const char *path)
{
    wchar_t *wide = wide_from(path);
    const bool ok = wide && (RemoveDirectoryW(wide) || wide_fail());
    free(wide);
    return ok;
}

// The user's folder for temporary files is accessible to that user only.
char *folder_create_temporary(void)
{
    wchar_t folder[MAX_PATH + 1], path[MAX_PATH + 64];
    const DWORD length = GetTempPathW(MAX_PATH + 1, folder);
    for (unsigned i = 0; length > 0 && i < 1000; i++) {
        swprintf(path, sizeof path / sizeof *path, L"%lslampyris-%lu-%u", folder,
                 (unsigned long)GetCurrentProcessId(), i);
        if (CreateDirectoryW(path, NULL))
            return wide_to_path(path);
        if (GetLastError() != ERROR_ALREADY_EXISTS)
            break;
    }
    wide_fail();
    return NULL;
}

bool folder_sync(const char *path)
{
    (void)path;
    return true;
}

struct folder_reader {
    HANDLE search;
    WIN32_FIND_DATAW found;
    bool has_found; // `found` has an entry that was not returned yet
    char *name;     // the last name returned
};

struct folder_reader *folder_open(const char *path)
{
    const size_t size = strlen(path) + 3;
    struct folder_reader *folder = calloc(1, sizeof *folder);
    char *pattern = malloc(size);
    if (pattern)
        snprintf(pattern, size, "%s/*", path);
    wchar_t *wide = pattern ? wide_from(pattern) : NULL;
    free(pattern);
    if (folder && wide)
        folder->search = FindFirstFileW(wide, &folder->found);
    free(wide);
    if (folder && wide && folder->search != INVALID_HANDLE_VALUE) {
        folder->has_found = true;
        return folder;
    }
    wide_fail();
    free(folder);
    return NULL;
}

const char *folder_next(struct folder_reader *folder)
{
    while (folder->has_found || FindNextFileW(folder->search, &folder->found)) {
        folder->has_found = false;
        free(folder->name);
        folder->name = wide_to(folder->found.cFileName);
        if (folder->name && strcmp(folder->name, ".") != 0 && strcmp(folder->name, "..") != 0)
            return folder->name;
    }
    return NULL;
}

void folder_close(struct folder_reader *folder)
{
    if (!folder)
        return;
    FindClose(folder->search);
    free(folder->name);
    free(folder);
}

// Asks the system about the path and, if that fails because it is not a folder, about its folder.
bool file_system_space(const char *path, uint64_t *bytes)
{
    wchar_t *wide = wide_from(path);
    ULARGE_INTEGER left = {0};
    bool ok = wide && GetDiskFreeSpaceExW(wide, &left, NULL, NULL);
    wchar_t *end = wide ? wcspbrk(wide, L"/\\") : NULL;
    for (wchar_t *next = end; next; next = wcspbrk(next + 1, L"/\\"))
        end = next;
    if (!ok && wide) {
        if (end)
            end[1] = L'\0';
        ok = GetDiskFreeSpaceExW(end ? wide : L".", &left, NULL, NULL);
    }
    free(wide);
    *bytes = left.QuadPart;
    return ok;
}

uint64_t file_size_limit_raise(void)
{
    return UINT64_MAX;
}
