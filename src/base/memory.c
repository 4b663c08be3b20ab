#include "base/memory.h"

#include <inttypes.h>
#include <malloc.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

// --- what the machine has ------------------------------------------------------------------------

#define PATH_SIZE 1024

static uint64_t least(uint64_t a, uint64_t b)
{
    return a < b ? a : b;
}

static uint64_t difference(uint64_t a, uint64_t b)
{
    return a > b ? a - b : 0;
}

// The number behind `key` and blanks at the beginning of some line, or of the first line where the
// key is "". False where there is none, and for words such as "max".
static bool read_value(const char *path, const char *key, uint64_t *out)
{
    FILE *file = fopen(path, "re");
    char line[256];
    size_t length = strlen(key);
    bool found = false;
    while (file && !found && fgets(line, sizeof line, file)) {
        const char *value = line + length + strspn(line + length, " \t");
        if (strncmp(line, key, length) == 0 && *value >= '0' && *value <= '9') {
            *out = strtoull(value, NULL, 10);
            found = true;
        } else if (length == 0) {
            break;
        }
    }
    if (file)
        fclose(file);
    return found;
}

// What the two versions of control groups call the same things.
struct group_names {
    const char *mount;
    const char *limits[2];
    const char *used;
    const char *reclaimable; // in memory.stat: pages of files that are dropped when memory is short
};

static const struct group_names versions[] = {
    {"/sys/fs/cgroup/memory",
     {"memory.limit_in_bytes", NULL},
     "memory.usage_in_bytes",
     "total_inactive_file"},
    {"/sys/fs/cgroup", {"memory.max", "memory.high"}, "memory.current", "inactive_file"},
};

static uint64_t group_left(const struct group_names *names, const char *root, const char *group)
{
    char path[PATH_SIZE];
    uint64_t limit = UINT64_MAX, value, used = 0, reclaimable = 0;
    for (int i = 0; i < 2 && names->limits[i]; i++) {
        snprintf(path, sizeof path, "%s%s%s/%s", root, names->mount, group, names->limits[i]);
        if (read_value(path, "", &value))
            limit = least(limit, value);
    }
    if (limit == UINT64_MAX)
        return UINT64_MAX;
    snprintf(path, sizeof path, "%s%s%s/%s", root, names->mount, group, names->used);
    read_value(path, "", &used);
    snprintf(path, sizeof path, "%s%s%s/memory.stat", root, names->mount, group);
    read_value(path, names->reclaimable, &reclaimable);
    return difference(limit, difference(used, reclaimable));
}

// A group has no more than the groups that it is in, up to the root of what is seen of them: in a
// container that is the container's own, whatever the path says.
static uint64_t groups_left(const struct group_names *names, const char *root, char *group)
{
    uint64_t left = UINT64_MAX;
    for (;;) {
        left = least(left, group_left(names, root, group));
        char *end = strrchr(group, '/');
        if (!end)
            return left;
        *end = '\0';
    }
}

// A line of /proc/self/cgroup is "NUMBER:CONTROLLERS:PATH"; version 2 has the number 0 and no
// controllers (cgroups(7)).
static uint64_t all_groups_left(const char *root)
{
    char path[PATH_SIZE], line[PATH_SIZE];
    snprintf(path, sizeof path, "%s/proc/self/cgroup", root);
    FILE *file = fopen(path, "re");
    uint64_t left = UINT64_MAX;
    while (file && fgets(line, sizeof line, file)) {
        line[strcspn(line, "\n")] = '\0';
        char *controllers = strchr(line, ':');
        char *group = controllers ? strchr(controllers + 1, ':') : NULL;
        if (!group)
            continue;
        *group++ = '\0';
        bool is_second = strcmp(line, "0:") == 0;
        if (is_second || strcmp(controllers + 1, "memory") == 0)
            left = least(left, groups_left(&versions[is_second], root, group));
    }
    if (file)
        fclose(file);
    return left;
}

static uint64_t machine_left(const char *root)
{
    char path[PATH_SIZE];
    uint64_t kilobytes;
    snprintf(path, sizeof path, "%s/proc/meminfo", root);
    return read_value(path, "MemAvailable:", &kilobytes) ? kilobytes * 1024 : UINT64_MAX;
}

uint64_t memory_available_in(const char *root)
{
    return least(machine_left(root), all_groups_left(root));
}

