#define _GNU_SOURCE
#include "base/file_inputs.h"

#include "base/file.h"
#include "base/parallel.h"
#include "temporary_folder.h"
#include "test.h"

#include <unistd.h>

static bool reads(const char *path)
{
    struct arena arena = {0};
    struct file_bytes bytes;
    bool ok = file_read(&arena, path, 0, &bytes, NULL);
    arena_finish(&arena);
    return ok;
}

static void check_refused(const char *output, const char *input)
{
    struct err err = {0};
    CHECK(!file_inputs_check(output, &err), "%s", output);
    CHECK(err.code == ERR_USAGE && strncmp(err.msg, output, strlen(output)) == 0 &&
              strstr(err.msg, input),
          "%s", err.msg);
    err = (struct err){0};
    CHECK(!file_check_writable(output, &err) && err.code == ERR_USAGE, "%s", err.msg);
    CHECK(!file_write_atomic(output, "x", 1, &err) && err.code == ERR_USAGE, "%s", err.msg);
}

TEST(inputs_are_not_written_over)
{
    char folder[200], absolute[300];
    REQUIRE(temporary_enter(folder, sizeof folder));
    REQUIRE(temporary_write("in", "content") && temporary_write("other", "content"));
    REQUIRE(mkdir("there", 0700) == 0 && symlink("../in", "there/link") == 0 &&
            link("in", "hard") == 0);
    struct file_inputs inputs;
    struct err err = {0};
    file_inputs_begin(&inputs);
    REQUIRE(reads("in") && reads("./in") && reads("in"));
    CHECK(inputs.count == 2, "%zu", inputs.count);
    snprintf(absolute, sizeof absolute, "%s/in", folder);
    check_refused("in", "is read by this run");
    check_refused("there/../in", "in");
    check_refused("there/link", "in");
    check_refused("hard", "in");
    check_refused(absolute, "in");
    CHECK(file_write_atomic("other", "new", 3, &err), "%s", err.msg);
    CHECK(file_write_atomic("new", "new", 3, &err), "%s", err.msg);
    CHECK(file_inputs_check("nowhere/x", &err) && file_inputs_check("/dev/null", &err));
    CHECK(file_replace_atomic("in", "edited", 6, &err), "%s", err.msg);
    check_refused("in", "is read by this run");
    file_inputs_end(&inputs);
    CHECK(file_write_atomic("in", "x", 1, &err), "the run is over: %s", err.msg);
    temporary_leave(folder);
}

// A new file that an editor puts in place of an input is an input; the file that was renamed away
// is not.
TEST(inputs_are_looked_at_as_they_are)
{
    char folder[200];
    REQUIRE(temporary_enter(folder, sizeof folder) && temporary_write("in", "1"));
    struct file_inputs inputs;
    struct err err = {0};
    file_inputs_begin(&inputs);
    REQUIRE(reads("in") && rename("in", "backup") == 0 && temporary_write("in", "2"));
    check_refused("in", "is read by this run");
    CHECK(file_write_atomic("backup", "x", 1, &err), "%s", err.msg);
    file_inputs_end(&inputs);
    temporary_leave(folder);
}

TEST(inputs_may_be_named_before_they_are_read)
{
    char folder[200];
    REQUIRE(temporary_enter(folder, sizeof folder) && temporary_write("in", "1"));
    struct file_inputs inputs;
    struct err err = {0};
    CHECK(file_inputs_add("in", &err), "without a run nothing happens");
    file_inputs_begin(&inputs);
    CHECK(file_inputs_add("in", &err) && file_inputs_add("none", &err) &&
          file_inputs_add(".", &err) && inputs.count == 1);
    check_refused("in", "is read by this run");
    struct arena arena = {0};
    struct file_bytes bytes;
    REQUIRE(temporary_write("own", "1") && file_read_own(&arena, "own", 0, &bytes, &err));
    CHECK(file_write_atomic("own", "2", 1, &err), "%s", err.msg);
    arena_finish(&arena);
    file_inputs_end(&inputs);
    temporary_leave(folder);
}

TEST(what_a_run_goes_on_with_is_replaced_under_its_own_name)
{
    char folder[200];
    REQUIRE(temporary_enter(folder, sizeof folder) && temporary_write("own", "1"));
    REQUIRE(symlink("own", "link") == 0);
    struct file_inputs inputs;
    struct err err = {0};
    file_inputs_begin(&inputs);
    CHECK(file_inputs_add_own("own", &err) && inputs.count == 1);
    check_refused("link", "is the file own, which this run reads");
    CHECK(file_write_atomic("own", "2", 1, &err), "%s", err.msg);
    check_refused("link", "is the file own, which this run reads");
    CHECK(file_inputs_add("own", &err) && inputs.count == 1);
    check_refused("own", "is read by this run");
    file_inputs_end(&inputs);
    temporary_leave(folder);
}

static void read_some(void *context, size_t begin, size_t end, unsigned thread)
{
    (void)context, (void)thread;
    for (size_t i = begin; i < end; i++) {
        char name[20];
        snprintf(name, sizeof name, "%zu", i % 50);
        reads(name);
    }
}

TEST(threads_read)
{
    char folder[200];
    REQUIRE(temporary_enter(folder, sizeof folder));
    for (int i = 0; i < 50; i++) {
        char name[20];
        snprintf(name, sizeof name, "%d", i);
        REQUIRE(temporary_write(name, name));
    }
    struct file_inputs inputs;
    file_inputs_begin(&inputs);
    parallel_for(1000, 10, 4, read_some, NULL);
    CHECK(inputs.count == 50, "%zu", inputs.count);
    file_inputs_end(&inputs);
    temporary_leave(folder);
}

TEST(same_files)
{
    char folder[200];
    REQUIRE(temporary_enter(folder, sizeof folder));
    REQUIRE(temporary_write("a", "1") && temporary_write("b", "1") && mkdir("there", 0700) == 0);
    REQUIRE(symlink("a", "link") == 0 && symlink("there/new", "ahead") == 0 &&
            link("a", "hard") == 0);
    CHECK(file_is_same("a", "./a") && file_is_same("a", "link") && file_is_same("hard", "a"));
    CHECK(!file_is_same("a", "b") && !file_is_same("a", "new") && !file_is_same("new", "a"));
    CHECK(file_is_same("new", "there/../new") && file_is_same("ahead", "there/new"));
    CHECK(!file_is_same("new", "there/new") && !file_is_same("new", "newer"));
    temporary_leave(folder);
}

TEST_MAIN(TEST_CASE(inputs_are_not_written_over), TEST_CASE(inputs_are_looked_at_as_they_are),
          TEST_CASE(inputs_may_be_named_before_they_are_read),
          TEST_CASE(what_a_run_goes_on_with_is_replaced_under_its_own_name),
          TEST_CASE(threads_read), TEST_CASE(same_files))
