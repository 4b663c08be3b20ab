#include "gpu/spirv_bindings.h"

#include "gpu/spirv.h"

uint64_t spirv_bindings(const uint32_t *code, size_t bytes)
{
    uint64_t bindings = 0;
    if (!spirv_is_module(code, bytes))
        return 0;
    for (size_t i = SPIRV_HEADER_WORDS; i < bytes / sizeof *code; i += spirv_length(code + i)) {
        const uint32_t *at = code + i;
        if (spirv_opcode(at) == OP_DECORATE && spirv_length(at) == 4 &&
            at[2] == SPIRV_DECORATION_BINDING && at[3] < 64)
            bindings |= UINT64_C(1) << at[3];
    }
    return bindings;
}
