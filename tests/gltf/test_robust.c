// Tests truncated, damaged, deep and hostile files: the result is an error within a second, never a
// crash, a hang, or a file read from outside the folder.
#define _GNU_SOURCE // nftw
#include "../base/temporary_folder.h"
#include "base/file.h"
#include "base/memory.h"
#include "gltf_fixture.h"
#include "test.h"

// Checks that a loaded scene is valid, or that the error names the file.
static void check_sound(bool ok, const struct scene *scene, const struct err *err, const char *path,
                        size_t which)
{
    if (ok)
        CHECK(!scene_objection(scene), "%zu: %s", which, scene_objection(scene));
    else
        CHECK((err->code == ERR_INPUT || err->code == ERR_BUDGET) &&
                  strncmp(err->msg, path, strlen(path)) == 0,
              "%zu: code %d: %s", which, (int)err->code, err->msg);
}

// --- cut files -----------------------------------------------------------------------------------

static void check_all_cuts(const char *path, struct bytes whole)
{
    for (size_t size = 0; size < whole.size; size++) {
        // A separate copy, so that the sanitizer detects reads past the end. The NUL is that of
        // file_read.
        struct bytes cut = {malloc(size + 1), size};
        memcpy(cut.data, whole.data, size);
        cut.data[size] = 0;
        struct scene scene;
        struct err err;
        bool ok = load_bytes(&scene, path, cut, &err);
        CHECK(!ok && err.code == ERR_INPUT, "%s cut to %zu bytes: %s", path, size, err.msg);
        scene_finish(&scene);
        free(cut.data);
    }
}

TEST(cut_glb)
{
    struct bytes glb = glb_bytes(sample_json, &sample_binary, sizeof sample_binary);
    check_all_cuts("cut.glb", glb);
    free(glb.data);
}

// Returns the sample as JSON with its buffer in a data URI.
static char *embedded_json(void)
{
    char *uri = data_uri(&sample_binary, sizeof sample_binary);
    char *buffer = malloc(strlen(uri) + 64);
    snprintf(buffer, strlen(uri) + 64, "{'byteLength':136,'uri':'%s'}", uri);
    char *json = replace_text(sample_json, "{'byteLength':136}", buffer);
    free(buffer);
    free(uri);
    return json;
}

TEST(cut_json)
{
    char *json = embedded_json();
    struct bytes text = json_bytes(json);
    check_all_cuts("cut.gltf", text);
    free(text.data);
    free(json);
}

// --- damaged files -------------------------------------------------------------------------------

// Marsaglia 2003, "Xorshift RNGs", which is sufficient for choosing bytes.
static uint32_t next_random(uint32_t *state)
{
    *state ^= *state << 13;
    *state ^= *state >> 17;
    *state ^= *state << 5;
    return *state;
}

static void damage(struct bytes bytes, uint32_t *random)
{
    // Digits and brackets reach more code than arbitrary bytes, most of which cause errors in the
    // parser.
    static const char likely[] = "0123456789-.e[]{},:\"";
    uint32_t count = 1 + next_random(random) % 4;
    for (uint32_t i = 0; i < count; i++) {
        uint8_t *at = &bytes.data[next_random(random) % bytes.size];
        uint32_t choice = next_random(random);
        if (choice % 3 == 0)
            *at ^= (uint8_t)(1u << (choice >> 8) % 8);
        else if (choice % 3 == 1)
            *at = (uint8_t)(choice >> 8);
        else
            *at = (uint8_t)likely[(choice >> 8) % (sizeof likely - 1)];
    }
}

static void check_damaged(const char *path, struct bytes whole, uint32_t rounds)
{
    uint32_t random = 20240229, loaded = 0;
    struct bytes copy = {malloc(whole.size + 1), whole.size};
    for (uint32_t i = 0; i < rounds; i++) {
        memcpy(copy.data, whole.data, whole.size + 1);
        damage(copy, &random);
        struct scene scene;
        struct err err;
        bool ok = load_bytes(&scene, path, copy, &err);
        check_sound(ok, &scene, &err, path, i);
        loaded += ok;
        scene_finish(&scene);
    }
    // Both outcomes must occur, or nothing is tested.
    CHECK(loaded > 0 && loaded < rounds, "%u of %u loaded", loaded, rounds);
    free(copy.data);
}

TEST(damaged_glb)
{
    struct bytes glb = glb_bytes(sample_json, &sample_binary, sizeof sample_binary);
    check_damaged("damaged.glb", glb, 20000);
    free(glb.data);
}

