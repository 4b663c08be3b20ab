// Tests that code which specialization constants exclude is removed, and that the remaining code
// has the same results.
#include "gpu/spirv.h"
#include "gpu/spirv_bindings.h"
#include "gpu/spirv_rounding.h"
#include "gpu/spirv_trim.h"
#include "gpu_fixture.h"
#include <string.h>

#include "choices_test.spv.h"

#define COUNT 512u
#define CHOICES 64u

static uint32_t sum_of_digits(uint32_t x)
{
    uint32_t sum = 0;
    for (; x > 0; x /= 10)
        sum += x % 10;
    return sum;
}

static uint32_t by_case(uint32_t x, uint32_t choices)
{
    switch (x % 4) {
    case 0:
        return choices & 32 ? x + 1 : x + 2;
    case 3:
        return sum_of_digits(x) + 4;
    default:
        return choices & 32 ? x + 4 : x + 3;
    }
}

static uint32_t expected(uint32_t x, uint32_t choices)
{
    if (choices & 1)
        x = sum_of_digits(x);
    if ((choices & 2) && x % 2 == 1)
        x += 100;
    if (x % 3 == 0 || (choices & 4))
        x ^= 0x55;
    while ((choices & 8) && x > 1000)
        x = x / 2 + sum_of_digits(x) % 7;
    if (!(choices & 16) || (choices & 3) == 3)
        x = by_case(x, choices);
    else if (choices > 60)
        x += 5;
    return x;
}

static size_t trimmed_bytes(uint32_t choices)
{
    static uint32_t out[sizeof choices_spirv / sizeof *choices_spirv];
    const uint32_t constants[] = {GROUP, choices};
    return spirv_trim(choices_spirv, sizeof choices_spirv, constants, 2, out);
}

static bool run_choices(struct gpu *gpu, struct gpu_commands *commands,
                        struct gpu_bindings *bindings, uint32_t choices, struct err *err)
{
    const uint32_t constants[] = {GROUP, choices};
    const struct gpu_kernel_params params = {
        .name = "choices",
        .spirv = choices_spirv,
        .spirv_bytes = sizeof choices_spirv,
        .constants = constants,
        .constant_count = 2,
    };
    const struct copy_push push = {.count = COUNT, .addend = 9};
    struct gpu_kernel kernel;
    bool ok = gpu_kernel_create(gpu, &params, &kernel, err) && gpu_begin(gpu, commands, err);
    if (ok) {
        gpu_bind(gpu, commands, bindings);
        gpu_push(gpu, commands, &push, sizeof push);
        gpu_dispatch(gpu, commands, &kernel, groups_for(COUNT));
        ok = gpu_submit(gpu, commands, err) && gpu_wait(gpu, commands, err);
    }
    gpu_kernel_finish(gpu, &kernel);
    return ok;
}

// The validation layers check every module.
TEST(the_rest_does_the_same)
{
    struct gpu gpu;
    OPEN_GPU(&gpu, .validation = true);
    struct gpu_buffer from = {0}, to = {0};
    struct gpu_bindings bindings = {0};
    struct gpu_commands commands = {0};
    struct err err = {0};
    uint32_t *source = elements_new(COUNT), result[COUNT];
    bool ok = source &&
              gpu_buffer_create(&gpu, "from", COUNT * 4, GPU_DEVICE, false, &from, &err) &&
              gpu_buffer_create(&gpu, "to", COUNT * 4, GPU_DEVICE, false, &to, &err) &&
              gpu_upload(&gpu, &from, 0, source, COUNT * 4, &err) &&
              pair_bindings_create(&gpu, &from, &to, &bindings, &err) &&
              gpu_commands_create(&gpu, &commands, &err);
    for (uint32_t choices = 0; ok && choices < CHOICES; choices++) {
        ok = run_choices(&gpu, &commands, &bindings, choices, &err) &&
             gpu_download(&gpu, &to, 0, result, sizeof result, &err);
        uint32_t wrong = 0;
        for (uint32_t i = 0; ok && i < COUNT; i++)
            wrong += result[i] != expected(source[i], choices) + 9;
        CHECK(wrong == 0, "choices %u: %u of %u elements", choices, wrong, COUNT);
    }
    CHECK(ok, "%s", err.msg);
    free(source);
    gpu_commands_finish(&gpu, &commands);
    gpu_bindings_finish(&gpu, &bindings);
    gpu_buffer_finish(&gpu, &to);
    gpu_buffer_finish(&gpu, &from);
    gpu_close(&gpu);
    CHECK(gpu.validation_messages == 0, "%u", gpu.validation_messages);
}

