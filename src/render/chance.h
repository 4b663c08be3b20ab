// Bounds the radiance that only scattered rays find, without the help of shadow rays.
#ifndef LAMPYRIS_RENDER_CHANCE_H
#define LAMPYRIS_RENDER_CHANCE_H

#include "flatten/flatten.h"
#include "render/specialize.h"
#include "render/tables/emitters.h"
#include "scene/core/scene.h"

// Returns the greatest radiance, in any channel, of an emitter that a path may hit although no
// shadow ray is aimed at it: through glass, metal or gloss, or from any surface if shadow rays are
// off or directions are not sampled by the BSDF. A sun that shadow rays sample more often than
// scattered rays hit it does not count. A texture counts with its brightest texel. 0: there is no
// such emitter. The error estimate assumes that a future path may contribute this much.
float brightest_by_chance(const struct scene *scene, const struct flat_scene *flat,
                          const struct specialization *specialization,
                          const struct emitters *emitters);

#endif