TEST(damaged_json)
{
    char *json = embedded_json();
    struct bytes text = json_bytes(json);
    check_damaged("damaged.gltf", text, 20000);
    free(text.data);
    free(json);
}

// --- memory --------------------------------------------------------------------------------------

TEST(allocation_failures)
{
    struct bytes glb = glb_bytes(sample_json, &sample_binary, sizeof sample_binary);
    for (uint64_t n = 1;; n++) {
        struct scene scene;
        struct err err;
        arena_fail_at(n);
        bool ok = load_bytes(&scene, "test.glb", glb, &err);
        arena_fail_at(0);
        scene_finish(&scene);
        CHECK(ok || err.code == ERR_SYSTEM, "allocation %llu: code %d: %s", (unsigned long long)n,
              (int)err.code, err.msg);
        if (ok || n > 1000) {
            CHECK(n > 10 && n < 1000, "%llu allocations", (unsigned long long)n);
            break;
        }
    }
    free(glb.data);
}

// The file is small, but its many primitives would exceed the budget when decoded.
TEST(memory_budget)
{
    const size_t primitives = 400;
    char *json = malloc(primitives * 200 + 1024);
    char *to = stpcpy(json, "{'asset':{'version':'2.0'},'nodes':[{'mesh':0}],"
                            "'meshes':[{'primitives':[");
    for (size_t i = 0; i < primitives; i++)
        to += sprintf(to, "%s{'attributes':{'POSITION':%zu}}", i ? "," : "", i);
    to = stpcpy(to, "]}],'accessors':[");
    for (size_t i = 0; i < primitives; i++)
        to += sprintf(to, "%s{'componentType':5126,'count':300000,'type':'VEC3'}", i ? "," : "");
    strcpy(to, "]}");
    struct scene scene;
    struct err err;
    bool ok = load_glb(&scene, json, NULL, 0, &err);
    CHECK(!ok && err.code == ERR_BUDGET && strstr(err.msg, "test.glb: nodes[0]: out of memory"),
          "%s", err.msg);
    CHECK(scene.arena.used_bytes < 1 << 20, "nothing was decoded before the sum was known");
    scene_finish(&scene);
    free(json);
}

// The file's bytes in memory count as well: vertices of half the budget do not fit twice.
TEST(memory_budget_counts_the_file)
{
    char json[512];
    const size_t count = FIXTURE_MAX_BYTES / 2 / 12 / 3 * 3;
    snprintf(json, sizeof json,
             "{'asset':{'version':'2.0'},'nodes':[{'mesh':0}],'meshes':[{'primitives':["
             "{'attributes':{'POSITION':0}}]}],'accessors':[{'bufferView':0,'componentType':5126,"
             "'count':%zu,'type':'VEC3'}],'bufferViews':[{'buffer':0,'byteLength':%zu}],"
             "'buffers':[{'byteLength':%zu}]}",
             count, 12 * count, 12 * count);
    float *zeros = calloc(count, 12);
    struct scene scene;
    struct err err;
    bool ok = load_glb(&scene, json, zeros, 12 * count, &err);
    CHECK(!ok && err.code == ERR_BUDGET, "%s", err.msg);
    scene_finish(&scene);
    free(zeros);
}

// --- hierarchies ---------------------------------------------------------------------------------

// Makes a chain of `count` nodes, each translated by 1 along X. The last one has the mesh, and the
// members `last`.
static bool load_chain(struct scene *scene, size_t count, const char *last, struct err *err)
{
    char *json = malloc(count * 64 + 1024);
    char *to = stpcpy(json, "{'asset':{'version':'2.0'},'meshes':[{'primitives':[{'attributes':"
                            "{'POSITION':0}}]}],'accessors':[{'componentType':5126,'count':3,"
                            "'type':'VEC3'}],'nodes':[");
    for (size_t i = 0; i + 1 < count; i++)
        to += sprintf(to, "{'translation':[1,0,0],'children':[%zu]},", i + 1);
    sprintf(to, "{'translation':[1,0,0],'mesh':0%s}]}", last);
    bool ok = load_glb(scene, json, NULL, 0, err);
    free(json);
    return ok;
}

TEST(chain_of_20000_nodes)
{
    const size_t count = 20000;
    struct scene scene;
    struct err err;
    bool ok = load_chain(&scene, count, "", &err);
    CHECK(ok, "%s", err.msg);
    CHECK(ok && scene.instance_count == 1 && scene.instances[0].transform[0][3] == (double)count);
    scene_finish(&scene);
}