TEST(less_is_left_of_fewer_choices)
{
    // The constant 16 selects a branch that uses no part.
    size_t none = trimmed_bytes(16), all = trimmed_bytes(1 | 2 | 8 | 32);
    CHECK(none > 0 && none < all && all < sizeof choices_spirv, "%zu, %zu of %zu bytes", none, all,
          sizeof choices_spirv);
    for (uint32_t bit = 1; bit <= 8; bit *= 2)
        CHECK(bit == 4 || trimmed_bytes(16 | bit) > none, "choice %u adds nothing", bit);
}

static uint32_t count_instructions(const uint32_t *code, size_t bytes, uint32_t first,
                                   uint32_t last)
{
    uint32_t count = 0;
    for (size_t i = SPIRV_HEADER_WORDS; i < bytes / 4; i += spirv_length(code + i))
        count += spirv_opcode(code + i) >= first && spirv_opcode(code + i) <= last;
    return count;
}

static uint32_t count_spec_ids(const uint32_t *code, size_t bytes)
{
    uint32_t count = 0;
    for (size_t i = SPIRV_HEADER_WORDS; i < bytes / 4; i += spirv_length(code + i))
        count += spirv_opcode(code + i) == OP_DECORATE && code[i + 2] == SPIRV_DECORATION_SPEC_ID;
    return count;
}

// This includes the lengths of arrays, for which some drivers take the default of a constant.
TEST(constants_have_their_values)
{
    static uint32_t out[sizeof choices_spirv / sizeof *choices_spirv];
    const uint32_t constants[] = {GROUP, 5};
    size_t bytes = spirv_trim(choices_spirv, sizeof choices_spirv, constants, 2, out);
    CHECK(count_instructions(choices_spirv, sizeof choices_spirv, OP_SPEC_CONSTANT_TRUE,
                             OP_SPEC_CONSTANT) == 2);
    CHECK(count_spec_ids(choices_spirv, sizeof choices_spirv) == 2);
    CHECK(bytes > 0 && count_spec_ids(out, bytes) == 0);
    CHECK(count_instructions(out, bytes, OP_SPEC_CONSTANT_TRUE, OP_SPEC_CONSTANT) == 0 &&
          count_instructions(out, bytes, OP_SPEC_CONSTANT_OP, OP_SPEC_CONSTANT_OP) == 0);
}

// Drivers that support the mode also accept the module: see the_rest_does_the_same.
TEST(rounding_is_asked_for)
{
    static uint32_t out[(sizeof choices_spirv + SPIRV_ROUNDING_BYTES) / 4];
    size_t bytes = spirv_round_to_nearest(choices_spirv, sizeof choices_spirv, out);
    CHECK(bytes == sizeof choices_spirv + SPIRV_ROUNDING_BYTES, "%zu", bytes);
    CHECK(spirv_is_module(out, bytes) && spirv_opcode(out + SPIRV_HEADER_WORDS) == OP_CAPABILITY &&
          out[SPIRV_HEADER_WORDS + 1] == 4467);
    uint32_t modes = 0, extensions = 0;
    for (size_t i = SPIRV_HEADER_WORDS; i < bytes / 4; i += spirv_length(out + i)) {
        extensions += spirv_opcode(out + i) == OP_EXTENSION &&
                      strcmp((const char *)(out + i + 1), "SPV_KHR_float_controls") == 0;
        modes +=
            spirv_opcode(out + i) == OP_EXECUTION_MODE && out[i + 2] == 4462 && out[i + 3] == 32;
    }
    CHECK(modes == 1 && extensions == 1, "%u modes, %u extensions", modes, extensions);
    CHECK(spirv_round_to_nearest(choices_spirv, 16, out) == 0);
}

