// The tables of directional albedos: sizes and places. Read by C and by GLSL; render/albedo_generate.c
// fills them at build time, lib/albedo.glsl says what is on their axes.
#ifndef LAMPYRIS_SHARED_ALBEDO_H
#define LAMPYRIS_SHARED_ALBEDO_H

// Cells, not nodes: a cell holds the values at its corners, so that one read suffices.
#define ALBEDO_GGX_MU 32u
#define ALBEDO_GGX_ALPHA 32u
#define ALBEDO_SCHLICK_MU 32u
#define ALBEDO_SCHLICK_ALPHA 32u
#define ALBEDO_CHARLIE_MU 32u
#define ALBEDO_CHARLIE_ROUGHNESS 24u
#define ALBEDO_COAT_MU 32u
#define ALBEDO_COAT_GLOSS 8u
#define ALBEDO_DIFFUSE_MU 32u
#define ALBEDO_FRESNEL_MU 24u
#define ALBEDO_FRESNEL_ALPHA 24u
#define ALBEDO_FRESNEL_ETA 24u

// First words of four, from the beginning of the tables.
#define ALBEDO_GGX 0u
#define ALBEDO_SCHLICK (ALBEDO_GGX + ALBEDO_GGX_MU * ALBEDO_GGX_ALPHA)
#define ALBEDO_CHARLIE (ALBEDO_SCHLICK + ALBEDO_SCHLICK_MU * ALBEDO_SCHLICK_ALPHA)
#define ALBEDO_COAT (ALBEDO_CHARLIE + ALBEDO_CHARLIE_MU * ALBEDO_CHARLIE_ROUGHNESS)
#define ALBEDO_DIFFUSE (ALBEDO_COAT + ALBEDO_COAT_MU * ALBEDO_COAT_GLOSS) // nodes, not cells
#define ALBEDO_FRESNEL (ALBEDO_DIFFUSE + ALBEDO_DIFFUSE_MU + 1u)
#define ALBEDO_FRESNEL_SIDE (ALBEDO_FRESNEL_MU * ALBEDO_FRESNEL_ALPHA * ALBEDO_FRESNEL_ETA)
#define ALBEDO_WORDS (ALBEDO_FRESNEL + 2u * ALBEDO_FRESNEL_SIDE) // outside, then inside

#endif