TEST(cycle_of_20000_nodes)
{
    struct scene scene;
    struct err err;
    bool ok = load_chain(&scene, 20000, ",'children':[0]", &err);
    CHECK(!ok && strstr(err.msg, "is its own ancestor"), "%s", err.msg);
    scene_finish(&scene);
}

// Each node has the next one as a child twice, which would give 2^40 paths.
TEST(dag_of_40_levels)
{
    char json[4096] = "{'asset':{'version':'2.0'},'nodes':[";
    for (int i = 0; i < 40; i++)
        sprintf(json + strlen(json), "{'children':[%d,%d]},", i + 1, i + 1);
    strcat(json, "{}]}");
    struct scene scene;
    struct err err;
    bool ok = load_glb(&scene, json, NULL, 0, &err);
    CHECK(!ok && strstr(err.msg, "nodes[0].children[1]: node 1 is already a child"), "%s", err.msg);
    scene_finish(&scene);
}

// --- files ---------------------------------------------------------------------------------------

// A folder with inside/ for the scene, and a buffer outside it.
struct folder {
    char path[64];
};

static void path_in(const struct folder *folder, const char *name, char out[160])
{
    snprintf(out, 160, "%s/%s", folder->path, name);
}

static void write_in(const struct folder *folder, const char *name, const void *data, size_t size)
{
    char path[160];
    path_in(folder, name, path);
    FILE *file = fopen(path, "wb");
    CHECK(file && fwrite(data, 1, size, file) == size, "%s", path);
    if (file)
        fclose(file);
}

static void link_in(const struct folder *folder, const char *name, const char *target)
{
    char path[160];
    path_in(folder, name, path);
    CHECK(symlink(target, path) == 0, "%s", path);
}

static bool folder_make(struct folder *folder)
{
    if (!temporary_enter(folder->path, sizeof folder->path))
        return false;
    char path[160];
    path_in(folder, "inside", path);
    mkdir(path, 0700);
    path_in(folder, "inside/sub", path);
    mkdir(path, 0700);
    write_in(folder, "inside/data.bin", &sample_binary, sizeof sample_binary);
    write_in(folder, "inside/a b.bin", &sample_binary, sizeof sample_binary);
    write_in(folder, "inside/sub/data.bin", &sample_binary, sizeof sample_binary);
    write_in(folder, "outside.bin", &sample_binary, sizeof sample_binary);
    link_in(folder, "inside/escape.bin", "../outside.bin");
    link_in(folder, "inside/alias.bin", "data.bin");
    link_in(folder, "inside/null", "/dev/zero");
    path_in(folder, "inside/pipe.bin", path);
    return mkfifo(path, 0600) == 0;
}

// Removes the folder. It may contain only the entries of folder_make() and the scene.
static void folder_remove(const struct folder *folder)
{
    CHECK(temporary_entries(".") == 2 && temporary_entries("inside") == 8 &&
              temporary_entries("inside/sub") == 1,
          "%s", folder->path);
    temporary_leave(folder->path);
}

static bool load_with_uri(const struct folder *folder, const char *uri, bool allow_outside,
                          struct scene *scene, struct err *err)
{
    char buffer[256], path[160];
    snprintf(buffer, sizeof buffer, "{'byteLength':136,'uri':'%s'}", uri);
    char *json = replace_text(sample_json, "{'byteLength':136}", buffer);
    struct bytes text = json_bytes(json);
    write_in(folder, "inside/scene.gltf", text.data, text.size);
    free(text.data);
    free(json);
    path_in(folder, "inside/scene.gltf", path);
    *scene = empty_scene(path);
    *err = (struct err){0};
    const struct scene_load_params params = {.path = path, .allow_outside_paths = allow_outside};
    return load_gltf(scene, &params, err);
}

static void check_uri(const struct folder *folder, const char *uri, bool allow_outside,
                      bool expected)
{
    struct scene scene;
    struct err err;
    bool ok = load_with_uri(folder, uri, allow_outside, &scene, &err);
    CHECK(ok == expected, "%s: %s", uri, err.msg);
    CHECK(ok ? scene.mesh_count == 1 : err.code == ERR_INPUT && strstr(err.msg, ": buffers[0]"),
          "%s: %s", uri, err.msg);
    scene_finish(&scene);
}

