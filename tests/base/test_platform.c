// Tests the functions of base/ that depend on the system: files, folders, locks and processes.
#include "test.h"

#include "base/clock.h"
#include "base/file.h"
#include "base/file_handle.h"
#include "base/file_inputs.h"
#include "base/file_lock.h"
#include "base/memory.h"
#include "base/process.h"
#include "base/system.h"

// "ä", "→" and a character outside the Basic Multilingual Plane, as in users' file names.
#define NAME "\xc3\xa4\xe2\x86\x92\xf0\x9f\x90\x9b.txt"

static struct arena arena;
static char *folder; // the folder of the current test, created before it and empty afterwards

static const char *in_folder(const char *name)
{
    return arena_printf(&arena, "%s/%s", folder, name);
}

static void begin(void)
{
    folder = folder_create_temporary();
    if (!folder) {
        fprintf(stderr, "no temporary folder\n");
        exit(1);
    }
}

static void end(void)
{
    CHECK(folder_remove(folder), "something was left in it");
    free(folder);
    arena_finish(&arena);
}

static bool holds(const char *path, const char *text)
{
    struct file_bytes bytes = {0};
    return file_read(&arena, path, 0, &bytes, NULL) && bytes.size == strlen(text) &&
           memcmp(bytes.data, text, bytes.size) == 0;
}

TEST(files_are_replaced_whole)
{
    begin();
    const char *path = in_folder(NAME);
    struct err err = {0};
    CHECK(file_write_atomic(path, "first", 5, &err), "%s", err.msg);
    struct file_writer writer;
    REQUIRE(file_writer_open(&writer, path, &err), "%s", err.msg);
    CHECK(file_writer_write(&writer, "second\n", 7, &err));
    CHECK(holds(path, "first"));
    CHECK(file_writer_commit(&writer, &err), "%s", err.msg);
    CHECK(holds(path, "second\n"));
    REQUIRE(file_writer_open(&writer, path, &err));
    CHECK(file_writer_write(&writer, "third", 5, &err));
    file_writer_finish(&writer);
    CHECK(holds(path, "second\n"));
    file_corrupt_at(3);
    CHECK(!file_write_atomic(path, "fourth", 6, &err) && err.code == ERR_OUTPUT);
    CHECK(holds(path, "second\n"));
    CHECK(file_remove(path) && !file_exists(path));
    end();
}

// A process that reads a file keeps its content, and does not prevent its replacement.
TEST(a_file_that_is_read_can_be_replaced)
{
    begin();
    const char *path = in_folder("read.txt");
    struct err err = {0};
    char bytes[8] = "";
    CHECK(file_write_atomic(path, "old", 3, &err), "%s", err.msg);
    const int handle = file_handle_open(path);
    REQUIRE(handle >= 0);
    CHECK(file_write_atomic(path, "newer", 5, &err), "%s", err.msg);
    CHECK(file_handle_read(handle, bytes, sizeof bytes) == 3 && strcmp(bytes, "old") == 0, "%s",
          bytes);
    CHECK(file_handle_close(handle) && holds(path, "newer"));
    CHECK(file_remove(path));
    end();
}

TEST(statuses)
{
    begin();
    const char *path = in_folder(NAME);
    struct file_status status, other;
    CHECK(!file_status(path, &status) && !file_exists(path) && !file_is_special(path));
    const uint64_t before_ns = clock_wall_ns();
    CHECK(file_write_atomic(path, "12345", 5, NULL));
    REQUIRE(file_status(path, &status));
    CHECK(status.kind == FILE_REGULAR && status.size == 5);
    CHECK(status.changed_ns + UINT64_C(3000000000) > before_ns); // FAT has time steps of 2 s
    CHECK(status.changed_ns < clock_wall_ns() + UINT64_C(3000000000));
    CHECK(file_is_writable(path) && !file_is_link(path) && file_is_regular(path));
    char *real = file_real_path(path);
    REQUIRE(real);
    CHECK(strcmp(path_name(real), NAME) == 0 && file_is_same(real, path), "%s", real);
    REQUIRE(file_status(real, &other));
    CHECK(file_status_same(&status, &other));
    free(real);
    REQUIRE(file_status(folder, &other));
    CHECK(other.kind == FILE_FOLDER && !file_status_same(&status, &other));
    CHECK(file_touch(path) && file_remove(path) && !file_remove(path));
    end();
}

