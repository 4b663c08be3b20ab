#include "clock.h"
#include "hash.h"
#include "test.h"

// The vectors of the FNV reference distribution (Noll, test_fnv.c).
TEST(fnv1a_reference_values)
{
    CHECK(hash_bytes(HASH_INIT, "", 0) == UINT64_C(0xcbf29ce484222325));
    CHECK(hash_bytes(HASH_INIT, "a", 1) == UINT64_C(0xaf63dc4c8601ec8c));
    CHECK(hash_bytes(HASH_INIT, "foobar", 6) == UINT64_C(0x85944171f73967e8));
}

TEST(hashing_continues)
{
    uint64_t hash = hash_bytes(hash_bytes(HASH_INIT, "foo", 3), "bar", 3);
    CHECK(hash == hash_bytes(HASH_INIT, "foobar", 6));
}

TEST(the_clock_never_goes_back)
{
    uint64_t previous = clock_ns();
    for (int i = 0; i < 1000; i++) {
        uint64_t now = clock_ns();
        CHECK(now >= previous);
        previous = now;
    }
    double seconds = clock_seconds_since(previous);
    CHECK(seconds >= 0 && seconds < 60, "%g", seconds);
}

TEST_MAIN(TEST_CASE(fnv1a_reference_values), TEST_CASE(hashing_continues),
          TEST_CASE(the_clock_never_goes_back))
