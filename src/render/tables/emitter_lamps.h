// A lamp is a group of emitters that are one object. Emissive triangles of an instance that share a
// corner, directly or through a chain of such triangles, are one lamp. Each shape, delta light and
// sun is a lamp of its own, and so is the environment's image.
#ifndef LAMPYRIS_RENDER_TABLES_EMITTER_LAMPS_H
#define LAMPYRIS_RENDER_TABLES_EMITTER_LAMPS_H

#include "base/arena.h"
#include "base/err.h"
#include "flatten/flatten.h"
#include "scene/core/scene.h"

struct emitter_lamps {
    uint32_t count;
    // True if there is a single lamp whose triangles are small: the diagonal of each triangle's
    // bounds is less than half the diagonal of the lamp's bounds. The triangles of quads and boxes
    // are not small.
    bool is_spread;
    // The lamp of each emissive triangle, and the number of these lamps. Triangles are the first
    // emitters.
    uint32_t *of_triangles, triangle_count, triangle_lamps;
};

// Finds the lamps and numbers them in the order of their first emitters (struct emitters). Arrays
// are in `arena`.
bool emitter_lamps_find(const struct scene *scene, const struct flat_scene *flat,
                        struct arena *arena, struct emitter_lamps *out, struct err *err);
// Returns the lamp of an emitter by the emitter's number.
uint32_t emitter_lamp_of(const struct emitter_lamps *lamps, uint32_t emitter);

#endif
