#include "progress_bar.h"
#include "test.h"

#define MS UINT64_C(1000000)

// A bar that draws into a file, read back by `drawn`.
static bool open_bar(struct progress_bar *bar, bool is_terminal)
{
    FILE *file = tmpfile();
    if (!file)
        return false;
    progress_bar_init(bar, file);
    bar->is_terminal = is_terminal;
    return true;
}

static const char *drawn(struct progress_bar *bar)
{
    static char text[4096];
    fflush(bar->stream);
    rewind(bar->stream);
    text[fread(text, 1, sizeof text - 1, bar->stream)] = '\0';
    fseek(bar->stream, 0, SEEK_END);
    return text;
}

TEST(short_phases_are_not_shown)
{
    struct progress_bar bar;
    REQUIRE(open_bar(&bar, true));
    progress_bar_update(&bar, "Loading", 0, 0);
    progress_bar_update(&bar, "Loading", 0.99, 999 * MS);
    progress_bar_update(&bar, "Building BVH", 0, 1000 * MS);
    progress_bar_update(&bar, "Building BVH", 1, 1900 * MS);
    progress_bar_finish(&bar);
    CHECK(strcmp(drawn(&bar), "") == 0, "%s", drawn(&bar));
    fclose(bar.stream);
}

TEST(a_terminal_gets_a_bar)
{
    struct progress_bar bar;
    REQUIRE(open_bar(&bar, true));
    progress_bar_update(&bar, "Rendering", 0, 0);
    progress_bar_update(&bar, "Rendering", 0.25, 2000 * MS);
    const char *first = "Rendering: [++++++++++                              ]  25% "
                        "(2.0 s | 6.0 s)";
    CHECK(strcmp(drawn(&bar), first) == 0, "%s", drawn(&bar));
    progress_bar_update(&bar, "Rendering", 0.26, 2050 * MS);
    CHECK(strcmp(drawn(&bar), first) == 0, "redrawn too soon: %s", drawn(&bar));
    progress_bar_update(&bar, "Rendering", 1, 130 * 1000 * MS);
    CHECK(strstr(drawn(&bar), "\r\x1b[KRendering: [++++"), "%s", drawn(&bar));
    CHECK(strstr(drawn(&bar), "] 100% (2 min 10 s | 0.0 s)"), "%s", drawn(&bar));
    progress_bar_update(&bar, "Writing", 0, 131 * 1000 * MS);
    CHECK(strstr(drawn(&bar), "\r\x1b[KRendering: 2 min 11 s\n"), "%s", drawn(&bar));
    fclose(bar.stream);
}

TEST(a_file_gets_a_line_now_and_then)
{
    struct progress_bar bar;
    REQUIRE(open_bar(&bar, false));
    for (uint64_t ms = 0; ms <= 12000; ms += 10)
        progress_bar_update(&bar, "Rendering", (double)ms / 36000, ms * MS);
    const char *expected = "Rendering: 2% (1.0 s elapsed, 35.0 s remaining)\n"
                           "Rendering: 16% (6.0 s elapsed, 30.0 s remaining)\n"
                           "Rendering: 30% (11.0 s elapsed, 25.0 s remaining)\n";
    CHECK(strcmp(drawn(&bar), expected) == 0, "%s", drawn(&bar));
    fclose(bar.stream);
}

TEST(quiet_is_quiet_but_for_messages)
{
    struct progress_bar bar;
    REQUIRE(open_bar(&bar, true));
    bar.is_quiet = true;
    progress_bar_update(&bar, "Rendering", 0, 0);
    progress_bar_update(&bar, "Rendering", 0.5, 5000 * MS);
    CHECK(strcmp(drawn(&bar), "") == 0, "%s", drawn(&bar));
    progress_bar_log(&bar, LOG_WARN, "no light");
    CHECK(strcmp(drawn(&bar), "lampyris: warning: no light\n") == 0, "%s", drawn(&bar));
    fclose(bar.stream);
}

TEST(messages_do_not_run_into_the_bar)
{
    struct progress_bar bar;
    REQUIRE(open_bar(&bar, true));
    progress_bar_update(&bar, "Rendering", 0, 0);
    progress_bar_update(&bar, "Rendering", 0.5, 5000 * MS);
    progress_bar_log(&bar, LOG_ERROR, "lost");
    CHECK(strstr(drawn(&bar), "(5.0 s | 5.0 s)\r\x1b[Klampyris: error: lost\n"), "%s", drawn(&bar));
    fclose(bar.stream);
}

TEST(odd_fractions_do_no_harm)
{
    struct progress_bar bar;
    REQUIRE(open_bar(&bar, true));
    progress_bar_update(&bar, "A phase with a name that is much too long to be kept", 0, 0);
    progress_bar_update(&bar, "A phase with a name that is much too long to be kept", NAN,
                        2000 * MS);
    CHECK(strstr(drawn(&bar), "0% (2.0 s | ?)"), "%s", drawn(&bar));
    progress_bar_update(&bar, "A phase with a name that is much too long to be kept", 7, 3000 * MS);
    CHECK(strstr(drawn(&bar), "100% (3.0 s | 0.0 s)"), "%s", drawn(&bar));
    progress_bar_update(&bar, "B", 0, 3000 * MS);
    progress_bar_update(&bar, "B", -1, 5000 * MS);
    CHECK(strstr(drawn(&bar), "B: ["), "%s", drawn(&bar));
    progress_bar_update(&bar, "C", 0, 5000 * MS);
    progress_bar_update(&bar, "C", 1e-300, 7000 * MS);
    CHECK(strstr(drawn(&bar), "very long"), "%s", drawn(&bar));
    fclose(bar.stream);
}

TEST_MAIN(TEST_CASE(short_phases_are_not_shown), TEST_CASE(a_terminal_gets_a_bar),
          TEST_CASE(a_file_gets_a_line_now_and_then), TEST_CASE(quiet_is_quiet_but_for_messages),
          TEST_CASE(messages_do_not_run_into_the_bar), TEST_CASE(odd_fractions_do_no_harm))
