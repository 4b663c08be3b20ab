// Tests the memory that the machine leaves to a process, with invented files of the system, and the
// budget of the process.
#define _GNU_SOURCE // nftw
#include "base/memory.h"
#include "temporary_folder.h"
#include "test.h"

#include <stdlib.h>
#include <sys/stat.h>

static char folder[64];

// Writes a file, and creates the folders of its path.
static void put(const char *path, const char *text)
{
    char part[256];
    for (const char *slash = strchr(path, '/'); slash; slash = strchr(slash + 1, '/')) {
        snprintf(part, sizeof part, "%.*s", (int)(slash - path), path);
        mkdir(part, 0777);
    }
    FILE *file = fopen(path, "w");
    REQUIRE(file);
    fputs(text, file);
    fclose(file);
}

static void check_available(uint64_t expected)
{
    uint64_t available = memory_available_in(".");
    CHECK(available == expected, "%llu bytes, expected %llu", (unsigned long long)available,
          (unsigned long long)expected);
}

TEST(the_least_of_machine_and_groups)
{
    REQUIRE(temporary_enter(folder, sizeof folder));
    check_available(UINT64_MAX);
    put("./proc/meminfo", "MemTotal:       32768000 kB\nMemFree:          100000 kB\n"
                          "MemAvailable:    8000000 kB\n");
    check_available(8000000ull * 1024);
    // Version 2: the group has no limit, but its parent has one, and has used some of it.
    put("./proc/self/cgroup", "0::/batch/job\n");
    put("./sys/fs/cgroup/batch/job/memory.max", "max\n");
    check_available(8000000ull * 1024);
    put("./sys/fs/cgroup/batch/memory.max", "5000000000\n");
    put("./sys/fs/cgroup/batch/memory.current", "2000000000\n");
    check_available(3000000000);
    put("./sys/fs/cgroup/batch/memory.stat", "anon 1\nfile 7\ninactive_file 500000000\n");
    check_available(3500000000);
    put("./sys/fs/cgroup/batch/memory.high", "4000000000\n");
    check_available(2500000000);
    put("./sys/fs/cgroup/batch/job/memory.max", "1000000\n");
    put("./sys/fs/cgroup/batch/job/memory.current", "2000000\n");
    check_available(0);
    temporary_leave(folder);
}

// The path is that of the host; a container sees only its own group, as the root.
TEST(version_1_in_a_container)
{
    REQUIRE(temporary_enter(folder, sizeof folder));
    put("./proc/self/cgroup", "12:cpu,cpuacct:/docker/a\n5:memory:/docker/a\n1:name=x:/docker/a\n");
    check_available(UINT64_MAX);
    put("./sys/fs/cgroup/memory/memory.limit_in_bytes", "9223372036854771712\n");
    put("./sys/fs/cgroup/memory/memory.usage_in_bytes", "1000\n");
    CHECK(memory_available_in(".") > UINT64_C(1) << 62);
    put("./sys/fs/cgroup/memory/memory.limit_in_bytes", "2000000\n");
    put("./sys/fs/cgroup/memory/memory.stat", "inactive_file 77\ntotal_inactive_file 400\n");
    check_available(2000000 - 600);
    temporary_leave(folder);
}

TEST(this_machine_leaves_something)
{
    uint64_t available = memory_available(), budget = memory_default_budget();
    CHECK(available > 1 << 20 && budget > 0 && budget < available, "%llu, %llu",
          (unsigned long long)available, (unsigned long long)budget);
}

TEST(what_exceeds_the_budget_is_refused)
{
    struct err err = {0};
    memory_set_budget(1 << 20);
    uint64_t failures = memory_failures();
    CHECK(memory_take(1 << 20) && !memory_take(1) && memory_used() == 1 << 20);
    CHECK(memory_failures() == failures + 1);
    memory_give(1 << 19);
    CHECK(memory_check(1 << 19, "a thing", &err) && memory_used() == 1 << 19);
    CHECK(!memory_check((1 << 19) + 1, "a thing", &err) && err.code == ERR_BUDGET, "%s", err.msg);
    CHECK(strcmp(err.msg, "out of memory for a thing: 512.0 KiB are needed, but 512.0 KiB are left "
                          "of the budget of 1.0 MiB; expected a smaller scene or picture, or a "
                          "larger --memory") == 0,
          "%s", err.msg);
    memory_give(1 << 19);
    memory_set_budget(0);
}

TEST(allocations_come_from_the_budget)
{
    uint64_t left;
    memory_set_budget(100000);
    unsigned char *data = memory_alloc(60000);
    REQUIRE(data);
    for (int i = 0; i < 60000; i += 100)
        CHECK(data[i] == 0);
    CHECK(!memory_alloc(60000) && memory_refused(&left) == 60000 && memory_refused(&left) == 0);
    memory_free(data);
    memory_free(NULL);
    CHECK(memory_used() == 0, "%llu", (unsigned long long)memory_used());
    memory_set_budget(0);
    CHECK(!memory_alloc(PTRDIFF_MAX / 2) && memory_refused(&left) == 0,
          "the system refuses that, no budget");
    CHECK(memory_used() == 0);
}

// A lack of memory of the system and of the budget have different messages.
TEST(errors_say_who_refused)
{
    struct err err = {0};
    memory_set_budget(10);
    CHECK(!memory_take(48));
    err_memory(&err, "a camera", 48);
    CHECK(err.code == ERR_BUDGET && strstr(err.msg, "a camera: 48 bytes are needed, but 10 bytes"),
          "%s", err.msg);
    err_memory(&err, "a camera", 48);
    CHECK(err.code == ERR_SYSTEM, "%s", err.msg);
    memory_set_budget(0);
}

TEST(sizes_are_readable)
{
    static const struct {
        uint64_t bytes;
        const char *text;
    } sizes[] = {{0, "0 bytes"},       {1023, "1023 bytes"},           {1024, "1.0 KiB"},
                 {1048575, "1.0 MiB"}, {UINT64_C(3) << 29, "1.5 GiB"}, {UINT64_MAX, "16.0 EiB"}};
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++)
        CHECK(strcmp(memory_print(sizes[i].bytes).text, sizes[i].text) == 0, "%s",
              memory_print(sizes[i].bytes).text);
}

TEST_MAIN(TEST_CASE(the_least_of_machine_and_groups), TEST_CASE(version_1_in_a_container),
          TEST_CASE(this_machine_leaves_something), TEST_CASE(what_exceeds_the_budget_is_refused),
          TEST_CASE(allocations_come_from_the_budget), TEST_CASE(errors_say_who_refused),
          TEST_CASE(sizes_are_readable))
