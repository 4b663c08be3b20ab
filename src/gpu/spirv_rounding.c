#include "gpu/spirv_rounding.h"

#include "gpu/spirv.h"
#include <string.h>

// Values from the extension SPV_KHR_float_controls.
enum {
    CAPABILITY_ROUNDING_MODE_RTE = 4467,
    EXECUTION_MODE_ROUNDING_MODE_RTE = 4462,
};

static const char extension[] = "SPV_KHR_float_controls";

#define EXTENSION_WORDS (1 + (uint32_t)(sizeof extension + 3) / 4)

_Static_assert(SPIRV_ROUNDING_BYTES == 4 * (2 + EXTENSION_WORDS + 4), "what is added");

static uint32_t add_words(const uint32_t *words, uint32_t count, uint32_t *out)
{
    memcpy(out, words, count * sizeof *words);
    return count;
}

// In a module capabilities come first and extensions second (SPIR-V, section 2.4).
static uint32_t add_capability(uint32_t *out)
{
    const uint32_t words[] = {spirv_head(OP_CAPABILITY, 2), CAPABILITY_ROUNDING_MODE_RTE};
    return add_words(words, 2, out);
}

static uint32_t add_extension(uint32_t *out)
{
    uint32_t words[EXTENSION_WORDS] = {spirv_head(OP_EXTENSION, EXTENSION_WORDS)};
    memcpy(words + 1, extension, sizeof extension);
    return add_words(words, EXTENSION_WORDS, out);
}

static uint32_t add_mode(uint32_t entry_point, uint32_t *out)
{
    const uint32_t words[] = {spirv_head(OP_EXECUTION_MODE, 4), entry_point,
                              EXECUTION_MODE_ROUNDING_MODE_RTE, 32};
    return add_words(words, 4, out);
}

size_t spirv_round_to_nearest(const uint32_t *code, size_t bytes, uint32_t *out)
{
    if (!spirv_is_module(code, bytes))
        return 0;
    uint32_t words = (uint32_t)(bytes / sizeof *code), entry_point = 0;
    uint32_t written = add_words(code, SPIRV_HEADER_WORDS, out);
    bool extended = false;
    written += add_capability(out + written);
    for (uint32_t i = SPIRV_HEADER_WORDS; i < words; i += spirv_length(code + i)) {
        uint32_t op = spirv_opcode(code + i);
        if (!extended && op != OP_CAPABILITY) {
            written += add_extension(out + written);
            extended = true;
        }
        if (entry_point == 0 && op == OP_EXECUTION_MODE && spirv_length(code + i) > 2) {
            entry_point = code[i + 1];
            written += add_mode(entry_point, out + written);
        }
        written += add_words(code + i, spirv_length(code + i), out + written);
    }
    return entry_point ? written * sizeof *out : 0;
}
