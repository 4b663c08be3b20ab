// Defines the sizes and offsets of the tables of directional albedos, for C and GLSL.
// render/tables/albedo_generate.c fills them at build time; lib/albedo.glsl describes their axes.
#ifndef LAMPYRIS_SHARED_ALBEDO_H
#define LAMPYRIS_SHARED_ALBEDO_H

// These are numbers of cells, not of nodes: a cell holds the values at its corners, so that one
// read suffices.
#define ALBEDO_GGX_MU 32u
#define ALBEDO_GGX_ALPHA 32u
#define ALBEDO_SCHLICK_MU 32u
#define ALBEDO_SCHLICK_ALPHA 32u
#define ALBEDO_CHARLIE_MU 32u
#define ALBEDO_CHARLIE_ROUGHNESS 24u
#define ALBEDO_COAT_MU 32u
#define ALBEDO_COAT_GLOSS 8u
#define ALBEDO_DIFFUSE_MU 128u
#define ALBEDO_FRESNEL_MU 24u
#define ALBEDO_FRESNEL_ALPHA 24u
#define ALBEDO_FRESNEL_ETA 24u
// Interfaces that also refract, seen from the side with the lower index and from the other side.
// These tables are finer. A uvec4 word holds the eight nodes around ALBEDO_RUN cells along mu, at
// one node of each other axis; sizes along mu are multiples of ALBEDO_RUN.
#define ALBEDO_RUN 7u
#define ALBEDO_GLASS_MU 28u
#define ALBEDO_GLASS_ALPHA 40u
#define ALBEDO_GLASS_ETA 40u
#define ALBEDO_GLASS_INSIDE_MU 56u
#define ALBEDO_GLASS_INSIDE_ALPHA 40u
#define ALBEDO_GLASS_INSIDE_ETA 48u
#define ALBEDO_CLEAR_MU 28u
#define ALBEDO_CLEAR_ALPHA 20u
#define ALBEDO_CLEAR_ETA 24u
// The tables for anisotropy come last, because they are uploaded only if some material is
// anisotropic. Those of interfaces that also refract have runs, too: one table for each side, node
// of eta and node of the azimuth.
#define ALBEDO_TURNED_MU 24u
#define ALBEDO_TURNED_ROUGHNESS 12u
#define ALBEDO_TURNED_ASPECT 8u
#define ALBEDO_TURNED_AZIMUTH 8u
#define ALBEDO_SINE_MU 12u
#define ALBEDO_SINE_ROUGHNESS 10u
#define ALBEDO_SINE_ASPECT 4u
#define ALBEDO_SINE_AZIMUTH 4u
#define ALBEDO_TURNED_GLASS_MU 14u
#define ALBEDO_TURNED_GLASS_ROUGHNESS 6u
#define ALBEDO_TURNED_GLASS_ASPECT 5u
#define ALBEDO_TURNED_GLASS_AZIMUTH 6u
#define ALBEDO_TURNED_GLASS_ETA 6u

// The value that 65535 stands for in tables of 16 bits. It is above 1, because nodes may be raised.
#define ALBEDO_HIGHEST 1.015625
// The table at ALBEDO_TURNED_GLASS has logarithms of the quotient of the anisotropic and the
// isotropic albedo of glass: 0 stands for minus ALBEDO_TURNED_GLASS_LOG, 65535 for plus this value.
// The next two constants are the first value of its axis of roughness and the last value of its
// axis of eta.
#define ALBEDO_TURNED_GLASS_LOG 4.0
#define ALBEDO_TURNED_GLASS_ROUGHNESS_LEAST 0.1
#define ALBEDO_TURNED_GLASS_ETA_LAST 0.95

