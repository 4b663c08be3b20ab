#define _GNU_SOURCE // nftw of temporary_folder.h
#include "viewer/core/shader_compile.h"

#include "base/temporary_folder.h"
#include "render/kernels.h"
#include "test.h"

#include <fcntl.h>
#include <limits.h>
#include <sys/stat.h>

static const char good[] = "#version 450\n"
                           "#extension GL_GOOGLE_include_directive : require\n"
                           "layout(local_size_x = 1) in;\n"
                           "layout(binding = 0) buffer data { uint word; };\n"
                           "#include \"lib/value.glsl\"\n"
                           "void main()\n{\n    word = VALUE;\n}\n";

struct kernels {
    char folder[256];
    struct shader_unit units[3];
    struct shader_result results[3];
    char errors[1024];
    atomic_bool is_cancelled;
};

static void write_file(const char *path, const char *text)
{
    if (!temporary_write(path, text))
        abort();
    // Sets old modification times, because a file as recent as the run may have been read before
    // its change.
    const struct timespec times[2] = {{.tv_sec = 1000000000}, {.tv_sec = 1000000000}};
    utimensat(AT_FDCWD, path, times, 0);
}

static bool compile(struct kernels *k, struct err *err)
{
    const struct shader_job job = {
        .folder = k->folder,
        .ballot = true,
        .units = k->units,
        .count = 3,
        .is_cancelled = &k->is_cancelled,
    };
    bool ok = shader_compile(&job, k->results, k->errors, sizeof k->errors, err);
    for (int i = 0; i < 3; i++) {
        if (k->results[i].outcome != SHADER_COMPILED)
            continue;
        free(k->units[i].files);
        k->units[i] = k->results[i].unit;
    }
    return ok;
}

static void set_up(struct kernels *k)
{
    *k = (struct kernels){0};
    if (!temporary_enter(k->folder, sizeof k->folder) || mkdir("lib", 0700) != 0)
        abort();
    static const char *const names[] = {"one", "two", "three"};
    static const char *const files[] = {"one.comp", "two.comp", "three.comp"};
    for (int i = 0; i < 3; i++) {
        k->units[i].name = names[i];
        write_file(files[i], good);
    }
    write_file("two.comp", "#version 450\nlayout(local_size_x = 1) in;\nvoid main() {}\n");
    write_file("lib/value.glsl", "#define VALUE 7\n");
}

static void clean_up(struct kernels *k)
{
    for (int i = 0; i < 3; i++)
        free(k->units[i].files);
    temporary_leave(k->folder);
}

static void free_code(struct kernels *k)
{
    for (int i = 0; i < 3; i++)
        free(k->results[i].code);
}

// Returns a word such as "SUC": which kernels were skipped as unchanged, were compiled, or failed.
static const char *outcomes(const struct kernels *k)
{
    static char text[4];
    for (int i = 0; i < 3; i++)
        text[i] = "SCF"[k->results[i].outcome];
    return text;
}

TEST(only_what_has_changed_is_compiled)
{
    struct kernels k;
    struct err err = {0};
    set_up(&k);
    CHECK(compile(&k, &err) && strcmp(outcomes(&k), "CCC") == 0, "%s %s", outcomes(&k), err.msg);
    for (int i = 0; i < 3; i++)
        CHECK(k.results[i].code && k.results[i].code->words[0] == 0x07230203, "%d", i);
    free_code(&k);
    CHECK(compile(&k, &err) && strcmp(outcomes(&k), "SSS") == 0, "%s", outcomes(&k));
    write_file("lib/value.glsl", "#define VALUE 8\n");
    CHECK(compile(&k, &err) && strcmp(outcomes(&k), "CSC") == 0, "%s", outcomes(&k));
    free_code(&k);
    write_file("lib/value.glsl", "#define VALUE 8\n"); // the same content
    CHECK(compile(&k, &err) && strcmp(outcomes(&k), "SSS") == 0, "%s", outcomes(&k));
    clean_up(&k);
}

