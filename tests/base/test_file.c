#define _GNU_SOURCE
#include "base/file.h"
#include "temporary_folder.h"
#include "test.h"

#include <sys/stat.h>

static struct arena arena;

static void check_refused(const char *path, size_t max_bytes, const char *expected)
{
    struct file_bytes bytes = {0};
    struct err err = {0};
    alarm(10); // a blocked open must fail the test
    CHECK(!file_read(&arena, path, max_bytes, &bytes, &err), "%s", path);
    alarm(0);
    CHECK(err.code == ERR_INPUT, "%s: code %d", path, err.code);
    CHECK(strstr(err.msg, path) && strstr(err.msg, expected), "%s", err.msg);
}

TEST(reads_whole_files_with_a_nul_behind)
{
    char folder[200];
    REQUIRE(temporary_enter(folder, sizeof folder));
    REQUIRE(temporary_write("a.txt", "hello") && temporary_write("empty", ""));
    struct file_bytes bytes;
    struct err err = {0};
    REQUIRE(file_read(&arena, "a.txt", 0, &bytes, &err), "%s", err.msg);
    CHECK(bytes.size == 5 && memcmp(bytes.data, "hello", 6) == 0);
    REQUIRE(file_read(&arena, "a.txt", 5, &bytes, &err), "%s", err.msg);
    REQUIRE(file_read(&arena, "empty", 0, &bytes, &err), "%s", err.msg);
    CHECK(bytes.size == 0 && bytes.data[0] == 0);
    temporary_leave(folder);
    arena_finish(&arena);
}

TEST(refuses_what_is_no_regular_file)
{
    char folder[200];
    REQUIRE(temporary_enter(folder, sizeof folder));
    REQUIRE(temporary_write("a.txt", "hello") && mkfifo("fifo", 0600) == 0);
    check_refused("missing", 0, "No such file");
    check_refused("a.txt", 4, "at most 4");
    check_refused("fifo", 0, "is a pipe");
    check_refused("/dev/zero", 0, "is a character device");
    check_refused(folder, 0, "is a folder");
    check_refused("a.txt/b", 0, "Not a directory");
    if (geteuid() != 0) {
        chmod("a.txt", 0);
        check_refused("a.txt", 0, "Permission denied");
    }
    temporary_leave(folder);
    arena_finish(&arena);
}

TEST(reading_reports_memory)
{
    char folder[200];
    REQUIRE(temporary_enter(folder, sizeof folder));
    REQUIRE(temporary_write("a.txt", "hello"));
    struct file_bytes bytes;
    struct err err = {0};
    arena_fail_at(1);
    CHECK(!file_read(&arena, "a.txt", 0, &bytes, &err));
    CHECK(err.code == ERR_SYSTEM && strstr(err.msg, "a.txt: out of memory"), "%s", err.msg);
    temporary_leave(folder);
    arena_finish(&arena);
}

static void check_resolves(const char *base, const char *relative, bool decode, const char *to)
{
    const struct file_reference reference = {.folder = base, .percent_decode = decode};
    struct err err = {0};
    char *path = file_resolve(&arena, &reference, relative, &err);
    REQUIRE(path, "%s: %s", relative, err.msg);
    char *expected = realpath(to, NULL);
    CHECK(expected && strcmp(path, expected) == 0, "%s instead of %s", path, to);
    free(expected);
}

static void check_rejected(const char *relative, bool decode, const char *expected)
{
    const struct file_reference reference = {.folder = "base", .percent_decode = decode};
    struct err err = {0};
    char *path = file_resolve(&arena, &reference, relative, &err);
    CHECK(!path, "\"%s\" led to %s", relative, path);
    CHECK(err.code == ERR_INPUT, "\"%s\": code %d", relative, err.code);
    CHECK(strstr(err.msg, expected), "%s", err.msg);
}

// Makes the folder base/ with files and links, and base-secret and secret beside it.
static bool make_tree(void)
{
    return mkdir("base", 0700) == 0 && mkdir("base/sub", 0700) == 0 &&
           mkdir("base-secret", 0700) == 0 && temporary_write("secret", "x") &&
           temporary_write("base-secret/a", "x") && temporary_write("base/a b.bin", "x") &&
           temporary_write("base/sub/c", "x") && temporary_write("base/100%", "x") &&
           temporary_write("base/..d", "x") && symlink("sub/c", "base/inner") == 0 &&
           symlink("../secret", "base/outer") == 0 && symlink("..", "base/up") == 0 &&
           symlink("../base-secret/a", "base/sibling") == 0 && mkfifo("base/fifo", 0600) == 0;
}

TEST(paths_inside_are_resolved)
{
    char folder[200];
    REQUIRE(temporary_enter(folder, sizeof folder) && make_tree());
    check_resolves("base", "a b.bin", false, "base/a b.bin");
    check_resolves("base", "a%20b.bin", true, "base/a b.bin");
    check_resolves("base", "sub/c", false, "base/sub/c");
    check_resolves("base/", "./sub//c", false, "base/sub/c");
    check_resolves("base", "sub%2Fc", true, "base/sub/c");
    check_resolves("base", "100%", false, "base/100%");
    check_resolves("base", "100%25", true, "base/100%");
    check_resolves("base", "..d", false, "base/..d");
    check_resolves("base", "inner", false, "base/sub/c");
    char *deep = arena_printf(&arena, "%s/base/sub/c", folder);
    check_resolves("/", deep + 1, false, deep);
    temporary_leave(folder);
    arena_finish(&arena);
}

