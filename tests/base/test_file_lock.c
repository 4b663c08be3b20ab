#define _GNU_SOURCE
#include "base/file_lock.h"

#include "base/file.h"
#include "base/file_system.h"
#include "temporary_folder.h"
#include "test.h"

#include <sys/wait.h>

TEST(the_second_holder_fails_at_once)
{
    char folder[200];
    REQUIRE(temporary_enter(folder, sizeof folder));
    struct file_lock first, second;
    struct err err = {0};
    REQUIRE(file_lock_take(&first, "a.exr", &err), "%s", err.msg);
    CHECK(!file_lock_take(&second, "a.exr", &err));
    CHECK(err.code == ERR_OUTPUT && strstr(err.msg, "a.exr: is being written"), "%s", err.msg);
    file_lock_release(&second);
    err = (struct err){0};
    CHECK(!file_lock_take(&second, "./a.exr", &err), "the same file by another name");
    REQUIRE(file_lock_take(&second, "b.exr", &err), "%s", err.msg);
    file_lock_release(&second);
    file_lock_release(&first);
    CHECK(temporary_entries(".") == 0, "%d", temporary_entries("."));
    REQUIRE(file_lock_take(&first, "a.exr", &err), "%s", err.msg);
    file_lock_release(&first);
    file_lock_release(&first);
    file_lock_release(NULL);
    temporary_leave(folder);
}

// A killed process leaves the hidden file behind. It is removed unless a run holds its lock.
TEST(stale_locks_are_removed)
{
    char folder[200];
    REQUIRE(temporary_enter(folder, sizeof folder));
    struct err err = {0};
    struct file_lock lock;
    file_lock_remove_stale("c.exr"); // there is none
    REQUIRE(file_lock_take(&lock, "c.exr", &err), "%s", err.msg);
    const char *path = lock.path;
    file_lock_remove_stale("c.exr");
    CHECK(file_exists(path), "it is held");
    char kept[256];
    snprintf(kept, sizeof kept, "%s", path);
    file_lock_release(&lock);
    REQUIRE(file_write_atomic(kept, "", 0, &err), "%s", err.msg);
    file_lock_remove_stale("c.exr");
    CHECK(!file_exists(kept));
    temporary_leave(folder);
}

TEST(links_lead_to_one_lock)
{
    char folder[200];
    REQUIRE(temporary_enter(folder, sizeof folder));
    REQUIRE(mkdir("there", 0700) == 0 && temporary_write("there/file", "x"));
    REQUIRE(symlink("there/file", "link") == 0);
    struct file_lock first, second;
    struct err err = {0};
    REQUIRE(file_lock_take(&first, "link", &err), "%s", err.msg);
    CHECK(!file_lock_take(&second, "there/file", &err));
    file_lock_release(&first);
    CHECK(temporary_entries(".") == 2 && temporary_entries("there") == 1);
    temporary_leave(folder);
}

// Links to a file that does not exist yet share the lock of that file.
TEST(links_that_lead_nowhere_share_the_lock)
{
    char folder[200];
    REQUIRE(temporary_enter(folder, sizeof folder));
    REQUIRE(mkdir("there", 0700) == 0 && symlink("there/file", "link") == 0 &&
            symlink("link", "again") == 0);
    struct file_lock first, second;
    struct err err = {0};
    REQUIRE(file_lock_take(&first, "again", &err), "%s", err.msg);
    CHECK(temporary_entries("there") == 1 && temporary_entries(".") == 3);
    CHECK(!file_lock_take(&second, "there/file", &err) && err.code == ERR_OUTPUT);
    CHECK(!file_lock_take(&second, "link", &err) && err.code == ERR_OUTPUT);
    file_lock_release(&first);
    temporary_leave(folder);
}

// After kill -9 the lock file remains, but locks nothing.
TEST(a_dead_holder_holds_nothing)
{
    char folder[200];
    REQUIRE(temporary_enter(folder, sizeof folder));
    struct file_lock lock;
    struct err err = {0};
    pid_t child = fork();
    if (child == 0)
        _exit(file_lock_take(&lock, "a.exr", &err) ? 0 : 1);
    int status;
    REQUIRE(waitpid(child, &status, 0) == child && status == 0, "%d", status);
    CHECK(temporary_entries(".") == 1, "%d", temporary_entries("."));
    REQUIRE(file_lock_take(&lock, "a.exr", &err), "%s", err.msg);
    file_lock_release(&lock);
    CHECK(temporary_entries(".") == 0, "%d", temporary_entries("."));
    temporary_leave(folder);
}

TEST(names_of_any_length)
{
    char folder[200], name[256];
    REQUIRE(temporary_enter(folder, sizeof folder));
    memset(name, 'n', 255);
    name[255] = '\0';
    struct file_lock lock;
    struct err err = {0};
    REQUIRE(file_lock_take(&lock, name, &err), "%s", err.msg);
    file_lock_release(&lock);
    CHECK(!file_lock_take(&lock, "nowhere/a.exr", &err));
    CHECK(err.code == ERR_OUTPUT && strstr(err.msg, "nowhere/a.exr: cannot create a lock"), "%s",
          err.msg);
    temporary_leave(folder);
}

TEST(devices_have_none)
{
    struct file_lock first, second;
    struct err err = {0};
    CHECK(file_lock_take(&first, "/dev/null", &err), "%s", err.msg);
    CHECK(file_lock_take(&second, "/dev/null", &err), "%s", err.msg);
    file_lock_release(&first);
    file_lock_release(&second);
}

TEST_MAIN(TEST_CASE(the_second_holder_fails_at_once), TEST_CASE(links_lead_to_one_lock),
          TEST_CASE(stale_locks_are_removed), TEST_CASE(links_that_lead_nowhere_share_the_lock),
          TEST_CASE(a_dead_holder_holds_nothing), TEST_CASE(names_of_any_length),
          TEST_CASE(devices_have_none))
