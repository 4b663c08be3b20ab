#include "base/clock.h"
#include "base/hash.h"
#include "test.h"

// Test vectors of the FNV reference distribution (Noll, test_fnv.c).
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

// Hashes of the reference implementation (Appleby, MurmurHash3.cpp), as widely published. Tests a
// tail of every length, and that each byte affects the hash.
TEST(hash128)
{
    const char *text = "The quick brown fox jumps over the lazy dog.";
    struct hash128 h = hash128_bytes("", 0);
    CHECK(h.word[0] == 0 && h.word[1] == 0);
    h = hash128_bytes("hello", 5);
    CHECK(h.word[0] == UINT64_C(0xcbd8a7b341bd9b02) && h.word[1] == UINT64_C(0x5b1e906a48ae1d19));
    h = hash128_bytes("hello, world", 12);
    CHECK(h.word[0] == UINT64_C(0x342fac623a5ebc8e) && h.word[1] == UINT64_C(0x4cdcbc079642414d));
    h = hash128_bytes(text, strlen(text));
    CHECK(h.word[0] == UINT64_C(0xcd99481f9ee902c9) && h.word[1] == UINT64_C(0x695da1a38987b6e7));
    for (size_t size = 1; size <= 40; size++) {
        uint8_t bytes[40] = {0};
        struct hash128 zeros = hash128_bytes(bytes, size);
        for (size_t i = 0; i < size; i++) {
            bytes[i] = 1;
            h = hash128_bytes(bytes, size);
            CHECK(h.word[0] != zeros.word[0] && h.word[1] != zeros.word[1], "byte %zu of %zu", i,
                  size);
            bytes[i] = 0;
        }
    }
}

TEST_MAIN(TEST_CASE(fnv1a_reference_values), TEST_CASE(hashing_continues),
          TEST_CASE(the_clock_never_goes_back), TEST_CASE(hash128))