TEST(faults_have_file_and_line)
{
    struct kernels k;
    struct err err = {0};
    set_up(&k);
    CHECK(compile(&k, &err), "%s", err.msg);
    free_code(&k);
    write_file("lib/value.glsl", "\n\nuint x = missing;\n#define VALUE 7\n");
    write_file("two.comp", "#version 450\n#include \"lib/none.glsl\"\n");
    CHECK(!compile(&k, &err) && strcmp(outcomes(&k), "FFF") == 0, "%s", outcomes(&k));
    CHECK(err.code == ERR_INPUT, "%d %s", err.code, err.msg);
    const char *once = strstr(k.errors, "lib/value.glsl:3: 'missing' : undeclared identifier\n");
    CHECK(once && !strstr(strchr(once, '\n'), "'missing'"), "%s", k.errors);
    CHECK(!strstr(k.errors, "terminated"), "%s", k.errors);
    CHECK(strstr(k.errors, "two.comp:2: "), "%s", k.errors);
    CHECK(!strstr(k.errors, k.folder) && !strstr(k.errors, "ERROR"), "%s", k.errors);
    // The kernel's former source is restored, so it is correct again, and is found in the cache.
    write_file("lib/value.glsl", "#define VALUE 7\n");
    CHECK(!compile(&k, &err) && strcmp(outcomes(&k), "SFS") == 0, "%s", outcomes(&k));
    clean_up(&k);
}

TEST(it_can_be_stopped)
{
    struct kernels k;
    struct err err = {0};
    set_up(&k);
    atomic_store(&k.is_cancelled, true);
    CHECK(!compile(&k, &err) && err.code == ERR_STOPPED, "%d %s", err.code, err.msg);
    clean_up(&k);
}

TEST(what_cannot_be_is_said)
{
    struct kernels k;
    set_up(&k);
    CHECK(!shader_why_not(k.folder), "%s", shader_why_not(k.folder));
    char none[PATH_MAX + 8];
    snprintf(none, sizeof none, "%s/none", k.folder);
    CHECK(shader_why_not(none) && strstr(shader_why_not(none), "--shaders"), " ");
    char *path = strdup(getenv("PATH"));
    setenv("PATH", k.folder, 1);
    CHECK(shader_why_not(k.folder) && strstr(shader_why_not(k.folder), "glslangValidator"), " ");
    struct err err = {0};
    CHECK(!compile(&k, &err) && err.code == ERR_SYSTEM, "%d %s", err.code, err.msg);
    CHECK(strstr(err.msg, "glslangValidator"), "%s", err.msg);
    setenv("PATH", path, 1);
    free(path);
    clean_up(&k);
}

// The build's sources give the build's code, because the arguments of the compiler are the same.
TEST(the_builds_own_code)
{
    for (int ballot = 0; ballot < 2; ballot++) {
        struct kernel_code built = kernel_code(KERNEL_shade_miss, ballot);
        atomic_bool is_cancelled = false;
        struct shader_unit unit = {.name = built.name};
        struct shader_result result;
        char errors[1024], folder[PATH_MAX];
        struct err err = {0};
        snprintf(folder, sizeof folder, "%s/shaders", getenv("LAMPYRIS_SOURCE_ROOT"));
        const struct shader_job job = {folder, ballot, &unit, 1, &is_cancelled};
        REQUIRE(shader_compile(&job, &result, errors, sizeof errors, &err), "%s", err.msg);
        CHECK(result.code->bytes == built.bytes &&
                  memcmp(result.code->words, built.spirv, built.bytes) == 0,
              "%zu and %zu bytes", result.code->bytes, built.bytes);
        free(result.code);
        free(result.unit.files);
    }
}

TEST_MAIN(TEST_CASE(only_what_has_changed_is_compiled), TEST_CASE(faults_have_file_and_line),
          TEST_CASE(it_can_be_stopped), TEST_CASE(what_cannot_be_is_said),
          TEST_CASE(the_builds_own_code))
