#include "cli/sibling.h"

#include "base/file.h"
#include "base/file_system.h"
#include "base/process.h"
#include <limits.h>
#include <stdio.h>

void sibling_find(const char *program, const char *in_build_folder, char *out, size_t size)
{
    const char *const places[] = {program, in_build_folder};
    char own[PATH_MAX];
    const bool is_known = process_own_path(own, sizeof own);
    for (size_t i = 0; is_known && i < sizeof places / sizeof *places; i++) {
        int folder = (int)(path_name(own) - own);
        if (snprintf(out, size, "%.*s%s", folder, own, places[i]) < (int)size &&
            file_is_executable(out))
            return;
    }
    snprintf(out, size, "%s", program);
}