TEST(buffer_files)
{
    struct folder folder;
    bool have_folder = folder_make(&folder);
    CHECK(have_folder);
    if (!have_folder)
        return;
    alarm(60); // opening the pipe in the wrong mode would block forever
    char absolute[160], file_uri[200];
    path_in(&folder, "outside.bin", absolute);
    snprintf(file_uri, sizeof file_uri, "file://%s", absolute);

    check_uri(&folder, "data.bin", false, true);
    check_uri(&folder, "./data.bin", false, true);
    check_uri(&folder, "sub/data.bin", false, true);
    check_uri(&folder, "a%20b.bin", false, true);
    check_uri(&folder, "d%61ta.bin", false, true);
    check_uri(&folder, "alias.bin", false, true);

    check_uri(&folder, "missing.bin", false, false);
    check_uri(&folder, "../outside.bin", false, false);
    check_uri(&folder, "sub/../../outside.bin", false, false);
    check_uri(&folder, "%2e%2e/outside.bin", false, false);
    check_uri(&folder, "%2E%2E%2Foutside.bin", false, false);
    check_uri(&folder, "escape.bin", false, false);
    check_uri(&folder, "null", false, false);
    check_uri(&folder, "pipe.bin", false, false);
    check_uri(&folder, "sub", false, false);
    check_uri(&folder, "data.bin%00", false, false);
    check_uri(&folder, "data.bin%4", false, false);
    check_uri(&folder, "data.bin%zz", false, false);
    check_uri(&folder, absolute, false, false);
    check_uri(&folder, file_uri, false, false);
    check_uri(&folder, "http://example.org/data.bin", false, false);
    check_uri(&folder, "/dev/zero", false, false);

    check_uri(&folder, "data.bin", true, true);
    check_uri(&folder, "../outside.bin", true, true);
    check_uri(&folder, "%2e%2e/outside.bin", true, true);
    check_uri(&folder, "a%20b.bin", true, true);
    check_uri(&folder, "escape.bin", true, true);
    check_uri(&folder, absolute, true, true);
    check_uri(&folder, "/dev/zero", true, false);
    check_uri(&folder, "pipe.bin", true, false);
    check_uri(&folder, "sub", true, false);
    check_uri(&folder, "data.bin%00", true, false);
    check_uri(&folder, "data.bin%", true, false);
    alarm(0);
    folder_remove(&folder);
}

TEST(cut_buffer_file)
{
    struct folder folder;
    bool have_folder = folder_make(&folder);
    CHECK(have_folder);
    if (!have_folder)
        return;
    for (size_t size = 0; size <= sizeof sample_binary; size++) {
        write_in(&folder, "inside/data.bin", &sample_binary, size);
        check_uri(&folder, "alias.bin", false, size == sizeof sample_binary);
    }
    folder_remove(&folder);
}

// The hash covers all files of the scene.
TEST(hash_covers_buffer_files)
{
    struct folder folder;
    bool have_folder = folder_make(&folder);
    CHECK(have_folder);
    if (!have_folder)
        return;
    struct sample_binary changed = sample_binary;
    changed.normals[0][0] = 1;
    struct scene scene;
    struct err err;
    uint64_t hashes[2];
    for (int i = 0; i < 2; i++) {
        write_in(&folder, "inside/data.bin", i ? &changed : &sample_binary, sizeof sample_binary);
        CHECK(load_with_uri(&folder, "data.bin", false, &scene, &err), "%s", err.msg);
        hashes[i] = scene.hash;
        scene_finish(&scene);
    }
    CHECK(hashes[0] != hashes[1]);
    folder_remove(&folder);
}

TEST(buffer_error_names_both_files)
{
    struct folder folder;
    bool have_folder = folder_make(&folder);
    CHECK(have_folder);
    if (!have_folder)
        return;
    struct scene scene;
    struct err err;
    CHECK(!load_with_uri(&folder, "missing.bin", false, &scene, &err));
    CHECK(strstr(err.msg, "scene.gltf: buffers[0].uri: ") && strstr(err.msg, "missing.bin"), "%s",
          err.msg);
    scene_finish(&scene);
    folder_remove(&folder);
}

TEST_MAIN(TEST_CASE(cut_glb), TEST_CASE(cut_json), TEST_CASE(damaged_glb), TEST_CASE(damaged_json),
          TEST_CASE(allocation_failures), TEST_CASE(memory_budget),
          TEST_CASE(memory_budget_counts_the_file), TEST_CASE(chain_of_20000_nodes),
          TEST_CASE(cycle_of_20000_nodes), TEST_CASE(dag_of_40_levels), TEST_CASE(buffer_files),
          TEST_CASE(cut_buffer_file), TEST_CASE(hash_covers_buffer_files),
          TEST_CASE(buffer_error_names_both_files))
