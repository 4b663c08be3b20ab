// Lamps: what shines as one. Emissive triangles of an instance that have a corner in common are of
// one lamp, and so are those that a chain of such triangles leads to; each shape, each light
// without extent, each sun and the environment's image is a lamp of its own.
#ifndef LAMPYRIS_RENDER_TABLES_EMITTER_LAMPS_H
#define LAMPYRIS_RENDER_TABLES_EMITTER_LAMPS_H

#include "base/arena.h"
#include "base/err.h"
#include "flatten/flatten.h"
#include "scene/core/scene.h"

struct emitter_lamps {
    uint32_t count;
    // Triangles are the first emitters: the lamp of each, and of how many lamps they are.
    uint32_t *of_triangles, triangle_count, triangle_lamps;
};

// Numbered in the order of the first of their emitters (struct emitters). In `arena`.
bool emitter_lamps_find(const struct scene *scene, const struct flat_scene *flat,
                        struct arena *arena, struct emitter_lamps *out, struct err *err);
// Returns the lamp of an emitter, by its number.
uint32_t emitter_lamp_of(const struct emitter_lamps *lamps, uint32_t emitter);

#endif
