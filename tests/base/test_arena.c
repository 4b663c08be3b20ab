#include "base/arena.h"
#include "base/memory.h"
#include "test.h"

static bool is_zero(const uint8_t *data, size_t size)
{
    for (size_t i = 0; i < size; i++)
        if (data[i] != 0)
            return false;
    return true;
}

TEST(memory_is_zeroed_aligned_and_disjoint)
{
    static const size_t sizes[] = {1, 15, 16, 17, 63, 64, 65, 1000, 4096, 5000, 100000, 3000000};
    enum { SIZES = sizeof sizes / sizeof sizes[0], ROUNDS = 20 };
    uint8_t *pointers[ROUNDS * SIZES];
    struct arena arena = {0};
    for (int i = 0; i < ROUNDS * SIZES; i++) {
        size_t size = sizes[i % SIZES];
        pointers[i] = arena_alloc(&arena, size, 1);
        REQUIRE(pointers[i], "size %zu", size);
        CHECK((uintptr_t)pointers[i] % (size >= 64 ? 64 : 16) == 0, "size %zu", size);
        CHECK(is_zero(pointers[i], size), "size %zu", size);
        memset(pointers[i], i + 1, size);
    }
    for (int i = 0; i < ROUNDS * SIZES; i++) {
        size_t size = sizes[i % SIZES];
        bool intact = true;
        for (size_t j = 0; j < size; j++)
            intact = intact && pointers[i][j] == (uint8_t)(i + 1);
        CHECK(intact, "allocation %d of %zu bytes was overwritten", i, size);
    }
    arena_finish(&arena);
    CHECK(!arena.blocks && arena.used_bytes == 0);
}

TEST(a_count_of_zero_gives_distinct_pointers)
{
    struct arena arena = {0};
    void *a = arena_alloc(&arena, 0, 8), *b = arena_alloc(&arena, 8, 0);
    CHECK(a && b && a != b);
    arena_finish(&arena);
}

TEST(overflowing_sizes_give_null)
{
    struct arena arena = {0};
    CHECK(!arena_alloc(&arena, SIZE_MAX, 2));
    CHECK(!arena_alloc(&arena, SIZE_MAX / 2 + 1, 2));
    CHECK(!arena_alloc(&arena, SIZE_MAX, 1));
    CHECK(!arena_alloc(&arena, SIZE_MAX / 2, 1), "larger than the address space");
    CHECK(arena.used_bytes == 0, "%zu", arena.used_bytes);
    CHECK(arena_alloc(&arena, 16, 1), "an arena works on after a failure");
    arena_finish(&arena);
}

TEST(the_budget_holds_and_survives_finish)
{
    struct arena arena = {0};
    memory_set_budget(100000);
    for (int round = 0; round < 2; round++) {
        CHECK(!arena_alloc(&arena, 100001, 1));
        CHECK(arena_alloc(&arena, 60000, 1));
        CHECK(!arena_alloc(&arena, 60000, 1));
        CHECK(arena_alloc(&arena, 30000, 1), "what still fits is given");
        CHECK(arena.used_bytes <= 100000 && memory_used() == arena.used_bytes);
        arena_finish(&arena);
        CHECK(memory_used() == 0, "%llu", (unsigned long long)memory_used());
    }
    memory_set_budget(0);
    arena_finish(&arena);
    arena_finish(NULL);
}

TEST(strings_are_copied_and_formatted)
{
    struct arena arena = {0};
    char source[] = "glow-worm";
    char *copy = arena_strdup(&arena, source);
    REQUIRE(copy);
    source[0] = 'x';
    CHECK(strcmp(copy, "glow-worm") == 0, "%s", copy);
    char *text = arena_printf(&arena, "%s[%d]", copy, 7);
    REQUIRE(text);
    CHECK(strcmp(text, "glow-worm[7]") == 0, "%s", text);
    memory_set_budget(memory_used());
    CHECK(!arena_strdup(&arena, "more"));
    CHECK(!arena_printf(&arena, "%d", 1));
    memory_set_budget(0);
    arena_finish(&arena);
}

TEST(the_nth_allocation_can_be_made_to_fail)
{
    struct arena a = {0}, b = {0};
    arena_fail_at(3);
    CHECK(arena_alloc(&a, 1, 1));
    CHECK(arena_alloc(&b, 1, 1));
    CHECK(!arena_alloc(&a, 1, 1), "the third fails, whichever arena it is in");
    CHECK(arena_alloc(&a, 1, 1), "and only the third");
    arena_fail_at(1);
    arena_fail_at(0);
    CHECK(arena_alloc(&a, 1, 1), "called off");
    arena_finish(&a);
    arena_finish(&b);
}

TEST_MAIN(TEST_CASE(memory_is_zeroed_aligned_and_disjoint),
          TEST_CASE(a_count_of_zero_gives_distinct_pointers),
          TEST_CASE(overflowing_sizes_give_null), TEST_CASE(the_budget_holds_and_survives_finish),
          TEST_CASE(strings_are_copied_and_formatted),
          TEST_CASE(the_nth_allocation_can_be_made_to_fail))
