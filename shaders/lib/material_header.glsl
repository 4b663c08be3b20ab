// Reads the header of the materials' buffer (struct gpu_material_header): the word of four at which
// each section begins, and what all paths begin with.
#ifndef MATERIAL_HEADER_GLSL
#define MATERIAL_HEADER_GLSL

#include "lib/buffers.glsl"

// Returns the beginning of the material in a primitive's word.
uint material_at(uint word)
{
    return MATERIAL_HEADER_WORDS + (word & MATERIAL_INDEX_MASK) * MATERIAL_WORDS;
}

uint textures_begin()
{
    return load_materials(0u).x;
}

uint lights_begin()
{
    return load_materials(0u).y;
}

uint media_begin()
{
    return load_materials(0u).z;
}

uint albedos_begin()
{
    return load_materials(0u).w;
}

// The stack of media that camera rays start in, and the index of refraction there.
uint camera_media()
{
    return load_materials(1u).x;
}

float camera_ior()
{
    return uintBitsToFloat(load_materials(1u).y);
}

// Returns the beginning of the suns, and their number.
uvec2 suns_range()
{
    return load_materials(1u).zw;
}

#endif