TEST(what_is_no_module_is_left_alone)
{
    static uint32_t broken[sizeof choices_spirv / 4], out[sizeof choices_spirv / 4];
    CHECK(spirv_trim(choices_spirv, 16, NULL, 0, out) == 0);
    memcpy(broken, choices_spirv, sizeof broken);
    broken[0] ^= 1;
    CHECK(spirv_trim(broken, sizeof broken, NULL, 0, out) == 0);
    memcpy(broken, choices_spirv, sizeof broken);
    broken[5] &= 0xffff; // an instruction with zero words
    CHECK(spirv_trim(broken, sizeof broken, NULL, 0, out) == 0);
    memcpy(broken, choices_spirv, sizeof broken);
    CHECK(spirv_trim(broken, sizeof broken - 4, NULL, 0, out) == 0, "a function without an end");
    broken[sizeof broken / 4 - 1] += 1u << 16; // the last instruction is longer than the rest of
                                               // the module
    CHECK(spirv_trim(broken, sizeof broken, NULL, 0, out) == 0);
}

TEST(instructions_of_functions_are_counted)
{
    // A header, a type (OpTypeVoid), and a function of a label, a no-op and a return.
    static const uint32_t module[] = {
        0x07230203,
        0x10500,
        0,
        5,
        0,
        2u << 16 | 19,
        1,
        5u << 16 | 54,
        1,
        2,
        0,
        3,
        2u << 16 | 248,
        4,
        1u << 16 | 0,
        1u << 16 | 253,
        1u << 16 | 56,
    };
    CHECK(spirv_instructions(module, sizeof module) == 4, "%u",
          spirv_instructions(module, sizeof module));
    CHECK(spirv_instructions(module, 16) == 0 && spirv_instructions(module + 1, 60) == 0);
    uint32_t whole = spirv_instructions(choices_spirv, sizeof choices_spirv);
    static uint32_t out[sizeof choices_spirv / sizeof *choices_spirv];
    const uint32_t constants[] = {GROUP, 16};
    size_t bytes = spirv_trim(choices_spirv, sizeof choices_spirv, constants, 2, out);
    uint32_t left = spirv_instructions(out, bytes);
    CHECK(left > 0 && left < whole, "%u of %u", left, whole);
}

// Bindings 0 and 1 are the storage buffers, 16 is the texel buffer.
TEST(variables_that_nothing_names_are_left_out)
{
    static uint32_t out[sizeof copy_spirv / sizeof *copy_spirv];
    for (uint32_t texel = 0; texel < 2; texel++) {
        const uint32_t constants[] = {GROUP, 1, texel};
        size_t bytes = spirv_trim(copy_spirv, sizeof copy_spirv, constants, 3, out);
        uint64_t bindings = spirv_bindings(out, bytes);
        CHECK(bindings == (texel ? 1u << 1 | 1u << 16 : 1u << 0 | 1u << 1), "texel %u: 0x%llx",
              texel, (unsigned long long)bindings);
    }
    CHECK(spirv_bindings(copy_spirv, sizeof copy_spirv) == (1u << 0 | 1u << 1 | 1u << 16));
    CHECK(spirv_bindings(copy_spirv + 1, sizeof copy_spirv - 4) == 0);
}

TEST_MAIN(TEST_CASE(variables_that_nothing_names_are_left_out), TEST_CASE(the_rest_does_the_same),
          TEST_CASE(less_is_left_of_fewer_choices), TEST_CASE(constants_have_their_values),
          TEST_CASE(rounding_is_asked_for), TEST_CASE(what_is_no_module_is_left_alone),
          TEST_CASE(instructions_of_functions_are_counted))
