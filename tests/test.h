// The smallest test harness that says what went wrong. A test program is a list of functions:
//
//   TEST(arena_alloc_is_zeroed) { … CHECK(p[0] == 0, "got %d", p[0]); }
//   TEST_MAIN(TEST_CASE(arena_alloc_is_zeroed), …)
//
// Exit status: 0 passed, 1 failed, 77 skipped (a test called SKIP and none failed).
#ifndef LAMPYRIS_TESTS_TEST_H
#define LAMPYRIS_TESTS_TEST_H

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct test_case {
    const char *name;
    void (*run)(void);
};

// These are shared by the whole program: fixtures in files of their own count, too. They are weak,
// so that each file may define them.
#ifdef _WIN32
#define TEST_SHARED __attribute__((selectany))
#else
#define TEST_SHARED __attribute__((weak))
#endif
extern int test_failures, test_skips;
TEST_SHARED int test_failures = 0, test_skips = 0;

#define TEST(name) static void test_##name(void)

// Records a failure with a message and goes on.
#define CHECK(condition, ...)                                                                      \
    do {                                                                                           \
        if (!(condition)) {                                                                        \
            test_failures++;                                                                       \
            fprintf(stderr, "%s:%d: %s:", __FILE__, __LINE__, #condition);                         \
            fprintf(stderr, " " __VA_ARGS__);                                                      \
            fputc('\n', stderr);                                                                   \
        }                                                                                          \
    } while (0)

// Records a failure and leaves the test function.
#define REQUIRE(condition, ...)                                                                    \
    do {                                                                                           \
        if (!(condition)) {                                                                        \
            CHECK(false && (condition), __VA_ARGS__);                                              \
            return;                                                                                \
        }                                                                                          \
    } while (0)

// Leaves the test function as skipped; with LAMPYRIS_NO_SKIP in the environment that is a failure.
#define SKIP(...)                                                                                  \
    do {                                                                                           \
        fprintf(stderr, "skipped: " __VA_ARGS__);                                                  \
        fputc('\n', stderr);                                                                       \
        if (getenv("LAMPYRIS_NO_SKIP"))                                                            \
            test_failures++;                                                                       \
        else                                                                                       \
            test_skips++;                                                                          \
        return;                                                                                    \
    } while (0)

static inline bool test_is_wanted(const char *name, int argc, char **argv)
{
    size_t length = strlen(name);
    if (argc <= 1)
        return length < 5 || strcmp(name + length - 5, "_long") != 0;
    for (int i = 1; i < argc; i++)
        if (strcmp(argv[i], name) == 0)
            return true;
    return false;
}

// `prog NAME...` runs these cases, `prog` all but those whose name ends in _long.
static inline int test_run(const struct test_case *cases, size_t count, int argc, char **argv)
{
    for (size_t i = 0; i < count; i++) {
        if (!test_is_wanted(cases[i].name, argc, argv))
            continue;
        int failures = test_failures, skips = test_skips;
        cases[i].run();
        const char *result = test_skips > skips ? "skip" : "ok  ";
        printf("%s %s\n", test_failures > failures ? "FAIL" : result, cases[i].name);
        fflush(stdout);
    }
    return test_failures ? 1 : test_skips ? 77 : 0;
}

// clang-format takes these braces for a block.
// clang-format off
#define TEST_CASE(name) {#name, test_##name}
// clang-format on
#define TEST_MAIN(...)                                                                             \
    int main(int argc, char **argv)                                                                \
    {                                                                                              \
        static const struct test_case cases[] = {__VA_ARGS__};                                     \
        return test_run(cases, sizeof cases / sizeof cases[0], argc, argv);                        \
    }

#endif