TEST(messages_say_what_is_missing)
{
    begin();
    struct file_bytes bytes;
    struct err err = {0};
    CHECK(!file_read(&arena, in_folder("no.txt"), 0, &bytes, &err) && err.is_missing);
    err = (struct err){0};
    CHECK(!file_read(&arena, folder, 0, &bytes, &err) && strstr(err.msg, "is a folder"), "%s",
          err.msg);
    CHECK(!file_write_atomic(in_folder("no/file.txt"), "", 0, &err) && err.code == ERR_OUTPUT);
    CHECK(!file_write_atomic(folder, "", 0, &err) && strstr(err.msg, "is a folder"), "%s", err.msg);
    end();
}

TEST(folders)
{
    begin();
    const char *below = in_folder("below");
    struct err err = {0};
    unsigned seen = 0;
    CHECK(file_make_folder(below, &err) && file_make_folder(below, &err), "%s", err.msg);
    CHECK(file_write_atomic(in_folder(NAME), "", 0, &err), "%s", err.msg);
    struct folder_reader *reader = folder_open(folder);
    REQUIRE(reader);
    for (const char *name; (name = folder_next(reader));)
        seen += strcmp(name, "below") == 0 ? 1 : strcmp(name, NAME) == 0 ? 16 : 256;
    folder_close(reader);
    CHECK(seen == 17, "%u", seen);
    CHECK(!folder_open(in_folder("no")));
    CHECK(!folder_remove(folder)); // the folder is not empty
    CHECK(file_remove(in_folder(NAME)) && folder_remove(below));
    uint64_t space = 0;
    CHECK(file_system_space(folder, &space) && space > 0);
    end();
}

TEST(references_stay_in_their_folder)
{
    begin();
    struct err err = {0};
    const struct file_reference reference = {.folder = folder};
    CHECK(file_write_atomic(in_folder("a.txt"), "a", 1, &err), "%s", err.msg);
    const char *path = file_resolve(&arena, &reference, "a.txt", &err);
    CHECK(path && holds(path, "a"), "%s", err.msg);
    CHECK(!file_resolve(&arena, &reference, "../a.txt", &err));
    CHECK(!file_resolve(&arena, &reference, "/a.txt", &err));
    CHECK(!file_resolve(&arena, &reference, "x/../../a.txt", &err));
#ifdef _WIN32
    CHECK(!file_resolve(&arena, &reference, "..\\a.txt", &err) && strstr(err.msg, ".."), "%s",
          err.msg);
    CHECK(!file_resolve(&arena, &reference, "C:\\a.txt", &err) && strstr(err.msg, "absolute"), "%s",
          err.msg);
#endif
    CHECK(file_remove(in_folder("a.txt")));
    end();
}

TEST(one_holder_has_a_lock)
{
    begin();
    struct file_lock first, second;
    struct err err = {0};
    REQUIRE(file_lock_take(&first, in_folder(NAME), &err), "%s", err.msg);
    CHECK(!file_lock_take(&second, in_folder(NAME), &err) && strstr(err.msg, "another run"), "%s",
          err.msg);
    CHECK(file_lock_take(&second, in_folder("other"), &err), "%s", err.msg);
    file_lock_release(&second);
    file_lock_release(&first);
    CHECK(file_lock_take(&first, in_folder(NAME), &err), "%s", err.msg);
    file_lock_release(&first);
    end(); // no process remains
}

TEST(inputs_are_not_replaced)
{
    begin();
    struct file_inputs inputs;
    struct err err = {0};
    CHECK(file_write_atomic(in_folder(NAME), "in", 2, &err), "%s", err.msg);
    file_inputs_begin(&inputs);
    CHECK(holds(in_folder(NAME), "in"));
    CHECK(!file_write_atomic(in_folder("./" NAME), "out", 3, &err) && err.code == ERR_USAGE);
    file_inputs_end(&inputs);
    CHECK(holds(in_folder(NAME), "in") && file_remove(in_folder(NAME)));
    end();
}

TEST(temporary_streams)
{
    FILE *file = file_stream_temporary();
    char text[8] = "";
    uint64_t size = 0;
    REQUIRE(file);
    fputs("a\nb", file);
    fflush(file);
    CHECK(file_stream_size(file, &size) && size == 3, "%llu", (unsigned long long)size);
    CHECK(fread(text, 1, sizeof text, file) == 3 && strcmp(text, "a\nb") == 0);
    fclose(file);
}

