// Tests how many entries of a traversal stack are in the memory that a workgroup shares.
#include "gpu/gpu.h"
#include "render/specialize.h"
#include "test.h"

// GPUs keep 12 entries of a stack in shared memory, or as many as fit. CPU drivers keep none,
// unless it is requested.
TEST(stacks_fit_into_shared_memory)
{
    static const struct {
        bool is_cpu, forced;
        uint64_t bytes;
        uint32_t workgroup, entries, expected;
    } cases[] = {
        {true, false, 32768, 128, 41, 0},  {true, true, 16384, 128, 41, 12},
        {false, false, 32768, 64, 41, 12}, {false, false, 32768, 64, 3, 5},
        {false, false, 16384, 512, 41, 7}, {false, false, 16384, 1024, 41, 3},
        {false, false, 1024, 64, 41, 3},   {false, false, 200, 64, 41, 0},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const struct gpu gpu = {
            .info.is_cpu = cases[i].is_cpu,
            .params.limits.shared_stack = cases[i].forced,
            .max_shared_bytes = cases[i].bytes,
        };
        struct specialization s = {.stack_entries = cases[i].entries};
        specialization_set_workgroup(&s, &gpu, cases[i].workgroup);
        CHECK(s.workgroup == cases[i].workgroup && s.stack_shared == cases[i].expected,
              "case %zu: %u entries, expected %u", i, s.stack_shared, cases[i].expected);
    }
}

TEST_MAIN(TEST_CASE(stacks_fit_into_shared_memory))
