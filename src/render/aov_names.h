// Lists the names of sets of AOV_* bits that --aov and --error-by accept.
#ifndef LAMPYRIS_RENDER_AOV_NAMES_H
#define LAMPYRIS_RENDER_AOV_NAMES_H

#include <stdint.h>

struct aov_name {
    const char *name;
    uint32_t bits;
};

// Each list ends with "all", which is followed by an entry whose name is NULL.
extern const struct aov_name aov_names[], error_by_names[];

// Writes the names of the single bits that are set in `bits`, separated by commas, or "none".
#define AOV_NAMES_TEXT_MAX 160
void aov_names_text(uint32_t bits, const struct aov_name *names, char text[AOV_NAMES_TEXT_MAX]);

#endif
