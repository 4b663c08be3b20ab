// The layout of the pictures besides the radiance (AOV_*) in the records of slots and of the film.
// Only the pictures in the mask of wanted ones have a place.
#ifndef LAMPYRIS_SHARED_AOV_H
#define LAMPYRIS_SHARED_AOV_H

#include "bindings.h"

// AOVs of the first surface that a camera ray meets. Depth and position are means over the samples
// that met one, so they need AOV_ALPHA, the share of those samples.
#define AOVS_OF_SURFACES                                                                           \
    (AOV_ALBEDO | AOV_NORMAL | AOV_NORMAL_GEOMETRIC | AOV_DEPTH | AOV_POSITION | AOV_IDS |         \
     AOV_ALPHA)
#define AOVS_OF_PLACES (AOV_DEPTH | AOV_POSITION)
#define AOVS_OF_PARTS (AOV_EMISSION | AOV_DIRECT | AOV_INDIRECT)
#define AOVS_OF_SLOTS (AOVS_OF_SURFACES | AOVS_OF_PARTS | AOV_STEPS)
// Those that are summed over samples: all but the ids.
#define AOVS_SUMMED (AOVS_OF_SLOTS & ~AOV_IDS)

// Constant expressions: 1 where `bit` is one of those in `aovs` that precede `end`.
#define AOV_BEFORE(aovs, end, bit) (((aovs) & (bit) & ((end)-1u)) != 0u ? 1u : 0u)
#define AOV_VECTORS_BEFORE(aovs, end)                                                              \
    (AOV_BEFORE(aovs, end, AOV_ALBEDO) + AOV_BEFORE(aovs, end, AOV_NORMAL) +                       \
     AOV_BEFORE(aovs, end, AOV_NORMAL_GEOMETRIC) + AOV_BEFORE(aovs, end, AOV_POSITION) +           \
     AOV_BEFORE(aovs, end, AOV_EMISSION) + AOV_BEFORE(aovs, end, AOV_DIRECT) +                     \
     AOV_BEFORE(aovs, end, AOV_INDIRECT))
#define AOV_SCALARS_BEFORE(aovs, end)                                                              \
    (AOV_BEFORE(aovs, end, AOV_DEPTH) + AOV_BEFORE(aovs, end, AOV_ALPHA) +                         \
     AOV_BEFORE(aovs, end, AOV_STEPS))

// The first of a picture's floats in a record: vectors of three first, then scalars.
#define AOV_VECTOR_AT(aovs, bit) (3u * AOV_VECTORS_BEFORE(aovs, bit))
#define AOV_SCALAR_AT(aovs, bit)                                                                   \
    (3u * AOV_VECTORS_BEFORE(aovs, AOV_END) + AOV_SCALARS_BEFORE(aovs, bit))
// So many words of four take them. In the film each component is a sum (film_sums.h), and each four
// of them have a word for their digits.
#define AOV_SUM_WORDS(aovs)                                                                        \
    ((3u * AOV_VECTORS_BEFORE(aovs, AOV_END) + AOV_SCALARS_BEFORE(aovs, AOV_END) + 3u) / 4u)
// The last word: x is the primitive of the pixel's first sample by its number in the flat scene,
// shapes with PRIMITIVE_SHAPE, plus 1; 0: it met nothing. y is its instance, plus 1; 0: it is in
// the world itself. z is its material, plus 1.
#define AOV_ID_WORDS(aovs) AOV_BEFORE(aovs, AOV_END, AOV_IDS)