TEST(paths_that_lead_out_are_rejected)
{
    char folder[200];
    REQUIRE(temporary_enter(folder, sizeof folder) && make_tree());
    check_rejected("", false, "is empty");
    check_rejected("/etc/passwd", false, "is absolute");
    check_rejected("%2fetc/passwd", true, "is absolute");
    check_rejected("../secret", false, "\"..\"");
    check_rejected("sub/../../secret", false, "\"..\"");
    check_rejected("sub/..", false, "\"..\"");
    check_rejected("%2e%2E/secret", true, "\"..\"");
    check_rejected("..%2fsecret", true, "\"..\"");
    check_rejected("%2e%2e/secret", false, "No such file");
    check_rejected("file:///etc/passwd", false, "has a scheme");
    check_rejected("file%3a///etc/passwd", true, "has a scheme");
    check_rejected("HTTP://host/a", false, "has a scheme");
    check_rejected("a%00b", true, "malformed %XX escape");
    check_rejected("a%2", true, "malformed %XX escape");
    check_rejected("a%", true, "malformed %XX escape");
    check_rejected("a%zz", true, "malformed %XX escape");
    check_rejected("outer", false, "leads out");
    check_rejected("sibling", false, "leads out");
    check_rejected("up/secret", false, "leads out");
    check_rejected("fifo", false, "not a regular file");
    check_rejected("sub", false, "not a regular file");
    check_rejected("missing", false, "No such file");
    temporary_leave(folder);
    arena_finish(&arena);
}

static void check_joined(const char *relative, bool decode, const char *expected)
{
    const struct file_reference reference = {
        .folder = "100%41", .percent_decode = decode, .allow_outside = true};
    struct err err = {0};
    char *path = file_resolve(&arena, &reference, relative, &err);
    CHECK(path ? expected && strcmp(path, expected) == 0 : !expected, "\"%s\": %s", relative,
          path ? path : err.msg);
    CHECK(path || (err.code == ERR_INPUT && strstr(err.msg, "malformed %XX escape")), "%s",
          err.msg);
}

TEST(paths_that_may_lead_out_are_joined_only)
{
    check_joined("missing", false, "100%41/missing");
    check_joined("../a", false, "100%41/../a");
    check_joined("/etc/passwd", false, "/etc/passwd");
    check_joined("%2Fetc/passwd", true, "/etc/passwd");
    check_joined("a%20b", true, "100%41/a b");
    check_joined("a%20b", false, "100%41/a%20b");
    check_joined("a%2", true, NULL);
    check_joined("a%00", true, NULL);
    arena_finish(&arena);
}

TEST(resolving_reports_memory)
{
    const struct file_reference inside = {.folder = "base", .percent_decode = true};
    const struct file_reference anywhere = {.folder = "base", .allow_outside = true};
    char folder[200];
    REQUIRE(temporary_enter(folder, sizeof folder) && make_tree());
    for (uint64_t n = 1; n <= 4; n++) {
        struct err err = {0};
        arena_fail_at(n);
        CHECK(!file_resolve(&arena, &inside, "sub/c", &err), "%d", (int)n);
        CHECK(err.code == ERR_SYSTEM, "%d: %s", (int)n, err.msg);
    }
    for (uint64_t n = 1; n <= 2; n++) {
        struct err err = {0};
        arena_fail_at(n);
        CHECK(!file_resolve(&arena, &anywhere, "sub/c", &err), "%d", (int)n);
        CHECK(err.code == ERR_SYSTEM, "%d: %s", (int)n, err.msg);
    }
    arena_fail_at(0);
    temporary_leave(folder);
    arena_finish(&arena);
}

TEST(paths_are_taken_apart)
{
    CHECK(strcmp(path_folder(&arena, "a/b.c"), "a") == 0);
    CHECK(strcmp(path_folder(&arena, "/b.c"), "/") == 0);
    CHECK(strcmp(path_folder(&arena, "b.c"), ".") == 0);
    CHECK(strcmp(path_folder(&arena, "a/b/"), "a/b") == 0);
    CHECK(strcmp(path_name("a/b.c"), "b.c") == 0);
    CHECK(strcmp(path_name("b"), "b") == 0);
    CHECK(strcmp(path_extension("a.PNG"), "PNG") == 0);
    CHECK(strcmp(path_extension("a.tar.gz"), "gz") == 0);
    CHECK(strcmp(path_extension("a.b/c"), "") == 0);
    CHECK(strcmp(path_extension("a/.hidden"), "") == 0);
    CHECK(strcmp(path_numbered(&arena, "a.b/c.d.png", 12), "a.b/c.d.0012.png") == 0);
    CHECK(strcmp(path_numbered(&arena, "a.b/c", 12345), "a.b/c.12345") == 0);
    arena_finish(&arena);
}

TEST_MAIN(TEST_CASE(reads_whole_files_with_a_nul_behind),
          TEST_CASE(refuses_what_is_no_regular_file), TEST_CASE(reading_reports_memory),
          TEST_CASE(paths_inside_are_resolved), TEST_CASE(paths_that_lead_out_are_rejected),
          TEST_CASE(paths_that_may_lead_out_are_joined_only), TEST_CASE(resolving_reports_memory),
          TEST_CASE(paths_are_taken_apart))
