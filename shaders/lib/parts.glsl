// Reads the parts of long buffers beyond the range of a storage buffer. Declares their bindings.
#ifndef PARTS_GLSL
#define PARTS_GLSL

#include "lib/constants.glsl"

// The total number of further parts of the buffers with lower numbers: the sum of the nibbles of
// `bits`.
#define PARTS_BELOW(bits)                                                                          \
    (PARTS_OF(bits, 0u) + PARTS_OF(bits, 1u) + PARTS_OF(bits, 2u) + PARTS_OF(bits, 3u) +           \
     PARTS_OF(bits, 4u) + PARTS_OF(bits, 5u) + PARTS_OF(bits, 6u) + PARTS_OF(bits, 7u))
#define PARTS_BEFORE(binding) PARTS_BELOW(PARTS & ((1u << (PARTS_BITS * (binding))) - 1u))

#define PART(number)                                                                               \
    layout(std430, set = 0, binding = BINDING_PARTS + number) readonly buffer part_##number {      \
        uvec4 part_##number##_words[];                                                             \
    };

PART(0)
PART(1)
PART(2)
PART(3)
PART(4)
PART(5)
PART(6)
PART(7)
PART(8)
PART(9)
PART(10)
PART(11)
PART(12)
PART(13)
PART(14)
PART(15)

// Loads from part `part` if the buffer has that many parts.
#define LOAD_PART(number)                                                                          \
    if (PARTS_BELOW(PARTS) > uint(number)) {                                                       \
        if (part == uint(number))                                                                  \
            return part_##number##_words[index];                                                   \
    }

uvec4 load_part(uint part, uint index)
{
    LOAD_PART(0)
    LOAD_PART(1)
    LOAD_PART(2)
    LOAD_PART(3)
    LOAD_PART(4)
    LOAD_PART(5)
    LOAD_PART(6)
    LOAD_PART(7)
    LOAD_PART(8)
    LOAD_PART(9)
    LOAD_PART(10)
    LOAD_PART(11)
    LOAD_PART(12)
    LOAD_PART(13)
    LOAD_PART(14)
    LOAD_PART(15)
    return uvec4(0u);
}

#endif
