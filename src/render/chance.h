// Finds what paths meet by chance alone.
#ifndef LAMPYRIS_RENDER_CHANCE_H
#define LAMPYRIS_RENDER_CHANCE_H

#include "flatten/flatten.h"
#include "render/specialize.h"
#include "render/tables/emitters.h"
#include "scene/core/scene.h"

// The greatest radiance, of a channel, of an emitter that a path may meet where no shadow ray is
// aimed at it: by way of glass, metal or gloss, or of any surface where shadow rays are off or
// directions are not drawn by the surface. A sun that shadow rays look for more often than
// scattered rays meet it is not left to chance. 0 where there is none. A texture counts
// with its brightest texel. What is known of the error takes it for what no sample may have found
// yet.
float brightest_by_chance(const struct scene *scene, const struct flat_scene *flat,
                          const struct specialization *specialization,
                          const struct emitters *emitters);

#endif
