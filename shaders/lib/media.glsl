// Determines the medium in which a path is, where closed surfaces are nested or overlap. Reads the
// media's section of the materials' buffer.
//
// A path carries a stack of the media whose surfaces it has entered and not left: up to four
// numbers of 8 bits in a word, the latest in the lowest bits; 0 is none. Media are numbered in
// ascending order of priority (render/tables/shading_tables.c), so the medium at a point is the one
// with the highest number in the stack (after Schmidt and Budge 2002, "Simple Nested Dielectrics in
// Ray Traced Images"). An empty stack means air.
#ifndef MEDIA_GLSL
#define MEDIA_GLSL

#include "lib/material.glsl"

struct medium {
    vec3 extinction; // 1/length
    float ior;
    float dispersion;
};

uint media_current(uint stack)
{
    uint low = max(stack & 255u, stack >> 8u & 255u);
    return max(low, max(stack >> 16u & 255u, stack >> 24u));
}

bool media_is_full(uint stack)
{
    return stack >> 24u != 0u;
}

uint media_enter(uint stack, uint number)
{
    return stack << 8u | number;
}

// Removes the latest entry with this number. found: is set to whether there was such an entry.
uint media_leave(uint stack, uint number, out bool found)
{
    found = false;
    uint left = stack;
    for (uint i = 0u; i < 4u; i++) {
        uint shift = 8u * i;
        bool here = !found && (stack >> shift & 255u) == number;
        uint below = stack & ((1u << shift) - 1u);
        uint above = i < 3u ? stack >> (shift + 8u) << shift : 0u;
        left = here ? above | below : left;
        found = found || here;
    }
    return left;
}

medium load_medium(uint number)
{
    medium air = medium(vec3(0.0), 1.0, 0.0);
    if (number == 0u)
        return air;
    uint at = media_begin() + (number - 1u) * MEDIUM_WORDS;
    vec4 words = load_materials_float(at);
    return medium(words.rgb, words.a, load_materials_float(at + 1u).y);
}

// Returns the fraction of light that passes through this length of a medium (Beer and Lambert). If
// the product of extinction and length is infinite, nothing is transmitted, except at distance 0.
vec3 transmittance(medium m, float distance)
{
    return exp(-m.extinction * distance);
}

// The media on both sides of a surface that a ray has hit, and the ray's stack on the far side.
struct media_interface {
    uint here, beyond;  // medium numbers: on the ray's side, and on the far side
    uint stack_beyond;
    bool lost; // the stack was full, or did not have the medium that was left
};

// number: the medium inside the surface, not 0; front: the ray arrives from outside.
media_interface media_cross(uint stack, uint number, bool front)
{
    media_interface i;
    i.lost = front && media_is_full(stack);
    i.here = media_current(stack);
    if (front) {
        i.stack_beyond = i.lost ? stack : media_enter(stack, number);
        i.beyond = max(i.here, number);
    } else {
        bool found;
        i.stack_beyond = media_leave(stack, number, found);
        i.lost = !found;
        // The ray is inside a surface that it has not entered: the mesh is open.
        i.here = max(i.here, number);
        i.beyond = media_current(i.stack_beyond);
    }
    return i;
}

#endif
