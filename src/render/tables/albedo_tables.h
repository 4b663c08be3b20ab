// Declares the tables of directional albedos of microfacets, fibres, coats and diffuse surfaces,
// for lib/albedo.glsl.
#ifndef LAMPYRIS_RENDER_TABLES_ALBEDO_TABLES_H
#define LAMPYRIS_RENDER_TABLES_ALBEDO_TABLES_H

#include "shared/albedo.h"
#include <stdint.h>

// The tables that albedo_generate has printed at build time.
extern const uint32_t albedo_tables[ALBEDO_WORDS][4];

#endif
