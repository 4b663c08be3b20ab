// Decides which emitters vertices connect to (the setting light_choice), from the scene alone, so
// that the picture does not depend on the device.
#ifndef LAMPYRIS_RENDER_TABLES_LIGHT_CHOICE_H
#define LAMPYRIS_RENDER_TABLES_LIGHT_CHOICE_H

#include "render/tables/emitter_lamps.h"

struct light_choice {
    uint32_t way;      // LIGHT_CHOICE_*, but never AUTO
    uint32_t vertices; // with LIGHT_CHOICE_ALL: the number of vertices of a path, from its
                       // beginning, that sample all lamps, or ALL_VERTICES
    uint32_t rays;     // maximum number of shadow rays of a vertex
};

// Returns the strategy that a setting (LIGHT_CHOICE_*) means. `lamps` is used only if
// light_choice_asks_lamps() returns true.
struct light_choice light_choice_of(uint32_t setting, uint64_t emitters,
                                    const struct emitter_lamps *lamps);
bool light_choice_asks_lamps(uint32_t setting);

struct light_choice_text {
    char text[160];
};
// Returns a text for display: to which emitters vertices send shadow rays and, if the setting is
// LIGHT_CHOICE_AUTO, why.
struct light_choice_text light_choice_print(uint32_t setting, uint64_t emitters,
                                            const struct emitter_lamps *lamps);

#endif
