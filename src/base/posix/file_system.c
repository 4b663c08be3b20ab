#define _GNU_SOURCE // for st_mtim and mkdtemp
#include "base/posix/file_status.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#ifdef __APPLE__
#define st_mtim st_mtimespec
#endif

static enum file_kind kind_of(mode_t mode)
{
    return S_ISDIR(mode)    ? FILE_FOLDER
           : S_ISFIFO(mode) ? FILE_PIPE
           : S_ISCHR(mode)  ? FILE_CHARACTER_DEVICE
           : S_ISBLK(mode)  ? FILE_BLOCK_DEVICE
           : S_ISSOCK(mode) ? FILE_SOCKET
                            : FILE_REGULAR;
}

struct file_status file_status_from(const struct stat *status)
{
    return (struct file_status){
        .kind = kind_of(status->st_mode),
        .permissions = status->st_mode & 07777,
        .size = status->st_size > 0 ? (uint64_t)status->st_size : 0,
        .device = (uint64_t)status->st_dev,
        .number = (uint64_t)status->st_ino,
        .changed_ns = (uint64_t)status->st_mtim.tv_sec * UINT64_C(1000000000) +
                      (uint64_t)status->st_mtim.tv_nsec,
    };
}

bool file_status(const char *path, struct file_status *out)
{
    struct stat status;
    if (stat(path, &status) != 0)
        return false;
    *out = file_status_from(&status);
    return true;
}

bool file_exists(const char *path)
{
    return access(path, F_OK) == 0;
}

bool file_is_regular(const char *path)
{
    struct stat status;
    return stat(path, &status) == 0 && S_ISREG(status.st_mode);
}

bool file_is_special(const char *path)
{
    struct stat status;
    return stat(path, &status) == 0 && !S_ISREG(status.st_mode);
}

bool file_is_link(const char *path)
{
    struct stat status;
    return lstat(path, &status) == 0 && S_ISLNK(status.st_mode);
}

bool file_is_writable(const char *path)
{
    return access(path, W_OK) == 0;
}

bool file_is_executable(const char *path)
{
    return access(path, X_OK) == 0;
}

char *file_real_path(const char *path)
{
    return realpath(path, NULL);
}

char *file_read_link(const char *path)
{
    char text[PATH_MAX];
    const ssize_t length = readlink(path, text, sizeof text - 1);
    return length > 0 ? strndup(text, (size_t)length) : NULL;
}

bool file_remove(const char *path)
{
    return unlink(path) == 0;
}

bool file_touch(const char *path)
{
    return utimensat(AT_FDCWD, path, NULL, 0) == 0;
}

bool file_rename(const char *from, const char *to)
{
    return rename(from, to) == 0;
}

FILE *file_stream(const char *path, const char *mode)
{
    char closed_in_children[8];
    snprintf(closed_in_children, sizeof closed_in_children, "%se", mode);
    return fopen(path, closed_in_children);
}

FILE *file_stream_temporary(void)
{
    return tmpfile();
}

bool file_stream_size(FILE *file, uint64_t *bytes)
{
    const off_t end = fseeko(file, 0, SEEK_END) == 0 ? ftello(file) : -1;
    *bytes = end < 0 ? 0 : (uint64_t)end;
    return end >= 0 && fseeko(file, 0, SEEK_SET) == 0;
}

bool folder_create(const char *path)
{
    return mkdir(path, 0777) == 0;
}

bool folder_remove(const char *path)
{
    return rmdir(path) == 0;
}

char *folder_create_temporary(void)
{
    static const char pattern[] = "/lampyris-XXXXXX";
    const char *parent = getenv("TMPDIR");
    parent = parent && *parent ? parent : "/tmp";
    const size_t size = strlen(parent) + sizeof pattern;
    char *path = malloc(size);
    if (!path)
        return NULL;
    snprintf(path, size, "%s%s", parent, pattern);
    if (mkdtemp(path))
        return path;
    free(path);
    return NULL;
}

// Some file systems cannot sync a folder; that is not an error.
bool folder_sync(const char *path)
{
    const int fd = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (fd < 0)
        return true; // a folder may be writable without being readable
    const bool ok = fsync(fd) == 0 || errno == EINVAL || errno == ENOTSUP;
    const int reason = errno;
    close(fd);
    errno = reason;
    return ok;
}

struct folder_reader *folder_open(const char *path)
{
    return (struct folder_reader *)opendir(path);
}

const char *folder_next(struct folder_reader *folder)
{
    for (const struct dirent *entry; (entry = readdir((DIR *)folder));)
        if (strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0)
            return entry->d_name;
    return NULL;
}

void folder_close(struct folder_reader *folder)
{
    if (folder)
        closedir((DIR *)folder);
}

bool file_system_space(const char *path, uint64_t *bytes)
{
    struct statvfs space;
    if (statvfs(path, &space) != 0 || space.f_blocks == 0)
        return false;
    *bytes = (uint64_t)space.f_bavail * space.f_frsize;
    return true;
}

uint64_t file_size_limit_raise(void)
{
    struct rlimit size;
    if (getrlimit(RLIMIT_FSIZE, &size) != 0)
        return UINT64_MAX;
    size.rlim_cur = size.rlim_max;
    setrlimit(RLIMIT_FSIZE, &size);
    return size.rlim_max == RLIM_INFINITY ? UINT64_MAX : size.rlim_max;
}
