#define _GNU_SOURCE
#include "base/file.h"
#include "temporary_folder.h"
#include "test.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>

static bool content_is(const char *path, const char *expected)
{
    char text[256] = "";
    FILE *file = fopen(path, "rb");
    if (!file)
        return false;
    size_t size = fread(text, 1, sizeof text - 1, file);
    fclose(file);
    return size == strlen(expected) && strcmp(text, expected) == 0;
}

static unsigned mode_of(const char *path)
{
    struct stat status;
    return stat(path, &status) == 0 ? status.st_mode & 07777 : 0;
}

TEST(a_new_file_appears_only_at_commit)
{
    char folder[200];
    REQUIRE(temporary_enter(folder, sizeof folder));
    mode_t umask_before = umask(027);
    struct file_writer writer;
    struct err err = {0};
    REQUIRE(file_writer_open(&writer, "new.exr", &err), "%s", err.msg);
    CHECK(file_writer_write(&writer, "ab", 2, &err) && file_writer_write(&writer, "c", 1, &err));
    CHECK(access("new.exr", F_OK) != 0, "not yet");
    CHECK(file_writer_commit(&writer, &err), "%s", err.msg);
    file_writer_finish(&writer);
    CHECK(content_is("new.exr", "abc"));
    CHECK(mode_of("new.exr") == 0640, "%o", mode_of("new.exr"));
    CHECK(temporary_entries(".") == 1, "%d", temporary_entries("."));
    umask(umask_before);
    temporary_leave(folder);
}

TEST(an_old_file_stays_until_commit_and_passes_on_its_permissions)
{
    char folder[200];
    REQUIRE(temporary_enter(folder, sizeof folder));
    REQUIRE(temporary_write("old", "before") && chmod("old", 0604) == 0);
    struct file_writer writer;
    struct err err = {0};
    REQUIRE(file_writer_open(&writer, "old", &err), "%s", err.msg);
    CHECK(file_writer_write(&writer, "after", 5, &err));
    CHECK(content_is("old", "before"));
    file_writer_finish(&writer);
    file_writer_finish(&writer);
    CHECK(content_is("old", "before") && temporary_entries(".") == 1);
    CHECK(file_write_atomic("old", "after", 5, &err), "%s", err.msg);
    CHECK(content_is("old", "after") && mode_of("old") == 0604, "%o", mode_of("old"));
    CHECK(temporary_entries(".") == 1);
    file_writer_finish(NULL);
    file_writer_finish(&(struct file_writer){0});
    temporary_leave(folder);
}

TEST(two_writers_do_not_meet)
{
    char folder[200];
    REQUIRE(temporary_enter(folder, sizeof folder));
    struct file_writer a, b;
    struct err err = {0};
    REQUIRE(file_writer_open(&a, "a", &err), "%s", err.msg);
    REQUIRE(file_writer_open(&b, "b", &err), "%s", err.msg);
    CHECK(file_writer_write(&a, "1", 1, &err) && file_writer_write(&b, "2", 1, &err));
    CHECK(file_writer_commit(&a, &err) && file_writer_commit(&b, &err));
    CHECK(content_is("a", "1") && content_is("b", "2"));
    temporary_leave(folder);
}

TEST(links_are_followed_and_kept)
{
    char folder[200];
    REQUIRE(temporary_enter(folder, sizeof folder));
    struct err err = {0};
    REQUIRE(mkdir("there", 0700) == 0 && temporary_write("there/file", "before"));
    REQUIRE(symlink("there/file", "link") == 0);
    CHECK(file_write_atomic("link", "after", 5, &err), "%s", err.msg);
    struct stat status;
    CHECK(lstat("link", &status) == 0 && S_ISLNK(status.st_mode));
    CHECK(content_is("there/file", "after") && temporary_entries("there") == 1);
    temporary_leave(folder);
}

static void check_unwritable(const char *path, const char *expected)
{
    struct err err = {0};
    CHECK(!file_check_writable(path, &err), "%s", path);
    CHECK(err.code == ERR_OUTPUT && strstr(err.msg, expected), "%s", err.msg);
    err = (struct err){0};
    CHECK(!file_write_atomic(path, "x", 1, &err), "%s", path);
    CHECK(err.code == ERR_OUTPUT && strstr(err.msg, expected), "%s", err.msg);
}

