// Defines constants and functions for reading and rewriting SPIR-V modules as words.
#ifndef LAMPYRIS_GPU_SPIRV_H
#define LAMPYRIS_GPU_SPIRV_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// Values from SPIR-V 1.3, revision 7: the header (section 2.3), a decoration (3.20) and opcodes
// (3.37).
enum {
    SPIRV_MAGIC = 0x07230203,
    SPIRV_BOUND = 3, // index of the header word that has the bound of ids
    SPIRV_HEADER_WORDS = 5,
    SPIRV_DECORATION_SPEC_ID = 1,
    SPIRV_DECORATION_BINDING = 33,

    OP_NOP = 0,
    OP_UNDEF = 1,
    OP_NAME = 5,
    OP_EXTENSION = 10,
    OP_MEMBER_NAME = 6,
    OP_LINE = 8,
    OP_ENTRY_POINT = 15,
    OP_EXECUTION_MODE = 16,
    OP_CAPABILITY = 17,
    OP_TYPE_BOOL = 20,
    OP_TYPE_INT = 21,
    OP_CONSTANT_TRUE = 41,
    OP_CONSTANT_FALSE = 42,
    OP_CONSTANT = 43,
    OP_CONSTANT_COMPOSITE = 44,
    OP_SPEC_CONSTANT_TRUE = 48,
    OP_SPEC_CONSTANT_FALSE = 49,
    OP_SPEC_CONSTANT = 50,
    OP_SPEC_CONSTANT_OP = 52,
    OP_FUNCTION = 54,
    OP_FUNCTION_PARAMETER = 55,
    OP_FUNCTION_END = 56,
    OP_FUNCTION_CALL = 57,
    OP_VARIABLE = 59,
    OP_LOAD = 61,
    OP_STORE = 62,
    OP_COPY_MEMORY = 63,
    OP_COPY_MEMORY_SIZED = 64,
    OP_ARRAY_LENGTH = 68,
    OP_DECORATE = 71,
    OP_COPY_OBJECT = 83,
    OP_IMAGE_WRITE = 99,
    OP_I_ADD = 128,
    OP_I_SUB = 130,
    OP_I_MUL = 132,
    OP_F_MUL = 133,
    OP_LOGICAL_EQUAL = 164,
    OP_LOGICAL_NOT_EQUAL = 165,
    OP_LOGICAL_OR = 166,
    OP_LOGICAL_AND = 167,
    OP_LOGICAL_NOT = 168,
    OP_SELECT = 169,
    OP_I_EQUAL = 170,
    OP_I_NOT_EQUAL = 171,
    OP_U_GREATER_THAN = 172,
    OP_S_GREATER_THAN = 173,
    OP_U_GREATER_THAN_EQUAL = 174,
    OP_S_GREATER_THAN_EQUAL = 175,
    OP_U_LESS_THAN = 176,
    OP_S_LESS_THAN = 177,
    OP_U_LESS_THAN_EQUAL = 178,
    OP_S_LESS_THAN_EQUAL = 179,
    OP_SHIFT_RIGHT_LOGICAL = 194,
    OP_SHIFT_LEFT_LOGICAL = 196,
    OP_BITWISE_OR = 197,
    OP_BITWISE_XOR = 198,
    OP_BITWISE_AND = 199,
    OP_NOT = 200,
    OP_CONTROL_BARRIER = 224,
    OP_MEMORY_BARRIER = 225,
    OP_ATOMIC_LOAD = 227,
    OP_ATOMIC_STORE = 228,
    OP_ATOMIC_XOR = 242,
    OP_PHI = 245,
    OP_LOOP_MERGE = 246,
    OP_SELECTION_MERGE = 247,
    OP_LABEL = 248,
    OP_BRANCH = 249,
    OP_BRANCH_CONDITIONAL = 250,
    OP_SWITCH = 251,
    OP_RETURN_VALUE = 254,
    OP_UNREACHABLE = 255,
    OP_NO_LINE = 317,
};

static inline uint32_t spirv_opcode(const uint32_t *at)
{
    return *at & 0xffffu;
}

static inline uint32_t spirv_length(const uint32_t *at)
{
    return *at >> 16;
}

static inline uint32_t spirv_head(uint32_t opcode, uint32_t length)
{
    return length << 16 | opcode;
}

// Returns whether the code has a SPIR-V header and consists of complete instructions.
static inline bool spirv_is_module(const uint32_t *code, size_t bytes)
{
    size_t words = bytes / sizeof *code, i = SPIRV_HEADER_WORDS;
    if (bytes % sizeof *code || words < SPIRV_HEADER_WORDS || code[0] != SPIRV_MAGIC)
        return false;
    while (i < words && spirv_length(code + i) > 0 && spirv_length(code + i) <= words - i)
        i += spirv_length(code + i);
    return i == words;
}

#endif
