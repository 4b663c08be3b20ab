#include "render/tables/albedo_tables.h"

const uint32_t albedo_tables[ALBEDO_WORDS][4] = {
#include "albedo_data.h"
};
