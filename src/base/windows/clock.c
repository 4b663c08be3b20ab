#include "base/clock.h"

#include <windows.h>

#define SECOND_NS UINT64_C(1000000000)

uint64_t clock_ns(void)
{
    LARGE_INTEGER ticks, frequency; // frequency: ticks per second
    QueryPerformanceFrequency(&frequency);
    QueryPerformanceCounter(&ticks);
    const uint64_t count = (uint64_t)ticks.QuadPart, rate = (uint64_t)frequency.QuadPart;
    return count / rate * SECOND_NS + count % rate * SECOND_NS / rate;
}

// A FILETIME counts 100 ns since 1601, 11,644,473,600 seconds before 1970.
uint64_t clock_wall_ns(void)
{
    FILETIME time;
    GetSystemTimePreciseAsFileTime(&time);
    const uint64_t count = (uint64_t)time.dwHighDateTime << 32 | time.dwLowDateTime;
    return (count - UINT64_C(116444736000000000)) * 100;
}

// Sleep() may return up to a tick early.
void clock_sleep(double seconds)
{
    const uint64_t end_ns = clock_ns() + (uint64_t)(seconds * 1e9);
    for (uint64_t now_ns; (now_ns = clock_ns()) < end_ns;)
        Sleep((DWORD)((end_ns - now_ns + 999999) / 1000000));
}
