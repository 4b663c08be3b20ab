#include "render/aov_names.h"

#include "shared/aov.h"
#include <stdio.h>
#include <string.h>

const struct aov_name aov_names[] = {
    {"albedo", AOV_ALBEDO},
    {"normal", AOV_NORMAL},
    {"normal_geometric", AOV_NORMAL_GEOMETRIC},
    {"depth", AOV_DEPTH},
    {"position", AOV_POSITION},
    {"ids", AOV_IDS},
    {"emission", AOV_EMISSION},
    {"direct", AOV_DIRECT},
    {"indirect", AOV_INDIRECT},
    {"samples", AOV_SAMPLES},
    {"variance", AOV_VARIANCE},
    {"halves", AOV_HALVES},
    {"alpha", AOV_ALPHA},
    {"steps", AOV_STEPS},
    {"all", AOV_END - 1u},
    {NULL},
};

const struct aov_name error_by_names[] = {
    {"part", AOV_BY_PART},
    {"bounce", AOV_BY_BOUNCE},
    {"emitter", AOV_BY_EMITTER},
    {"all", AOVS_BY},
    {NULL},
};

void aov_names_text(uint32_t bits, const struct aov_name *names, char text[AOV_NAMES_TEXT_MAX])
{
    text[0] = '\0';
    size_t length = 0;
    // Omits the last name, "all", which stands for the bits of all others.
    for (const struct aov_name *name = names; name[1].name; name++)
        if (bits & name->bits)
            length += (size_t)snprintf(text + length, AOV_NAMES_TEXT_MAX - length, "%s%s",
                                       length ? "," : "", name->name);
    if (length == 0)
        strcpy(text, "none");
}