// The file that the link leads to, by way of other links, is created; the link remains.
TEST(links_that_lead_nowhere_are_followed)
{
    char folder[200];
    REQUIRE(temporary_enter(folder, sizeof folder));
    struct err err = {0};
    struct stat status;
    REQUIRE(mkdir("there", 0700) == 0 && symlink("there/second", "first") == 0 &&
            symlink("new file", "there/second") == 0);
    CHECK(file_check_writable("first", &err) && temporary_entries("there") == 1, "%s", err.msg);
    CHECK(file_check_space("first", 0, &err), "%s", err.msg);
    CHECK(file_write_atomic("first", "content", 7, &err), "%s", err.msg);
    CHECK(lstat("first", &status) == 0 && S_ISLNK(status.st_mode));
    CHECK(lstat("there/second", &status) == 0 && S_ISLNK(status.st_mode));
    CHECK(content_is("there/new file", "content") && temporary_entries("there") == 2);
    REQUIRE(symlink("nowhere/file", "broken") == 0 && symlink("round", "round") == 0);
    check_unwritable("broken", "nowhere/file: cannot create");
    check_unwritable("round", "Too many levels");
    temporary_leave(folder);
}

// Changes one bit of a byte in the first, a middle and the last block of the file.
TEST(what_reads_back_otherwise_replaces_nothing)
{
    enum { SIZE = 200000 };
    static const size_t places[] = {1, 2, 65536, 65537, 131072, 150000, SIZE};
    static char data[SIZE];
    char folder[200];
    REQUIRE(temporary_enter(folder, sizeof folder) && temporary_write("old", "before"));
    for (size_t i = 0; i < SIZE; i++)
        data[i] = (char)(i * 31 >> 3);
    for (size_t i = 0; i < sizeof places / sizeof places[0]; i++) {
        struct err err = {0};
        file_corrupt_at(places[i]);
        CHECK(!file_write_atomic("old", data, SIZE, &err), "byte %zu", places[i]);
        CHECK(err.code == ERR_OUTPUT && strstr(err.msg, "old: the data read back differ"), "%s",
              err.msg);
        CHECK(content_is("old", "before") && temporary_entries(".") == 1);
    }
    struct err err = {0};
    CHECK(file_write_atomic("old", data, SIZE, &err), "%s", err.msg);
    struct arena arena = {0};
    struct file_bytes bytes = {0};
    CHECK(file_read(&arena, "old", 0, &bytes, &err) && bytes.size == SIZE &&
          memcmp(bytes.data, data, SIZE) == 0);
    arena_finish(&arena);
    CHECK(file_write_atomic("old", "", 0, &err) && content_is("old", ""), "%s", err.msg);
    temporary_leave(folder);
}

TEST(the_check_finds_out_and_leaves_nothing)
{
    char folder[200];
    REQUIRE(temporary_enter(folder, sizeof folder));
    struct err err = {0};
    CHECK(file_check_writable("new.png", &err), "%s", err.msg);
    CHECK(temporary_entries(".") == 0, "%d", temporary_entries("."));
    REQUIRE(temporary_write("file", "x"));
    check_unwritable("", "is empty");
    check_unwritable("nowhere/new.png", "No such file");
    check_unwritable("file/new.png", "Not a directory");
    check_unwritable(folder, "is a folder");
    if (geteuid() != 0) {
        REQUIRE(mkdir("locked", 0500) == 0 && chmod("file", 0400) == 0);
        check_unwritable("locked/new.png", "Permission denied");
        check_unwritable("file", "Permission denied");
    }
    temporary_leave(folder);
}

TEST(devices_are_written_to_directly)
{
    struct err err = {0};
    if (access("/dev/full", W_OK) != 0)
        SKIP("there is no /dev/full");
    CHECK(file_check_writable("/dev/full", &err), "%s", err.msg);
    CHECK(!file_write_atomic("/dev/full", "x", 1, &err));
    CHECK(err.code == ERR_OUTPUT && strstr(err.msg, "/dev/full: cannot write: No space"), "%s",
          err.msg);
    CHECK(file_write_atomic("/dev/null", "x", 1, &err), "%s", err.msg);
    struct stat status;
    CHECK(stat("/dev/null", &status) == 0 && S_ISCHR(status.st_mode));
}

TEST(pipes_are_written_to_when_somebody_reads)
{
    char folder[200];
    REQUIRE(temporary_enter(folder, sizeof folder) && mkfifo("fifo", 0600) == 0);
    struct err err = {0};
    alarm(10);
    CHECK(!file_write_atomic("fifo", "x", 1, &err));
    CHECK(err.code == ERR_OUTPUT && strstr(err.msg, "nobody reads"), "%s", err.msg);
    int reader = open("fifo", O_RDONLY | O_NONBLOCK);
    CHECK(file_write_atomic("fifo", "xyz", 3, &err), "%s", err.msg);
    char text[4] = "";
    CHECK(read(reader, text, 3) == 3 && strcmp(text, "xyz") == 0, "%s", text);
    alarm(0);
    close(reader);
    temporary_leave(folder);
}

