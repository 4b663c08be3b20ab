#include "base/suggest.h"
#include "test.h"

#include <stdint.h>

static void check_distance(const char *a, const char *b, size_t expected)
{
    CHECK(suggest_distance(a, b) == expected, "%s, %s: %zu", a, b, suggest_distance(a, b));
    CHECK(suggest_distance(b, a) == expected, "%s, %s: %zu", b, a, suggest_distance(b, a));
}

TEST(distances)
{
    check_distance("", "", 0);
    check_distance("", "abc", 3);
    check_distance("spp", "spp", 0);
    check_distance("spp", "psp", 1);
    check_distance("spp", "sp", 1);
    check_distance("spp", "sppp", 1);
    check_distance("spp", "stp", 1);
    check_distance("kitten", "sitting", 3);
    check_distance("ca", "abc", 3); // it would be 2 if a transposed letter could be edited again
}

TEST(long_words_are_infinitely_far)
{
    char word[100];
    memset(word, 'x', sizeof word);
    word[63] = '\0';
    CHECK(suggest_distance(word, word) == 0);
    word[63] = 'x';
    word[64] = '\0';
    CHECK(suggest_distance(word, word) == SIZE_MAX);
}

static const char *nearest(const char *wanted)
{
    static const char *const names[] = {"size", "spp", "spp-per-frame", "seed", "max-bounces"};
    struct suggestion suggestion = {.wanted = wanted};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
        suggest_offer(&suggestion, names[i]);
    return suggestion.nearest ? suggestion.nearest : "";
}

TEST(the_nearest_is_suggested_if_near_enough)
{
    CHECK(strcmp(nearest("sead"), "seed") == 0, "%s", nearest("sead"));
    CHECK(strcmp(nearest("sp"), "spp") == 0, "%s", nearest("sp"));
    CHECK(strcmp(nearest("maxbounce"), "max-bounces") == 0, "%s", nearest("maxbounce"));
    CHECK(strcmp(nearest("samples"), "") == 0, "%s", nearest("samples"));
    CHECK(strcmp(nearest("x"), "") == 0, "%s", nearest("x"));
}

TEST_MAIN(TEST_CASE(distances), TEST_CASE(long_words_are_infinitely_far),
          TEST_CASE(the_nearest_is_suggested_if_near_enough))
