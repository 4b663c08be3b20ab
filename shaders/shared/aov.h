// Defines the layout of the AOVs in the records of slots and of the film. Only requested AOVs have
// a place.
#ifndef LAMPYRIS_SHARED_AOV_H
#define LAMPYRIS_SHARED_AOV_H

#include "bindings.h"

// AOVs of the first surface that a camera ray hits. Depth and position are means over the samples
// that hit a surface, so they need AOV_ALPHA, the fraction of those samples.
#define AOVS_OF_SURFACES                                                                           \
    (AOV_ALBEDO | AOV_NORMAL | AOV_NORMAL_GEOMETRIC | AOV_DEPTH | AOV_POSITION | AOV_IDS |         \
     AOV_ALPHA)
#define AOVS_OF_PLACES (AOV_DEPTH | AOV_POSITION)
#define AOVS_OF_PARTS (AOV_EMISSION | AOV_DIRECT | AOV_INDIRECT)
#define AOVS_OF_SLOTS (AOVS_OF_SURFACES | AOVS_OF_PARTS | AOV_STEPS)
// The AOVs that are summed over samples: all except the ids.
#define AOVS_SUMMED (AOVS_OF_SLOTS & ~AOV_IDS)

// This constant expression is 1 if `bit` is set in `aovs` and is below `end`, else 0.
#define AOV_BEFORE(aovs, end, bit) (((aovs) & (bit) & ((end)-1u)) != 0u ? 1u : 0u)
#define AOV_VECTORS_BEFORE(aovs, end)                                                              \
    (AOV_BEFORE(aovs, end, AOV_ALBEDO) + AOV_BEFORE(aovs, end, AOV_NORMAL) +                       \
     AOV_BEFORE(aovs, end, AOV_NORMAL_GEOMETRIC) + AOV_BEFORE(aovs, end, AOV_POSITION) +           \
     AOV_BEFORE(aovs, end, AOV_EMISSION) + AOV_BEFORE(aovs, end, AOV_DIRECT) +                     \
     AOV_BEFORE(aovs, end, AOV_INDIRECT))
#define AOV_SCALARS_BEFORE(aovs, end)                                                              \
    (AOV_BEFORE(aovs, end, AOV_DEPTH) + AOV_BEFORE(aovs, end, AOV_ALPHA) +                         \
     AOV_BEFORE(aovs, end, AOV_STEPS))

// Offset of an AOV in the floats of a record: vectors of three come first, then scalars.
#define AOV_VECTOR_AT(aovs, bit) (3u * AOV_VECTORS_BEFORE(aovs, bit))
#define AOV_SCALAR_AT(aovs, bit)                                                                   \
    (3u * AOV_VECTORS_BEFORE(aovs, AOV_END) + AOV_SCALARS_BEFORE(aovs, bit))
// The number of uvec4 words that the AOVs occupy. In the film each component is a sum
// (film_sums.h), and each group of four sums has a word for its digits.
#define AOV_SUM_WORDS(aovs)                                                                        \
    ((3u * AOV_VECTORS_BEFORE(aovs, AOV_END) + AOV_SCALARS_BEFORE(aovs, AOV_END) + 3u) / 4u)
// The ids are the last word of a record. x: 1 + the primitive of the pixel's first sample, as its
// index in the flat scene, with PRIMITIVE_SHAPE for shapes; 0 if it hit nothing. y: 1 + its
// instance; 0 for world space. z: 1 + its material.
#define AOV_ID_WORDS(aovs) AOV_BEFORE(aovs, AOV_END, AOV_IDS)

// For each class of --error-by, a slot, and both half-buffers of a film record, hold the
// contribution of that class to the radiance. The classes of the requested kinds are adjacent:
// parts first, then bounces, then emitters.
#define BY_PART_COUNT 3u   // after none, one, and more than one scattering event
#define BY_BOUNCE_COUNT 8u // after 0, 1, 2, ... scattering events; the last class has all others
#define BY_EMITTER_TRIANGLES 0u
#define BY_EMITTER_SHAPES 1u
#define BY_EMITTER_LIGHTS 2u // delta lights: point, spot and directional
#define BY_EMITTER_SUNS 3u
#define BY_EMITTER_ENVIRONMENT 4u
#define BY_EMITTER_COUNT 5u
#define AOVS_BY (AOV_BY_PART | AOV_BY_BOUNCE | AOV_BY_EMITTER)
// The first class of each kind, and the number of all classes.
#define AOV_BOUNCES_AT(aovs) (((aovs)&AOV_BY_PART) != 0u ? BY_PART_COUNT : 0u)
#define AOV_EMITTERS_AT(aovs)                                                                      \
    (AOV_BOUNCES_AT(aovs) + (((aovs)&AOV_BY_BOUNCE) != 0u ? BY_BOUNCE_COUNT : 0u))
#define AOV_CLASSES(aovs)                                                                          \
    (AOV_EMITTERS_AT(aovs) + (((aovs)&AOV_BY_EMITTER) != 0u ? BY_EMITTER_COUNT : 0u))
#define AOV_HAS_CLASSES(aovs) (((aovs)&AOVS_BY) != 0u ? 1u : 0u)

// The brightest contribution. A slot has a uvec4 word: r, g, b, and BRIGHTEST_ORIGIN. The film
// has one word more, whose x is the number of the sample. All components are 0 without light.
#define BRIGHTEST_ORIGIN(bounce, site, emitter)                                                    \
    ((bounce) | (site) << BRIGHTEST_SITE_SHIFT | (emitter) << BRIGHTEST_EMITTER_SHIFT)
#define BRIGHTEST_BOUNCE_MASK 0xffffffu // number of scattering events
#define BRIGHTEST_SITE_SHIFT 24         // SITE_*
#define BRIGHTEST_EMITTER_SHIFT 28      // BY_EMITTER_*
#define BRIGHTEST_FIELD_MASK 15u        // mask of the site and of the emitter

// Offsets in uvec4 words. A record begins with the radiance in a slot, with gpu_film_pixel in the
// film, and with gpu_resolved_pixel in results that are read back. The sums of the AOVs follow, in
// the film with their digits; then the classes, the brightest contribution and the ids. In the film
// a class has the members of gpu_film_pixel without sample counts. In results, the means of all
// classes in half a precede those in half b.
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
