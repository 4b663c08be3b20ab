#include "gpu/gpu_internal.h"

#include <ctype.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#define VARIABLE "LAMPYRIS_LIMITS"

// Sets the flag that a word names. Returns false if the word is not the name of a flag.
static bool take_flag(struct gpu_limit_overrides *limits, const char *word, size_t length)
{
    const struct {
        const char *name;
        bool *flag;
    } flags[] = {
        {"api-1.1", &limits->api_1_1},
        {"no-texel", &limits->no_texel},
        {"no-ballot", &limits->no_ballot},
        {"no-rounding-mode", &limits->no_rounding_mode},
        {"no-mapped-device", &limits->no_mapped_device},
        {"no-timestamps", &limits->no_timestamps},
        {"shared-stack", &limits->shared_stack},
        {"sort-rays", &limits->sort_rays},
    };
    for (size_t i = 0; i < sizeof flags / sizeof flags[0]; i++) {
        if (length == strlen(flags[i].name) && memcmp(word, flags[i].name, length) == 0) {
            *flags[i].flag = true;
            return true;
        }
    }
    return false;
}

// Parses a word NAME=NUMBER. A number that the caller has set already is not replaced. Returns
// false if the name is unknown or the number is invalid.
static bool take_number(struct gpu_limit_overrides *limits, const char *word, size_t length)
{
    const struct {
        const char *name;
        uint64_t *number;
        uint64_t most; // greatest valid number; 0: no limit
    } numbers[] = {
        {"storage-range=", &limits->storage_range},
        {"storage-count=", &limits->storage_count},
        {"texel-count=", &limits->texel_count},
        {"texel-elements=", &limits->texel_elements},
        {"allocation=", &limits->allocation},
        {"shared-memory=", &limits->shared_memory},
        {"memory=", &limits->memory},
        {"memory-budget=", &limits->memory_budget},
        {"group-ns=", &limits->group_ns},
        {"watchdog-ms=", &limits->watchdog_ms},
        {"waves=", &limits->waves, 2},
    };
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
        size_t name_length = strlen(numbers[i].name);
        if (length <= name_length || memcmp(word, numbers[i].name, name_length) != 0)
            continue;
        char *end;
        errno = 0;
        uint64_t number = strtoull(word + name_length, &end, 10);
        // strtoull accepts a sign, and would convert -1 to the largest number.
        if (!isdigit((unsigned char)word[name_length]) || end != word + length || errno ||
            number == 0 || (numbers[i].most > 0 && number > numbers[i].most))
            return false;
        if (*numbers[i].number == 0)
            *numbers[i].number = number;
        return true;
    }
    return false;
}

bool limits_from_environment(struct gpu_limit_overrides *limits, struct err *err)
{
    const char *word = getenv(VARIABLE);
    while (word && *word) {
        size_t length = strcspn(word, ",");
        if (!take_flag(limits, word, length) && !take_number(limits, word, length))
            return err_set(
                err, ERR_USAGE,
                VARIABLE
                ": \"%.*s\" is unknown; expected api-1.1, no-texel, no-ballot, "
                "no-rounding-mode, no-mapped-device, no-timestamps, shared-stack, "
                "sort-rays, storage-range=BYTES, storage-count=N, texel-count=N, texel-elements=N, "
                "allocation=BYTES, shared-memory=BYTES, memory=BYTES, "
                "memory-budget=BYTES, group-ns=N, watchdog-ms=N, waves=1 or waves=2",
                (int)length, word);
        word += length + (word[length] == ',');
    }
    return true;
}
