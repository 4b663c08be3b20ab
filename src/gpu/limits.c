#include "gpu_internal.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#define VARIABLE "LAMPYRIS_LIMITS"

// One of the words that stand for a flag or a number; false when it is none of them.
static bool take_word(struct gpu_limit_overrides *limits, const char *word, size_t length)
{
    const struct {
        const char *name;
        bool *flag;
        uint64_t *number;
    } words[] = {
        {"no-texel", &limits->no_texel, NULL},
        {"no-ballot", &limits->no_ballot, NULL},
        {"no-mapped-device", &limits->no_mapped_device, NULL},
        {"storage-range=", NULL, &limits->storage_range},
        {"texel-elements=", NULL, &limits->texel_elements},
        {"allocation=", NULL, &limits->allocation},
    };
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
        size_t name_length = strlen(words[i].name);
        if (length < name_length || strncmp(word, words[i].name, name_length) != 0)
            continue;
        if (words[i].flag) {
            *words[i].flag = true;
            return length == name_length;
        }
        char *end;
        errno = 0;
        uint64_t number = strtoull(word + name_length, &end, 10);
        if (end != word + length || errno || number == 0)
            return false;
        if (*words[i].number == 0)
            *words[i].number = number;
        return true;
    }
    return false;
}

bool limits_from_environment(struct gpu_limit_overrides *limits, struct err *err)
{
    const char *word = getenv(VARIABLE);
    while (word && *word) {
        size_t length = strcspn(word, ",");
        if (!take_word(limits, word, length))
            return err_set(err, ERR_USAGE,
                           VARIABLE ": \"%.*s\" is unknown; expected no-texel, no-ballot, "
                                    "no-mapped-device, storage-range=BYTES, texel-elements=N or "
                                    "allocation=BYTES",
                           (int)length, word);
        word += length + (word[length] == ',');
    }
    return true;
}
