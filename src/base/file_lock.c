#include "base/file_lock.h"

#include "base/clock.h"
#include "base/file.h"
#include "base/file_handle.h"
#include "base/file_system.h"
#include "base/hash.h"
#include "base/log.h"
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PAUSE_SECONDS 0.05 // time between two attempts to take a lock

static bool fail(struct err *err, const char *output, const char *action)
{
    return err_set(err, ERR_OUTPUT, "%s: cannot %s: %s", output, action, strerror(errno));
}

// The output's name is hashed, because a name that contains it could be too long for the file
// system. Links are followed first, so that two names of one file have the same lock.
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

// Tries to lock until another holder has released the lock, for at most `seconds`.
static int lock_within(const char *path, const char *output, double seconds, bool *is_locked)
{
    const uint64_t start = clock_ns();
    for (bool is_told = false;; is_told = true) {
        const int handle = file_handle_lock(path, is_locked);
        if (handle >= 0 || errno != EWOULDBLOCK || clock_seconds_since(start) >= seconds)
            return handle;
        if (!is_told)
            log_warn("%s: is being written by another run; waiting up to %.0f s for its end",
                     output, seconds);
        clock_sleep(PAUSE_SECONDS);
    }
}

static bool take(struct file_lock *lock, const char *output, double seconds, struct err *err)
{
    bool is_locked;
    lock->handle = lock_within(lock->path, output, seconds, &is_locked);
    if (lock->handle < 0 && errno == EWOULDBLOCK)
        return err_set(err, ERR_OUTPUT,
                       "%s: is being written by another run, or named twice by this one; "
                       "expected one writer",
                       output);
    if (lock->handle < 0)
        return fail(err, output, "create a lock in its folder");
    if (!is_locked)
        log_info("%s: cannot be locked: %s", output, strerror(errno));
    return true;
}

static void forget(struct file_lock *lock)
{
    free(lock->path);
    *lock = (struct file_lock){.handle = -1};
}

bool file_lock_take(struct file_lock *lock, const char *output, struct err *err)
{
    return file_lock_take_within(lock, output, 0.0, err);
}

bool file_lock_take_within(struct file_lock *lock, const char *output, double seconds,
                           struct err *err)
{
    *lock = (struct file_lock){.handle = -1};
    if (file_is_special(output))
        return true;
    lock->path = lock_path(output, err);
    if (lock->path && take(lock, output, seconds, err))
        return true;
    forget(lock);
    return false;
}

void file_lock_remove_stale(const char *output)
{
    struct file_lock lock = {.handle = -1, .path = lock_path(output, NULL)};
    bool is_locked = false;
    if (lock.path && file_exists(lock.path))
        lock.handle = file_handle_lock(lock.path, &is_locked);
    if (lock.handle < 0) {
        forget(&lock);
    } else if (is_locked) {
        file_lock_release(&lock);
    } else { // the file system has no locks, so another run may still use the file
        file_handle_close(lock.handle);
        forget(&lock);
    }
}

void file_lock_release(struct file_lock *lock)
{
    if (!lock || !lock->path)
        return;
    file_handle_unlock(lock->handle, lock->path);
    forget(lock);
}
