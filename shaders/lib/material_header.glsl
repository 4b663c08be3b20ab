// Reads the header of the materials' buffer (struct gpu_material_header): the words at which
// sections begin, and the initial medium of camera paths.
#ifndef MATERIAL_HEADER_GLSL
#define MATERIAL_HEADER_GLSL

#include "lib/buffers.glsl"

// Returns the beginning of the material that a primitive's material word refers to.
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

// Returns the stack of media in which camera rays start. camera_ior() is the index of refraction
// there.
uint camera_media()
{
    return load_materials(1u).x;
}

float camera_ior()
{
    return uintBitsToFloat(load_materials(1u).y);
}

// Returns the beginning and the number of the suns.
uvec2 suns_range()
{
    return load_materials(1u).zw;
}

#endif