// --- the machine and other processes -------------------------------------------------------------

TEST(the_machine_is_known)
{
    char processor[128], name[128], own[4096];
    system_processor_name(processor, sizeof processor);
    system_name(name, sizeof name);
    printf("%s; %s; %u processors\n", processor, name, system_processors());
    CHECK(processor[0] && name[0] && system_processors() >= 1);
    CHECK(process_own_path(own, sizeof own) && file_is_executable(own), "%s", own);
    const uint64_t all = memory_physical(), peak = memory_peak();
    CHECK(all > UINT64_C(64) << 20 && memory_available() > 0);
    CHECK(memory_resident() > 0 && peak >= memory_resident() / 2 && peak < all);
    void *block = memory_alloc(1000);
    CHECK(block && memory_used() >= 1000);
    memory_free(block);
    CHECK(memory_used() == 0);
}

static char *own_name; // argv[0]

static bool run(const char *argument, const char *input, char *printed, size_t size)
{
    const char *const arguments[] = {own_name, "--child", argument, NULL};
    FILE *in = file_stream_temporary(), *out = file_stream_temporary();
    struct process process;
    struct err err = {0};
    bool is_well = false;
    fputs(input, in);
    fflush(in);
    rewind(in);
    const struct process_params params = {.arguments = arguments, .in = in, .out = out};
    CHECK(process_start(&process, &params, &err), "%s", err.msg);
    process_wait(&process, &is_well);
    CHECK(process.handle == 0);
    uint64_t bytes = 0;
    file_stream_size(out, &bytes);
    printed[fread(printed, 1, size - 1, out)] = '\0';
    fclose(in);
    fclose(out);
    return is_well;
}

static int child(const char *argument)
{
    char line[64];
    while (strcmp(argument, "sleep") == 0)
        clock_sleep(1);
    fputs(argument, stdout);
    while (fgets(line, sizeof line, stdin))
        fputs(line, stdout);
    return strcmp(argument, "fail") == 0;
}

TEST(other_programs_run)
{
    char printed[256];
    static const char *const odd[] = {"plain",       "",         "a b", "\"", "\\",
                                      "a\\\"b \\\\", "\xc3\xa4", "*"};
    for (size_t i = 0; i < sizeof odd / sizeof *odd; i++) {
        CHECK(run(odd[i], ":in", printed, sizeof printed));
        CHECK(strncmp(printed, odd[i], strlen(odd[i])) == 0 &&
                  strcmp(printed + strlen(odd[i]), ":in") == 0,
              "%s is not %s", printed, odd[i]);
    }
    CHECK(!run("fail", "", printed, sizeof printed));
    const char *const missing[] = {"lampyris-has-no-such-program", NULL};
    struct process process;
    struct err err = {0};
    CHECK(!process_start(&process, &(struct process_params){.arguments = missing, .out = stdout},
                         &err) &&
              err.code == ERR_SYSTEM && !program_is_installed(missing[0]),
          "%s", err.msg);
    process_kill(&process);
}

TEST(other_programs_can_be_ended)
{
    const char *const arguments[] = {own_name, "--child", "sleep", NULL};
    struct process process;
    bool is_well;
    REQUIRE(process_start(&process, &(struct process_params){.arguments = arguments, .out = stdout},
                          NULL));
    CHECK(!process_has_ended(&process, &is_well));
    process_kill(&process);
    CHECK(process.handle == 0);
}

int main(int argc, char **argv)
{
    static const struct test_case cases[] = {
        TEST_CASE(files_are_replaced_whole),
        TEST_CASE(a_file_that_is_read_can_be_replaced),
        TEST_CASE(statuses),
        TEST_CASE(messages_say_what_is_missing),
        TEST_CASE(folders),
        TEST_CASE(references_stay_in_their_folder),
        TEST_CASE(one_holder_has_a_lock),
        TEST_CASE(inputs_are_not_replaced),
        TEST_CASE(temporary_streams),
        TEST_CASE(the_machine_is_known),
        TEST_CASE(other_programs_run),
        TEST_CASE(other_programs_can_be_ended),
    };
    process_begin(&argc, &argv);
    own_name = argv[0];
    if (argc == 3 && strcmp(argv[1], "--child") == 0)
        return child(argv[2]);
    return test_run(cases, sizeof cases / sizeof cases[0], argc, argv);
}
