#include "base/file_lock.h"

#include "base/file.h"
#include "base/hash.h"
#include "base/log.h"
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

static bool fail(struct err *err, const char *output, const char *action)
{
    return err_set(err, ERR_OUTPUT, "%s: cannot %s: %s", output, action, strerror(errno));
}

// The output's name is hashed, because a longer name than its own may be too long. Links are
// followed first: those who write one file by two names are to meet.
static char *lock_path(const char *output, struct err *err)
{
    char *path = file_target(output);
    if (!path) {
        err_memory(err, "a path", strlen(output));
        return NULL;
    }
    const char *name = path_name(path);
    uint64_t hash = hash_bytes(HASH_INIT, name, strlen(name));
    int folder = (int)(name - path);
    size_t size = (size_t)folder + 64;
    char *out = malloc(size);
    if (out)
        snprintf(out, size, "%.*s.lampyris-%016" PRIx64 ".lock", folder, path, hash);
    else
        err_memory(err, "a path", size);
    free(path);
    return out;
}

// The holder before may have removed the file between our opening and locking it.
static bool is_current(int fd, const char *path)
{
    struct stat opened, named;
    return fstat(fd, &opened) == 0 && stat(path, &named) == 0 && opened.st_dev == named.st_dev &&
           opened.st_ino == named.st_ino;
}

// False with an error, or true with the lock taken, or true with fd -1: to be tried again.
static bool try_lock(struct file_lock *lock, const char *output, struct err *err)
{
    // Reading is enough for flock, also where the file is another user's.
    lock->fd = open(lock->path, O_RDONLY | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (lock->fd < 0)
        return fail(err, output, "create a lock in its folder");
    if (flock(lock->fd, LOCK_EX | LOCK_NB) != 0) {
        if (errno == EWOULDBLOCK)
            return err_set(err, ERR_OUTPUT,
                           "%s: is being written by another run, or named twice by this one; "
                           "expected one writer",
                           output);
        log_info("%s: cannot be locked: %s", output, strerror(errno));
        return true;
    }
    if (is_current(lock->fd, lock->path))
        return true;
    close(lock->fd);
    lock->fd = -1;
    return true;
}

static void forget(struct file_lock *lock)
{
    if (lock->fd >= 0)
        close(lock->fd);
    free(lock->path);
    *lock = (struct file_lock){.fd = -1};
}

bool file_lock_take(struct file_lock *lock, const char *output, struct err *err)
{
    *lock = (struct file_lock){.fd = -1};
    struct stat status;
    if (stat(output, &status) == 0 && !S_ISREG(status.st_mode))
        return true;
    lock->path = lock_path(output, err);
    if (!lock->path)
        return false;
    while (lock->fd < 0)
        if (!try_lock(lock, output, err)) {
            forget(lock);
            return false;
        }
    return true;
}

void file_lock_release(struct file_lock *lock)
{
    if (!lock || !lock->path)
        return;
    // While the lock is held: so that the file removed is ours, and not that of the next holder.
    unlink(lock->path);
    forget(lock);
}
