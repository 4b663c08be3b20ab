// Which emitters vertices are connected to: the setting light_choice, decided by the scene alone,
// so that no device changes a picture.
#ifndef LAMPYRIS_RENDER_TABLES_LIGHT_CHOICE_H
#define LAMPYRIS_RENDER_TABLES_LIGHT_CHOICE_H

#include <stdbool.h>
#include <stdint.h>

struct light_choice {
    uint32_t way;      // LIGHT_CHOICE_*, never AUTO
    uint32_t vertices; // with LIGHT_CHOICE_ALL: first ones of a path, or ALL_VERTICES
    uint32_t rays;     // that a vertex sends at most
};

// `setting`: LIGHT_CHOICE_*. `lamps` are looked at where light_choice_asks_lamps() says so.
struct light_choice light_choice_of(uint32_t setting, uint64_t emitters, uint32_t lamps);
bool light_choice_asks_lamps(uint32_t setting);

struct light_choice_text {
    char text[160];
};
// What vertices are connected to, and why by default.
struct light_choice_text light_choice_print(uint32_t setting, uint64_t emitters, uint32_t lamps);

#endif
