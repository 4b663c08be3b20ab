// Every file is verified before it replaces an older one. The tests run the whole program, each
// time in a process of its own, with one bit changed on the way.
#define _GNU_SOURCE // nftw
#include "base/file.h"
#include "base/temporary_folder.h"
#include "cli/program.h"
#include "image/image.h"
#include "test.h"

#include <glob.h>
#include <sys/wait.h>

enum { NO_DRIVER = 69, OUTPUT = 4 };

static const char scene[] =
    "{\"lampyris\": 1, \"materials\": {\"m\": {}}, \"environment\": {\"radiance\": [1, 1, 1]},"
    " \"shapes\": [{\"type\": \"sphere\", \"radius\": 1, \"material\": \"m\"}]}";

struct fault {
    uint64_t file_byte, image_byte;
};

// Messages go to the file "messages". Returns the exit code.
static int run(struct fault fault, const char *const *words)
{
    fflush(NULL);
    pid_t child = fork();
    if (child == 0) {
        char *arguments[32] = {(char *)"lampyris"};
        int count = 1;
        for (; words[count - 1]; count++)
            arguments[count] = (char *)(uintptr_t)words[count - 1];
        if (!freopen("messages", "w", stderr))
            _exit(99);
        file_corrupt_at(fault.file_byte);
        image_corrupt_at(fault.image_byte);
        int code = program_run(count, arguments, NULL);
        fflush(NULL);
        _exit(code);
    }
    int status;
    return waitpid(child, &status, 0) == child && WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

#define RUN(fault, ...) run(fault, (const char *const[]){__VA_ARGS__, "--quiet", NULL})
#define RENDER(fault, ...)                                                                         \
    RUN(fault, "render", "s.json", "--size", "8x8", "--spp", "1", __VA_ARGS__)

static bool holds(const char *path, const char *text)
{
    struct arena arena = {0};
    struct file_bytes bytes;
    bool ok = file_read(&arena, path, 0, &bytes, NULL) &&
              memmem(bytes.data, bytes.size, text, strlen(text));
    arena_finish(&arena);
    return ok;
}

static bool is_old(const char *path)
{
    struct stat status;
    return stat(path, &status) == 0 && status.st_size == 3 && holds(path, "old");
}

static bool enter(char *folder, size_t size)
{
    return temporary_enter(folder, size) && temporary_write("s.json", scene) &&
           mkdir("tmp", 0700) == 0 && setenv("TMPDIR", "tmp", 1) == 0;
}

static void leave(const char *folder)
{
    unsetenv("TMPDIR");
    temporary_leave(folder);
}

TEST(pictures_that_are_encoded_wrongly)
{
    char folder[200];
    REQUIRE(enter(folder, sizeof folder));
    static const char *const names[] = {"a.exr", "a.png"};
    for (int i = 0; i < 2; i++) {
        REQUIRE(temporary_write(names[i], "old"));
        int code = RENDER(((struct fault){.image_byte = 200}), "-o", names[i]);
        if (code == NO_DRIVER) {
            leave(folder);
            SKIP("there is no Vulkan driver");
        }
        CHECK(code == OUTPUT && is_old(names[i]), "%s: exit code %d", names[i], code);
        CHECK(holds("messages", names[i]) && holds("messages", "the decoded file differs"));
    }
    leave(folder);
}

// The fault affects the first file that is written, which is the checkpoint. The other outputs are
// written correctly.
TEST(files_that_are_stored_wrongly)
{
    char folder[200];
    REQUIRE(enter(folder, sizeof folder));
    static const char *const outputs[][2] = {
        {"-o", "a.exr"}, {"-o", "a.png"}, {"--checkpoint", "a.ck"}};
    for (int i = 0; i < 3; i++) {
        const char *path = outputs[i][1];
        bool is_new = i == 2; // an existing checkpoint would be resumed
        REQUIRE(is_new || temporary_write(path, "old"));
        // A checkpoint that is written while rendering may fail with a warning.
        int code =
            is_new ? RENDER(((struct fault){.file_byte = 150}), "--checkpoint", path,
                            "--checkpoint-every", "60", "-o", "b.exr")
                   : RENDER(((struct fault){.file_byte = 150}), outputs[i][0], path, "-o", "b.exr");
        if (code == NO_DRIVER) {
            leave(folder);
            SKIP("there is no Vulkan driver");
        }
        CHECK(code == OUTPUT, "%s: exit code %d", path, code);
        CHECK(is_new ? access(path, F_OK) != 0 : is_old(path), "%s", path);
        CHECK(holds("messages", path) &&
              holds("messages", "the data read back differ from the data written"));
        CHECK(access("b.exr", F_OK) == 0 && unlink("b.exr") == 0, "beside %s", path);
    }
    leave(folder);
}

// The encoder or the disk damages the only requested picture, so it is saved in another folder,
// without compression.
TEST(pictures_are_kept_elsewhere)
{
    char folder[200];
    REQUIRE(enter(folder, sizeof folder));
    int code = RENDER(((struct fault){.file_byte = 150}), "-o", "a.exr");
    if (code == NO_DRIVER) {
        leave(folder);
        SKIP("there is no Vulkan driver");
    }
    CHECK(code == OUTPUT && access("a.exr", F_OK) != 0, "exit code %d", code);
    CHECK(holds("messages", "the picture was saved as tmp/lampyris-"));
    CHECK(RENDER((struct fault){0}, "-o", "a.exr") == 0);
    struct arena arena = {0};
    glob_t found = {0};
    struct image saved, again;
    REQUIRE(glob("tmp/lampyris-*/picture.exr", 0, NULL, &found) == 0 && found.gl_pathc == 1);
    REQUIRE(
        image_read(&(struct image_read_params){.path = found.gl_pathv[0]}, &arena, &saved, NULL) &&
        image_read(&(struct image_read_params){.path = "a.exr"}, &arena, &again, NULL));
    CHECK(memcmp(saved.pixels, again.pixels, 8 * 8 * sizeof *saved.pixels) == 0);
    globfree(&found);
    arena_finish(&arena);
    leave(folder);
}

TEST(difference_pictures)
{
    char folder[200];
    REQUIRE(enter(folder, sizeof folder));
    float pixels[4][3] = {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}, {1, 1, 1}};
    struct image image = {2, 2, pixels};
    REQUIRE(image_write(&(struct image_write_params){.path = "a.exr", .image = &image}, NULL));
    pixels[2][1] = 3;
    REQUIRE(image_write(&(struct image_write_params){.path = "r.exr", .image = &image}, NULL));
    REQUIRE(temporary_write("d.exr", "old") && temporary_write("d.png", "old"));
    static const char *const names[] = {"d.exr", "d.png"};
    for (int i = 0; i < 2; i++) {
        int code = RUN(((struct fault){.image_byte = 100}), "compare", "a.exr", "r.exr",
                       "--difference", names[i]);
        CHECK(code == OUTPUT && is_old(names[i]), "%s: exit code %d", names[i], code);
        code = RUN(((struct fault){.file_byte = 100}), "compare", "a.exr", "r.exr", "--difference",
                   names[i]);
        CHECK(code == OUTPUT && is_old(names[i]), "%s: exit code %d", names[i], code);
        code = RUN((struct fault){0}, "compare", "a.exr", "r.exr", "--difference", names[i]);
        CHECK(code == 0 && !is_old(names[i]), "%s: exit code %d", names[i], code);
    }
    leave(folder);
}

TEST_MAIN(TEST_CASE(pictures_that_are_encoded_wrongly), TEST_CASE(files_that_are_stored_wrongly),
          TEST_CASE(pictures_are_kept_elsewhere), TEST_CASE(difference_pictures))
