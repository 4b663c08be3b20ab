#include "base/system.h"

#include "base/windows/wide.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <windows.h>

unsigned system_processors(void)
{
    DWORD_PTR own, all;
    unsigned count = 0;
    if (GetProcessAffinityMask(GetCurrentProcess(), &own, &all))
        for (; own; own &= own - 1)
            count++;
    return count > 0 ? count : 1;
}

// Reads a text from the registry, as UTF-8.
static void read_text(const wchar_t *key, const wchar_t *name, char *out, size_t size)
{
    wchar_t text[256];
    DWORD bytes = sizeof text;
    const LSTATUS status =
        RegGetValueW(HKEY_LOCAL_MACHINE, key, name, RRF_RT_REG_SZ, NULL, text, &bytes);
    char *utf8 = status == ERROR_SUCCESS ? wide_to(text) : NULL;
    snprintf(out, size, "%s", utf8 ? utf8 : "unknown");
    free(utf8);
}

void system_processor_name(char *out, size_t size)
{
    read_text(L"HARDWARE\\DESCRIPTION\\System\\CentralProcessor\\0", L"ProcessorNameString", out,
              size);
}

void system_name(char *out, size_t size)
{
    char build[64];
    SYSTEM_INFO machine;
    GetNativeSystemInfo(&machine);
    read_text(L"SOFTWARE\\Microsoft\\Windows NT\\CurrentVersion", L"CurrentBuildNumber", build,
              sizeof build);
    snprintf(out, size, "Windows, build %s, %s", build,
             machine.wProcessorArchitecture == PROCESSOR_ARCHITECTURE_AMD64   ? "x86_64"
             : machine.wProcessorArchitecture == PROCESSOR_ARCHITECTURE_ARM64 ? "arm64"
                                                                              : "unknown");
}

double system_load(void)
{
    return (double)NAN;
}
