// Implements the stack of a traversal, which holds postponed nodes. On CPU drivers the stack is a
// private array. Some GPU compilers would keep such an array in registers, and compare an index
// with each entry. On such devices the first STACK_SHARED entries of each thread are in shared
// memory. The others, which few rays need, are in an array too long for registers.
#ifndef STACK_GLSL
#define STACK_GLSL

#include "lib/constants.glsl"

#define IS_STACK_SHARED (STACK_SHARED > 0u)
// One more entry holds the sentinel, and another one may be overwritten by a branch-free push.
const uint STACK_LENGTH = STACK_ENTRIES + 2u;
const bool STACK_FITS_SHARED = STACK_LENGTH <= STACK_SHARED;
// The unit is 32-bit words. Mesa's compiler for AMD GPUs (22.3) keeps arrays of up to 256 bytes in
// registers.
#define LONGEST_IN_REGISTERS 64u
const uint STACK_BEYOND = STACK_LENGTH - STACK_SHARED;
const uint STACK_LONG = STACK_BEYOND > LONGEST_IN_REGISTERS ? STACK_BEYOND : LONGEST_IN_REGISTERS + 1u;
const uint STACK_PRIVATE =
    STACK_FITS_SHARED ? 1u : (IS_STACK_SHARED ? STACK_LONG : STACK_LENGTH);

layout(constant_id = CONSTANT_WORKGROUP) const uint STACK_THREADS = 1u;
const uint STACK_SHARED_WORDS = IS_STACK_SHARED ? STACK_SHARED * STACK_THREADS : 1u;

uint stack_private[STACK_PRIVATE];
shared uint stack_shared[STACK_SHARED_WORDS]; // entry 0 of all threads, then entry 1 of all
                                              // threads, and so on

uint stack_word(uint entry)
{
    return entry * STACK_THREADS + gl_LocalInvocationIndex;
}

uint stack_load(uint entry)
{
    uint node;
    if (STACK_FITS_SHARED || (IS_STACK_SHARED && entry < STACK_SHARED))
        node = stack_shared[stack_word(entry)];
    else
        node = stack_private[entry - STACK_SHARED];
    return node;
}

void stack_store(uint entry, uint node)
{
    if (STACK_FITS_SHARED || (IS_STACK_SHARED && entry < STACK_SHARED))
        stack_shared[stack_word(entry)] = node;
    else
        stack_private[entry - STACK_SHARED] = node;
}

#endif
