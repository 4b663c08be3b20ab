#include "job/samples.h"
#include "test.h"

#include <string.h>

TEST(parts_have_every_sample_once)
{
    static const uint64_t samples[] = {1, 2, 3, 57, 448, 65536, 4294967294, 4294967295};
    for (size_t s = 0; s < sizeof samples / sizeof samples[0]; s++)
        for (uint32_t count = 1; count <= 1000; count += count < 20 ? 1 : 490) {
            if (count > 1 && count > samples[s] / 2)
                continue;
            uint64_t at = 0, least = UINT64_MAX, most = 0;
            for (uint32_t i = 1; i <= count; i++) {
                struct sample_range range = samples_of_part(i, count, samples[s]);
                uint64_t length = range.end - range.first;
                CHECK(range.first == at && range.first % 2 == 0 && range.end > range.first,
                      "part %u of %u of %llu", i, count, (unsigned long long)samples[s]);
                at = range.end;
                least = length < least ? length : least;
                most = length > most ? length : most;
            }
            CHECK(at == samples[s] && most - least <= 3, "%u parts of %llu", count,
                  (unsigned long long)samples[s]);
        }
}

TEST(parts_have_every_row_once)
{
    static const uint32_t heights[] = {1, 15, 16, 17, 720, 1080, 65535};
    for (size_t h = 0; h < sizeof heights / sizeof heights[0]; h++) {
        const uint32_t tiles = (heights[h] + 15) / 16;
        for (uint32_t count = 1; count <= tiles; count += count < 20 ? 1 : 97) {
            uint64_t at = 0;
            for (uint32_t i = 1; i <= count; i++) {
                const struct sample_range range = rows_of_part(i, count, heights[h], 16);
                const uint64_t length = range.end - range.first, fair = tiles / count * 16;
                CHECK(range.first == at && range.first % 16 == 0 && range.end > range.first,
                      "part %u of %u of %u rows", i, count, heights[h]);
                CHECK(length <= fair + 16 && (i == count || length >= fair),
                      "part %u of %u of %u rows has %llu", i, count, heights[h],
                      (unsigned long long)length);
                at = range.end;
            }
            CHECK(at == heights[h], "%u parts of %u rows", count, heights[h]);
        }
    }
}

static struct sample_ranges ranges_of(const char *text, struct arena *arena)
{
    struct sample_ranges ranges = {0};
    if (*text)
        CHECK(samples_parse(text, strlen(text), arena, &ranges), "%s is refused", text);
    return ranges;
}

static void check_text(const struct sample_ranges *ranges, const char *expected,
                       struct arena *arena)
{
    const char *text = samples_text(ranges, arena);
    CHECK(text && strcmp(text, expected) == 0, "%s; expected %s", text, expected);
}

TEST(texts_are_read_back)
{
    static const char *const good[] = {"0:2", "4:10,12:4294967295"};
    static const char *const bad[] = {
        "",   "none", "2:2",  "4:2", "0:2,2:4", "4:6,0:2", "0:2,",    "0:2x",
        ":2", "-1:2", " 0:2", "0:",  "0:2,2",   "0-2",     "0:2,0:2", "0:4294967296"};
    struct arena arena = {0};
    for (size_t i = 0; i < sizeof good / sizeof good[0]; i++) {
        struct sample_ranges ranges = ranges_of(good[i], &arena);
        check_text(&ranges, good[i], &arena);
    }
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        struct sample_ranges ranges;
        CHECK(!samples_parse(bad[i], strlen(bad[i]), &arena, &ranges), "%s is taken", bad[i]);
    }
    struct sample_ranges ranges;
    CHECK(samples_parse("0:2\nmore", 3, &arena, &ranges), "what stands behind is read");
    CHECK(!samples_parse("0:24", 3, &arena, &ranges), "a number goes on behind the text");
    arena_finish(&arena);
}

TEST(ranges_overlap_join_and_lack)
{
    static const struct {
        const char *a, *b, *joined, *missing; // `joined` is "" if the two overlap
    } cases[] = {
        {"0:2", "2:4", "0:4", "4:10"},
        {"0:2,6:8", "2:4", "0:4,6:8", "4:6,8:10"},
        {"2:4,8:10", "0:2,4:8", "0:10", "none"},
        {"4:6", "", "4:6", "0:4,6:10"},
        {"", "8:20", "8:20", "0:8"},
        {"12:14", "16:18", "12:14,16:18", "0:10"},
        {"0:4", "2:6", "", ""},
        {"0:2,4:8", "2:4,6:10", "", ""},
        {"0:10", "4:6", "", ""},
    };
    struct arena arena = {0};
    struct err err = {0};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
        for (int turned = 0; turned < 2; turned++) {
            struct sample_ranges a = ranges_of(turned ? cases[i].b : cases[i].a, &arena);
            struct sample_ranges b = ranges_of(turned ? cases[i].a : cases[i].b, &arena);
            struct sample_ranges joined, missing;
            struct sample_range common;
            bool overlaps = samples_overlap(&a, &b, &common);
            CHECK(overlaps == !*cases[i].joined, "case %zu", i);
            if (overlaps)
                continue;
            REQUIRE(samples_join(&a, &b, &arena, &joined, &err) &&
                        samples_missing(&joined, 10, &arena, &missing, &err),
                    "%s", err.msg);
            check_text(&joined, cases[i].joined, &arena);
            check_text(&missing, cases[i].missing, &arena);
        }
    arena_finish(&arena);
}

TEST_MAIN(TEST_CASE(parts_have_every_sample_once), TEST_CASE(parts_have_every_row_once),
          TEST_CASE(texts_are_read_back), TEST_CASE(ranges_overlap_join_and_lack))
