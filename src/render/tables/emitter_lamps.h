// A lamp is a group of emitters that shine as one. Emissive triangles of an instance that share a
// corner, directly or through a chain of such triangles, are one lamp; each shape, delta light and
// sun, and the environment's image, is a lamp of its own.
#ifndef LAMPYRIS_RENDER_TABLES_EMITTER_LAMPS_H
#define LAMPYRIS_RENDER_TABLES_EMITTER_LAMPS_H

#include "base/arena.h"
#include "base/err.h"
#include "flatten/flatten.h"
#include "scene/core/scene.h"

struct emitter_lamps {
    uint32_t count;
    // True for a single lamp of small triangles: the bounds' diagonal of each is less than half of
    // the lamp's.
    bool is_spread;
    // Triangles are the first emitters: the lamp of each, and the number of their lamps.
    uint32_t *of_triangles, triangle_count, triangle_lamps;
};

// Numbers lamps in the order of their first emitters (struct emitters). Arrays are in `arena`.
bool emitter_lamps_find(const struct scene *scene, const struct flat_scene *flat,
                        struct arena *arena, struct emitter_lamps *out, struct err *err);
// Returns the lamp of an emitter, by its number.
uint32_t emitter_lamp_of(const struct emitter_lamps *lamps, uint32_t emitter);

#endif
