#include "cli/progress_bar.h"
#include "test.h"

#define MS UINT64_C(1000000)

// Opens a bar that draws into a file, which `drawn` reads.
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
    progress_bar_log(&bar, LOG_WARN, "dark");
    CHECK(strstr(drawn(&bar), "(5.0 s | 5.0 s)\r\x1b[Klampyris: warning: dark\n"), "%s",
          drawn(&bar));
    fclose(bar.stream);
}

// The program ends with an error, so no progress may follow it.
TEST(an_error_ends_the_phase)
{
    struct progress_bar bar;
    REQUIRE(open_bar(&bar, false));
    progress_bar_update(&bar, "Rendering", 0, 0);
    progress_bar_update(&bar, "Rendering", 0.5, 5000 * MS);
    progress_bar_log(&bar, LOG_ERROR, "lost");
    const char *error = strstr(drawn(&bar), "\nlampyris: error: lost\n");
    REQUIRE(error, "%s", drawn(&bar));
    CHECK(strstr(strchr(drawn(&bar), '\n') + 1, "Rendering: ") < error, "%s", drawn(&bar));
    progress_bar_finish(&bar);
    CHECK(strcmp(strstr(drawn(&bar), "lampyris"), "lampyris: error: lost\n") == 0, "%s",
          drawn(&bar));
    fclose(bar.stream);
}

// Results are printed to another stream, so the bar must be ended before them.
TEST(progress_ends_before_results)
{
    struct progress_bar bar;
    REQUIRE(open_bar(&bar, true));
    struct progress progress = progress_bar_listener(&bar);
    progress_bar_update(&bar, "Rendering", 0, 0);
    progress_bar_update(&bar, "Rendering", 0.5, 5000 * MS);
    progress_end(&progress);
    const char *ended = strstr(drawn(&bar), "(5.0 s | 5.0 s)\r\x1b[KRendering: ");
    CHECK(ended && ended[strlen(ended) - 1] == '\n', "%s", drawn(&bar));
    size_t length = strlen(drawn(&bar));
    progress_bar_finish(&bar);
    CHECK(strlen(drawn(&bar)) == length, "%s", drawn(&bar));
    fclose(bar.stream);
}

// Samples of an earlier run do not count for the speed.
TEST(a_resumed_render_knows_what_is_left)
{
    struct progress_bar bar;
    REQUIRE(open_bar(&bar, false));
    progress_bar_update(&bar, "Rendering", 0.8, 0);
    progress_bar_update(&bar, "Rendering", 0.9, 10000 * MS);
    CHECK(strcmp(drawn(&bar), "Rendering: 90% (10.0 s elapsed, 10.0 s remaining)\n") == 0, "%s",
          drawn(&bar));
    fclose(bar.stream);
}

// The fraction decreases, as it does if the error decreases more slowly than expected.
TEST(a_goal_that_moved_away)
{
    struct progress_bar bar;
    REQUIRE(open_bar(&bar, false));
    progress_bar_update(&bar, "Rendering", 0.9, 0);
    progress_bar_update(&bar, "Rendering", 0.3, 500 * MS);
    progress_bar_update(&bar, "Rendering", 0.4, 5500 * MS);
    CHECK(strcmp(drawn(&bar), "Rendering: 40% (5.5 s elapsed, 30.0 s remaining)\n") == 0, "%s",
          drawn(&bar));
    fclose(bar.stream);
}

// The bar of the previous phase must not remain, but not every phase needs a line of its own.
TEST(a_terminal_names_phases_as_they_begin)
{
    struct progress_bar bar;
    REQUIRE(open_bar(&bar, true));
    progress_bar_update(&bar, "Building BVH", 0, 0);
    progress_bar_update(&bar, "Building BVH", 1, 2000 * MS);
    progress_bar_update(&bar, "Compiling", 0, 2000 * MS);
    CHECK(strstr(drawn(&bar), "\r\x1b[KBuilding BVH: 2.0 s\nCompiling: ["), "%s", drawn(&bar));
    progress_bar_update(&bar, "Rendering", 0, 2500 * MS);
    CHECK(strstr(drawn(&bar), "(0.0 s | ?)\r\x1b[KRendering: ["), "%s", drawn(&bar));
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
          TEST_CASE(messages_do_not_run_into_the_bar), TEST_CASE(an_error_ends_the_phase),
          TEST_CASE(progress_ends_before_results), TEST_CASE(a_resumed_render_knows_what_is_left),
          TEST_CASE(a_goal_that_moved_away), TEST_CASE(a_terminal_names_phases_as_they_begin),
          TEST_CASE(odd_fractions_do_no_harm))
