#include "cli/merge/leftovers.h"

#include "base/arena.h"
#include "base/clock.h"
#include "base/file.h"
#include "base/file_lock.h"
#include "base/file_system.h"
#include <string.h>

// Temporary files that were not changed for this time are removed. Writing one file takes seconds
// to minutes, and the clock of a file server hardly differs by an hour from that of this machine.
#define STALE_SECONDS 3600.0

static bool is_stale(const char *path)
{
    struct file_status status;
    const uint64_t now = clock_wall_ns();
    return file_status(path, &status) && status.kind == FILE_REGULAR && now > status.changed_ns &&
           (double)(now - status.changed_ns) * 1e-9 > STALE_SECONDS;
}

static void remove_temporaries(const char *folder, struct arena *arena)
{
    struct folder_reader *reader = folder_open(*folder ? folder : ".");
    for (const char *name; reader && (name = folder_next(reader));) {
        const char *path =
            file_is_temporary(name) ? arena_printf(arena, "%s%s", folder, name) : NULL;
        if (path && is_stale(path))
            file_remove(path);
    }
    folder_close(reader);
}

void leftovers_remove(const char *const *parts, uint32_t count)
{
    struct arena arena = {0};
    const char *before = NULL;
    for (uint32_t i = 0; i < count; i++) {
        file_lock_remove_stale(parts[i]);
        const char *folder =
            arena_printf(&arena, "%.*s", (int)(path_name(parts[i]) - parts[i]), parts[i]);
        if (!folder || (before && strcmp(folder, before) == 0))
            continue;
        remove_temporaries(folder, &arena);
        before = folder;
    }
    arena_finish(&arena);
}
