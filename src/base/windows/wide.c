#include "base/windows/wide.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <windows.h>

wchar_t *wide_from(const char *text)
{
    const int length = MultiByteToWideChar(CP_UTF8, MB_ERR_INVALID_CHARS, text, -1, NULL, 0);
    wchar_t *out = length > 0 ? malloc((size_t)length * sizeof *out) : NULL;
    if (out)
        MultiByteToWideChar(CP_UTF8, MB_ERR_INVALID_CHARS, text, -1, out, length);
    else
        errno = length > 0 ? ENOMEM : EINVAL;
    return out;
}

char *wide_to(const wchar_t *text)
{
    const int length = WideCharToMultiByte(CP_UTF8, 0, text, -1, NULL, 0, NULL, NULL);
    char *out = length > 0 ? malloc((size_t)length) : NULL;
    if (out)
        WideCharToMultiByte(CP_UTF8, 0, text, -1, out, length, NULL, NULL);
    else
        errno = length > 0 ? ENOMEM : EINVAL;
    return out;
}

char *wide_to_path(const wchar_t *path)
{
    static const wchar_t prefix[] = L"\\\\?\\";
    char *out = wide_to(wcsncmp(path, prefix, wcslen(prefix)) == 0 ? path + wcslen(prefix) : path);
    for (char *at = out; at && (at = strchr(at, '\\'));)
        *at = '/';
    return out;
}

bool wide_fail(void)
{
    static const struct {
        DWORD reason;
        int number;
    } reasons[] = {
        {ERROR_FILE_NOT_FOUND, ENOENT},      {ERROR_PATH_NOT_FOUND, ENOENT},
        {ERROR_INVALID_NAME, ENOENT},        {ERROR_BAD_NETPATH, ENOENT},
        {ERROR_ACCESS_DENIED, EACCES},       {ERROR_SHARING_VIOLATION, EWOULDBLOCK},
        {ERROR_LOCK_VIOLATION, EWOULDBLOCK}, {ERROR_FILE_EXISTS, EEXIST},
        {ERROR_ALREADY_EXISTS, EEXIST},      {ERROR_DIR_NOT_EMPTY, ENOTEMPTY},
        {ERROR_DISK_FULL, ENOSPC},           {ERROR_HANDLE_DISK_FULL, ENOSPC},
        {ERROR_NOT_ENOUGH_MEMORY, ENOMEM},   {ERROR_OUTOFMEMORY, ENOMEM},
        {ERROR_TOO_MANY_OPEN_FILES, EMFILE}, {ERROR_WRITE_PROTECT, EROFS},
        {ERROR_NOT_SUPPORTED, ENOSYS},       {ERROR_PIPE_BUSY, ENXIO},
    };
    const DWORD reason = GetLastError();
    errno = EIO;
    for (size_t i = 0; i < sizeof reasons / sizeof *reasons; i++)
        if (reasons[i].reason == reason)
            errno = reasons[i].number;
    return false;
}