// A slot, and a film record for each half-buffer, keep the contribution of each class of --error-by
// to the radiance. The classes of the kinds that were asked for follow one another: parts, then
// bounces, then emitters.
#define BY_PART_COUNT 3u   // after no, one, and more than one scattering event
#define BY_BOUNCE_COUNT 8u // after 0, 1, 2, ... scattering events; the last class has all the rest
#define BY_EMITTER_TRIANGLES 0u
#define BY_EMITTER_SHAPES 1u
#define BY_EMITTER_LIGHTS 2u // delta lights: point, spot and directional
#define BY_EMITTER_SUNS 3u
#define BY_EMITTER_ENVIRONMENT 4u
#define BY_EMITTER_COUNT 5u
#define AOVS_BY (AOV_BY_PART | AOV_BY_BOUNCE | AOV_BY_EMITTER)
// The first class of each kind, and how many there are in all.
#define AOV_BOUNCES_AT(aovs) (((aovs)&AOV_BY_PART) != 0u ? BY_PART_COUNT : 0u)
#define AOV_EMITTERS_AT(aovs)                                                                      \
    (AOV_BOUNCES_AT(aovs) + (((aovs)&AOV_BY_BOUNCE) != 0u ? BY_BOUNCE_COUNT : 0u))
#define AOV_CLASSES(aovs)                                                                          \
    (AOV_EMITTERS_AT(aovs) + (((aovs)&AOV_BY_EMITTER) != 0u ? BY_EMITTER_COUNT : 0u))
#define AOV_HAS_CLASSES(aovs) (((aovs)&AOVS_BY) != 0u ? 1u : 0u)

// The brightest contribution besides: of a slot a word of four, r, g, b and where it comes from; of
// the film one more, whose x is the number of its sample. All 0: no light.
#define BRIGHTEST_ORIGIN(bounce, site, emitter)                                                    \
    ((bounce) | (site) << BRIGHTEST_SITE_SHIFT | (emitter) << BRIGHTEST_EMITTER_SHIFT)
#define BRIGHTEST_BOUNCE_MASK 0xffffffu // scattering events
#define BRIGHTEST_SITE_SHIFT 24         // SITE_*
#define BRIGHTEST_EMITTER_SHIFT 28      // BY_EMITTER_*
#define BRIGHTEST_FIELD_MASK 15u        // for the last two

// Records in words of four: of a slot, the radiance first, of the film behind gpu_film_pixel (sums,
// then their digits), and of what is read back behind gpu_resolved_pixel. The classes and the
// brightest contribution follow the sums; of the film a class has what gpu_film_pixel has, without
// numbers of samples; of what is read back the means of half A, then of half B.
#define AOV_SLOT_CLASSES_AT(aovs) (1u + AOV_SUM_WORDS(aovs))
#define AOV_SLOT_BRIGHTEST_AT(aovs) (AOV_SLOT_CLASSES_AT(aovs) + AOV_CLASSES(aovs))
#define AOV_SLOT_WORDS(aovs)                                                                       \
    (AOV_SLOT_BRIGHTEST_AT(aovs) + AOV_HAS_CLASSES(aovs) + AOV_ID_WORDS(aovs))
#define AOV_FILM_DIGITS_AT(aovs) (FILM_WORDS + 4u * AOV_SUM_WORDS(aovs))
#define AOV_FILM_CLASSES_AT(aovs)                                                                  \
    (AOV_FILM_DIGITS_AT(aovs) +                                                                    \
     (AOV_SUM_WORDS(aovs) + FILM_GROUPS_A_WORD - 1u) / FILM_GROUPS_A_WORD)
#define AOV_FILM_BRIGHTEST_AT(aovs) (AOV_FILM_CLASSES_AT(aovs) + FILM_WORDS * AOV_CLASSES(aovs))
#define AOV_FILM_WORDS(aovs)                                                                       \
    (AOV_FILM_BRIGHTEST_AT(aovs) + 2u * AOV_HAS_CLASSES(aovs) + AOV_ID_WORDS(aovs))
#define AOV_RESOLVED_CLASSES_AT(aovs) (RESOLVED_WORDS + AOV_SUM_WORDS(aovs))
#define AOV_RESOLVED_BRIGHTEST_AT(aovs) (AOV_RESOLVED_CLASSES_AT(aovs) + 2u * AOV_CLASSES(aovs))
#define AOV_RESOLVED_WORDS(aovs)                                                                   \
    (AOV_RESOLVED_BRIGHTEST_AT(aovs) + 2u * AOV_HAS_CLASSES(aovs) + AOV_ID_WORDS(aovs))

#endif
