#define _GNU_SOURCE
#include "base/memory.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>
#ifdef __APPLE__
#include <mach/mach.h>
#include <malloc/malloc.h>
#define malloc_usable_size malloc_size
#else
#include <malloc.h>
#endif

#define PATH_SIZE 1024

static uint64_t least(uint64_t a, uint64_t b)
{
    return a < b ? a : b;
}

static uint64_t difference(uint64_t a, uint64_t b)
{
    return a > b ? a - b : 0;
}

// Reads the number after `key` and blanks, from the first line that begins with them; an empty key
// selects the first line. Returns false if there is no number, but for example the word "max".
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

// The names of files in one version of control groups.
struct group_names {
    const char *mount;
    const char *limits[2];
    const char *used;
    const char *reclaimable; // key in memory.stat: file pages dropped when memory is short
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

// Returns the least memory left in a group and all groups above it, up to the highest visible one.
// In a container that is the container's own group, whatever the path says.
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

#ifdef __APPLE__
// Counts free pages and inactive ones.
static uint64_t machine_left(const char *root)
{
    vm_statistics64_data_t pages;
    mach_msg_type_number_t count = HOST_VM_INFO64_COUNT;
    (void)root;
    if (host_statistics64(mach_host_self(), HOST_VM_INFO64, (host_info64_t)&pages, &count) !=
        KERN_SUCCESS)
        return UINT64_MAX;
    return ((uint64_t)pages.free_count + pages.inactive_count) * (uint64_t)sysconf(_SC_PAGESIZE);
}
#else
static uint64_t machine_left(const char *root)
{
    char path[PATH_SIZE];
    uint64_t kilobytes;
    snprintf(path, sizeof path, "%s/proc/meminfo", root);
    return read_value(path, "MemAvailable:", &kilobytes) ? kilobytes * 1024 : UINT64_MAX;
}
#endif

uint64_t memory_available_in(const char *root)
{
    return least(machine_left(root), all_groups_left(root));
}

// /proc/self/statm counts pages: the first number is the address space, the sixth the data
// (proc(5)).
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

static uint64_t page_bytes(void)
{
    return (uint64_t)sysconf(_SC_PAGESIZE);
}

uint64_t memory_physical(void)
{
    const long pages = sysconf(_SC_PHYS_PAGES);
    return pages > 0 ? (uint64_t)pages * page_bytes() : 0;
}

uint64_t memory_resident(void)
{
    FILE *file = fopen("/proc/self/statm", "re");
    uint64_t pages = 0;
    if (file && fscanf(file, "%*u %" SCNu64, &pages) != 1)
        pages = 0;
    if (file)
        fclose(file);
    return pages * page_bytes();
}

uint64_t memory_peak(void)
{
    struct rusage usage;
#ifdef __APPLE__
    const uint64_t unit = 1;
#else
    const uint64_t unit = 1024;
#endif
    return getrusage(RUSAGE_SELF, &usage) == 0 ? (uint64_t)usage.ru_maxrss * unit : 0;
}

size_t memory_block_bytes(void *data)
{
    return malloc_usable_size(data);
}