// A limit of the file size simulates a disk that becomes full during writing.
TEST(a_disk_that_fills_up_loses_nothing)
{
    char folder[200];
    REQUIRE(temporary_enter(folder, sizeof folder) && temporary_write("old", "before"));
    signal(SIGXFSZ, SIG_IGN);
    struct rlimit before, small;
    REQUIRE(getrlimit(RLIMIT_FSIZE, &before) == 0);
    small = (struct rlimit){.rlim_cur = 1000, .rlim_max = before.rlim_max};
    REQUIRE(setrlimit(RLIMIT_FSIZE, &small) == 0);
    static const char data[3000];
    struct err err = {0};
    CHECK(!file_write_atomic("old", data, sizeof data, &err));
    setrlimit(RLIMIT_FSIZE, &before);
    CHECK(err.code == ERR_OUTPUT && strstr(err.msg, "old: cannot write: File too large"), "%s",
          err.msg);
    CHECK(content_is("old", "before") && temporary_entries(".") == 1);
    temporary_leave(folder);
}

TEST(a_failed_rename_removes_the_temporary_file)
{
    char folder[200];
    REQUIRE(temporary_enter(folder, sizeof folder));
    struct file_writer writer;
    struct err err = {0};
    REQUIRE(file_writer_open(&writer, "target", &err), "%s", err.msg);
    REQUIRE(mkdir("target", 0700) == 0);
    CHECK(!file_writer_commit(&writer, &err));
    CHECK(err.code == ERR_OUTPUT && strstr(err.msg, "target"), "%s", err.msg);
    CHECK(temporary_entries(".") == 1, "%d", temporary_entries("."));
    temporary_leave(folder);
}

TEST(space_is_known_before_writing)
{
    char folder[200];
    REQUIRE(temporary_enter(folder, sizeof folder) && temporary_write("old", "x"));
    struct err err = {0};
    const char *const paths[] = {"new", "old", "./new"};
    for (size_t i = 0; i < sizeof paths / sizeof paths[0]; i++) {
        CHECK(file_check_space(paths[i], 0, &err), "%s", err.msg);
        err = (struct err){0};
        CHECK(!file_check_space(paths[i], UINT64_MAX, &err), "%s", paths[i]);
        CHECK(err.code == ERR_OUTPUT && strstr(err.msg, "16.0 EiB"), "%s", err.msg);
    }
    CHECK(file_check_space("/dev/null", UINT64_MAX, &err), "a device has no size");
    temporary_leave(folder);
}

// Only on Linux: on other systems the temporary file has a name from the start.
TEST(a_killed_process_leaves_nothing)
{
#ifndef O_TMPFILE
    SKIP("files without a name are not known here");
#else
    char folder[200];
    REQUIRE(temporary_enter(folder, sizeof folder));
    int probe = open(".", O_TMPFILE | O_WRONLY, 0600);
    if (probe < 0) {
        temporary_leave(folder);
        SKIP("this file system knows no files without a name");
    }
    close(probe);
    REQUIRE(temporary_write("old", "before"));
    pid_t child = fork();
    if (child == 0) {
        struct file_writer writer;
        struct err err;
        if (file_writer_open(&writer, "old", &err) && file_writer_write(&writer, "x", 1, &err))
            _exit(0);
        _exit(1);
    }
    int status;
    REQUIRE(waitpid(child, &status, 0) == child && status == 0, "%d", status);
    CHECK(content_is("old", "before") && temporary_entries(".") == 1);
    temporary_leave(folder);
#endif
}

TEST_MAIN(TEST_CASE(a_new_file_appears_only_at_commit),
          TEST_CASE(an_old_file_stays_until_commit_and_passes_on_its_permissions),
          TEST_CASE(two_writers_do_not_meet), TEST_CASE(links_are_followed_and_kept),
          TEST_CASE(links_that_lead_nowhere_are_followed),
          TEST_CASE(what_reads_back_otherwise_replaces_nothing),
          TEST_CASE(the_check_finds_out_and_leaves_nothing),
          TEST_CASE(devices_are_written_to_directly),
          TEST_CASE(pipes_are_written_to_when_somebody_reads),
          TEST_CASE(a_disk_that_fills_up_loses_nothing),
          TEST_CASE(a_failed_rename_removes_the_temporary_file),
          TEST_CASE(space_is_known_before_writing), TEST_CASE(a_killed_process_leaves_nothing))
