// Encodes unit vectors in 32 bits.
#ifndef LAMPYRIS_RENDER_TABLES_OCTAHEDRAL_H
#define LAMPYRIS_RENDER_TABLES_OCTAHEDRAL_H

#include <stdint.h>

// Returns the octahedral code of a unit vector, which shaders decode (lib/surface.glsl); never
// NORMAL_FLAT.
uint32_t encode_normal(const float n[3]);

#endif
