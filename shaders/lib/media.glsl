// Which medium a path is in, where closed surfaces nest and overlap. Reads the media's section of
// the materials' buffer.
//
// A path carries a stack of the media whose surfaces it has entered and not left: up to four
// numbers of 8 bits in a word, the latest lowest, 0 for none. Numbers are given in ascending order
// of priority (render/tables/shading_tables.c), so that the medium that is there is the highest
// number (after Schmidt and Budge 2002, "Simple Nested Dielectrics in Ray Traced Images"); with none it is
// air.
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

// Removes the latest entry of this number; *found: there was one.
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

// The part of light that passes through this length of a medium (Beer and Lambert). An extinction
// so large that the product is infinite transmits nothing, but all at distance 0.
vec3 transmittance(medium m, float distance)
{
    return exp(-m.extinction * distance);
}

// The media that a surface separates for a ray that hits it, and the ray's stack on the other side.
struct media_interface {
    uint here, beyond;  // media
    uint stack_beyond;
    bool lost; // the stack was full, or had no such medium to leave
};

// `number`: the medium inside of the surface, not 0; `front`: the ray came from outside.
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
        // Inside of something that was never entered: of an open mesh.
        i.here = max(i.here, number);
        i.beyond = media_current(i.stack_beyond);
    }
    return i;
}

#endif