// /proc/self/statm counts pages: all of the address space first, the data sixth (proc(5)).
uint64_t memory_limits_left(void)
{
    uint64_t pages[6] = {0}, page = (uint64_t)sysconf(_SC_PAGESIZE), left = UINT64_MAX;
    FILE *file = fopen("/proc/self/statm", "re");
    for (int i = 0; file && i < 6; i++)
        if (fscanf(file, "%" SCNu64, &pages[i]) != 1)
            pages[i] = 0;
    if (file)
        fclose(file);
    const struct {
        int resource;
        uint64_t pages;
    } limits[] = {{RLIMIT_AS, pages[0]}, {RLIMIT_DATA, pages[5]}};
    for (size_t i = 0; i < sizeof limits / sizeof limits[0]; i++) {
        struct rlimit limit;
        if (getrlimit(limits[i].resource, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
            left = least(left, difference(limit.rlim_cur, limits[i].pages * page));
    }
    return left;
}

uint64_t memory_available(void)
{
    return least(memory_available_in(""), memory_limits_left());
}

uint64_t memory_default_budget(void)
{
    uint64_t available = memory_available();
    return available == UINT64_MAX ? 0 : available / 4 * 3;
}

// --- what the process has ------------------------------------------------------------------------

static struct {
    _Atomic uint64_t budget; // 0: no limit
    _Atomic uint64_t used, failures;
    _Atomic uint64_t refused, left; // the last refusal, and what there was then
} memory;

void memory_set_budget(uint64_t bytes)
{
    atomic_store(&memory.budget, bytes);
}

uint64_t memory_budget(void)
{
    return atomic_load(&memory.budget);
}

uint64_t memory_used(void)
{
    return atomic_load(&memory.used);
}

uint64_t memory_failures(void)
{
    return atomic_load(&memory.failures);
}

uint64_t memory_refused(uint64_t *left)
{
    *left = atomic_load(&memory.left);
    return atomic_exchange(&memory.refused, 0);
}

static void note_failure(uint64_t refused)
{
    atomic_store(&memory.left, difference(memory_budget(), memory_used()));
    atomic_store(&memory.refused, refused);
    atomic_fetch_add(&memory.failures, 1);
}

static bool fits(uint64_t bytes, uint64_t used)
{
    uint64_t budget = atomic_load_explicit(&memory.budget, memory_order_relaxed);
    return budget == 0 || bytes <= difference(budget, used);
}

bool memory_take(uint64_t bytes)
{
    uint64_t used = atomic_load_explicit(&memory.used, memory_order_relaxed);
    while (fits(bytes, used))
        if (atomic_compare_exchange_weak(&memory.used, &used, used + bytes))
            return true;
    note_failure(bytes);
    return false;
}

void memory_give(uint64_t bytes)
{
    atomic_fetch_sub(&memory.used, bytes);
}

void memory_fail(uint64_t bytes)
{
    memory_give(bytes);
    note_failure(0);
}

bool memory_check(uint64_t bytes, const char *what, struct err *err)
{
    if (fits(bytes, memory_used()))
        return true;
    note_failure(bytes);
    return err_memory(err, what, bytes);
}

void *memory_alloc(size_t bytes)
{
    if (!memory_take(bytes))
        return NULL;
    void *data = calloc(1, bytes);
    if (!data) {
        memory_fail(bytes);
        return NULL;
    }
    // What memory_free will find.
    atomic_fetch_add(&memory.used, malloc_usable_size(data) - bytes);
    return data;
}

void memory_free(void *data)
{
    if (data)
        memory_give(malloc_usable_size(data));
    free(data);
}

// --- words ---------------------------------------------------------------------------------------

uint64_t memory_peak(void)
{
    struct rusage usage;
    return getrusage(RUSAGE_SELF, &usage) == 0 ? (uint64_t)usage.ru_maxrss * 1024 : 0;
}

struct memory_text memory_print(uint64_t bytes)
{
    static const char *const units[] = {"KiB", "MiB", "GiB", "TiB", "PiB", "EiB"};
    struct memory_text out;
    double value = (double)bytes / 1024;
    size_t unit = 0;
    for (; value >= 1023.95 && unit + 1 < sizeof units / sizeof units[0]; unit++)
        value /= 1024;
    if (bytes < 1024)
        snprintf(out.text, sizeof out.text, "%u bytes", (unsigned)bytes);
    else
        snprintf(out.text, sizeof out.text, "%.1f %s", value, units[unit]);
    return out;
}