// Offsets in uvec4 words, from the beginning of the tables.
#define ALBEDO_GGX 0u
#define ALBEDO_SCHLICK (ALBEDO_GGX + ALBEDO_GGX_MU * ALBEDO_GGX_ALPHA)
#define ALBEDO_CHARLIE (ALBEDO_SCHLICK + ALBEDO_SCHLICK_MU * ALBEDO_SCHLICK_ALPHA)
#define ALBEDO_COAT (ALBEDO_CHARLIE + ALBEDO_CHARLIE_MU * ALBEDO_CHARLIE_ROUGHNESS)
#define ALBEDO_DIFFUSE (ALBEDO_COAT + ALBEDO_COAT_MU * ALBEDO_COAT_GLOSS) // nodes, not cells
#define ALBEDO_COAT_EXACT (ALBEDO_DIFFUSE + ALBEDO_DIFFUSE_MU + 1u)       // layout of ALBEDO_COAT
#define ALBEDO_FRESNEL (ALBEDO_COAT_EXACT + ALBEDO_COAT_MU * ALBEDO_COAT_GLOSS)
#define ALBEDO_FRESNEL_SIDE (ALBEDO_FRESNEL_MU * ALBEDO_FRESNEL_ALPHA * ALBEDO_FRESNEL_ETA)
#define ALBEDO_WORDS_ISOTROPIC (ALBEDO_FRESNEL + 2u * ALBEDO_FRESNEL_SIDE) // outside, then inside
#define ALBEDO_GLASS ALBEDO_WORDS_ISOTROPIC
#define ALBEDO_RUNS(mu, alpha, eta) ((mu) / ALBEDO_RUN * ((alpha) + 1u) * ((eta) + 1u))
#define ALBEDO_GLASS_INSIDE                                                                        \
    (ALBEDO_GLASS + ALBEDO_RUNS(ALBEDO_GLASS_MU, ALBEDO_GLASS_ALPHA, ALBEDO_GLASS_ETA))
#define ALBEDO_CLEAR                                                                               \
    (ALBEDO_GLASS_INSIDE +                                                                         \
     ALBEDO_RUNS(ALBEDO_GLASS_INSIDE_MU, ALBEDO_GLASS_INSIDE_ALPHA, ALBEDO_GLASS_INSIDE_ETA))
#define ALBEDO_CLEAR_SIDE ALBEDO_RUNS(ALBEDO_CLEAR_MU, ALBEDO_CLEAR_ALPHA, ALBEDO_CLEAR_ETA)
#define ALBEDO_WORDS_GLASS (ALBEDO_CLEAR + 2u * ALBEDO_CLEAR_SIDE) // outside, then inside
#define ALBEDO_TURNED ALBEDO_WORDS_GLASS
#define ALBEDO_TURNED_SLICE (ALBEDO_TURNED_MU * ALBEDO_TURNED_ROUGHNESS * ALBEDO_TURNED_ASPECT)
#define ALBEDO_SINE (ALBEDO_TURNED + ALBEDO_TURNED_SLICE * (ALBEDO_TURNED_AZIMUTH + 1u))
#define ALBEDO_SINE_SLICE (ALBEDO_SINE_MU * ALBEDO_SINE_ROUGHNESS * ALBEDO_SINE_ASPECT)
#define ALBEDO_WORDS_TURNED (ALBEDO_SINE + ALBEDO_SINE_SLICE * (ALBEDO_SINE_AZIMUTH + 1u))
#define ALBEDO_TURNED_GLASS ALBEDO_WORDS_TURNED
#define ALBEDO_TURNED_GLASS_SLICE                                                                  \
    ALBEDO_RUNS(ALBEDO_TURNED_GLASS_MU, ALBEDO_TURNED_GLASS_ROUGHNESS, ALBEDO_TURNED_GLASS_ASPECT)
#define ALBEDO_TURNED_GLASS_SIDE                                                                   \
    (ALBEDO_TURNED_GLASS_SLICE * (ALBEDO_TURNED_GLASS_AZIMUTH + 1u) *                              \
     (ALBEDO_TURNED_GLASS_ETA + 1u))
#define ALBEDO_WORDS (ALBEDO_TURNED_GLASS + 2u * ALBEDO_TURNED_GLASS_SIDE) // outside, then inside

#endif
