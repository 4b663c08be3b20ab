#include "base/memory.h"

#include <malloc.h>
#include <windows.h>

#include <psapi.h> // needs windows.h before it

static uint64_t least(uint64_t a, uint64_t b)
{
    return a < b ? a : b;
}

static MEMORYSTATUSEX read_status(void)
{
    MEMORYSTATUSEX status = {.dwLength = sizeof status};
    if (!GlobalMemoryStatusEx(&status))
        status = (MEMORYSTATUSEX){0};
    return status;
}

uint64_t memory_available_in(const char *root)
{
    (void)root;
    const uint64_t left = read_status().ullAvailPhys;
    return left > 0 ? left : UINT64_MAX;
}

// A job object may limit the memory that each process commits, and that all its processes commit
// together.
uint64_t memory_limits_left(void)
{
    JOBOBJECT_EXTENDED_LIMIT_INFORMATION job;
    PROCESS_MEMORY_COUNTERS own;
    const MEMORYSTATUSEX status = read_status();
    uint64_t left = status.ullAvailPageFile > 0 ? status.ullAvailPageFile : UINT64_MAX;
    if (!QueryInformationJobObject(NULL, JobObjectExtendedLimitInformation, &job, sizeof job,
                                   NULL) ||
        !GetProcessMemoryInfo(GetCurrentProcess(), &own, sizeof own))
        return left;
    const DWORD flags = job.BasicLimitInformation.LimitFlags;
    uint64_t limit = UINT64_MAX;
    if (flags & JOB_OBJECT_LIMIT_PROCESS_MEMORY)
        limit = job.ProcessMemoryLimit;
    if (flags & JOB_OBJECT_LIMIT_JOB_MEMORY)
        limit = least(limit, job.JobMemoryLimit);
    if (limit == UINT64_MAX)
        return left;
    return least(left, limit > own.PagefileUsage ? limit - own.PagefileUsage : 0);
}

uint64_t memory_available(void)
{
    return least(memory_available_in(""), memory_limits_left());
}

uint64_t memory_physical(void)
{
    return read_status().ullTotalPhys;
}

uint64_t memory_resident(void)
{
    PROCESS_MEMORY_COUNTERS own;
    return GetProcessMemoryInfo(GetCurrentProcess(), &own, sizeof own) ? own.WorkingSetSize : 0;
}

uint64_t memory_peak(void)
{
    PROCESS_MEMORY_COUNTERS own;
    return GetProcessMemoryInfo(GetCurrentProcess(), &own, sizeof own) ? own.PeakWorkingSetSize : 0;
}

size_t memory_block_bytes(void *data)
{
    return _msize(data);
}
