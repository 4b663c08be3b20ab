// Helpers for the tests of mesh loaders: a temporary folder, files in it, captured warnings, and
// systematic damage to files.
#ifndef LAMPYRIS_TESTS_MESH_FILES_H
#define LAMPYRIS_TESTS_MESH_FILES_H

// Must be included first, so that nftw is declared.
#define _XOPEN_SOURCE 700
#define _DEFAULT_SOURCE

#include "base/log.h"
#include "base/memory.h"
#include "scene/core/scene.h"
#include "test.h"

#include <ftw.h>
#include <unistd.h>

static char folder[64];    // exists while main runs
static unsigned warnings;  // number since load_checked() or the start
static char warning[1024]; // the last warning
static char path_buffer[512];

static inline void capture_warning(void *context, enum log_level level, const char *message)
{
    (void)context, (void)level;
    warnings++;
    snprintf(warning, sizeof warning, "%s", message);
}

static inline int remove_entry(const char *path, const struct stat *status, int type,
                               struct FTW *where)
{
    (void)status, (void)type, (void)where;
    return remove(path);
}

static inline void remove_folder(void)
{
    nftw(folder, remove_entry, 8, FTW_DEPTH | FTW_PHYS);
}

// Creates the folder, which is removed at exit, and captures warnings. Returns false if it cannot
// be created.
static inline bool begin_mesh_tests(void)
{
    const char *parent = getenv("TMPDIR");
    snprintf(folder, sizeof folder, "%s/lampyris-XXXXXX",
             parent && strlen(parent) < 32 ? parent : "/tmp");
    if (!mkdtemp(folder))
        return false;
    atexit(remove_folder);
    log_configure(LOG_WARN, capture_warning, NULL);
    return true;
}

// Returns the path of a file in the folder, valid until the next call.
static inline const char *in_folder(const char *name)
{
    snprintf(path_buffer, sizeof path_buffer, "%s/%s", folder, name);
    return path_buffer;
}

static inline const char *write_bytes(const char *name, const void *data, size_t size)
{
    const char *path = in_folder(name);
    // Some file systems flush a file when its content is replaced, which is slow if it is done a
    // thousand times.
    remove(path);
    FILE *file = fopen(path, "wb");
    CHECK(file && fwrite(data, 1, size, file) == size, "cannot write %s", path);
    if (file)
        fclose(file);
    return path;
}

static inline const char *write_text(const char *name, const char *text)
{
    return write_bytes(name, text, strlen(text));
}

// Returns the path of an external data file, or NULL if it is missing.
static inline const char *data_file(const char *name)
{
    const char *data = getenv("LAMPYRIS_DATA"), *root = getenv("LAMPYRIS_SOURCE_ROOT");
    if (data)
        snprintf(path_buffer, sizeof path_buffer, "%s/%s", data, name);
    else
        snprintf(path_buffer, sizeof path_buffer, "%s/../shared/data/%s", root ? root : ".", name);
    return access(path_buffer, R_OK) == 0 ? path_buffer : NULL;
}

// Checks that every index is below its bound, every float is finite, and every normal has length 1
// or 0.
static inline void check_mesh(const struct scene *scene, const struct mesh *mesh)
{
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        for (int c = 0; c < 3; c++)
            REQUIRE(mesh->indices[t][c] < mesh->vertex_count, "triangle %u", t);
        REQUIRE(!mesh->triangle_material || mesh->triangle_material[t] < scene->material_count,
                "triangle %u", t);
    }
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        const float *p = mesh->positions[v];
        REQUIRE(isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2]), "vertex %u", v);
        if (!mesh->normals)
            continue;
        const float *n = mesh->normals[v];
        double square = (double)n[0] * n[0] + (double)n[1] * n[1] + (double)n[2] * n[2];
        REQUIRE(square == 0.0 || fabs(square - 1.0) < 1e-6, "vertex %u: %g", v, square);
    }
    REQUIRE(mesh->material < scene->material_count, "material %u", mesh->material);
}

static inline void check_triangle(const struct mesh *mesh, uint32_t triangle, uint32_t a,
                                  uint32_t b, uint32_t c)
{
    REQUIRE(triangle < mesh->triangle_count, "%u of %u", triangle, mesh->triangle_count);
    const uint32_t *corners = mesh->indices[triangle];
    CHECK(corners[0] == a && corners[1] == b && corners[2] == c, "triangle %u: %u %u %u", triangle,
          corners[0], corners[1], corners[2]);
}

// Corners of a triangle of about a metre in UTM coordinates, of which single precision keeps only
// multiples of a half.
static const double far_corners[3][3] = {
    {500000.0625, 5400000.123, 100.1},
    {500001.0625, 5400000.123, 100.1},
    {500000.0625, 5400001, 100},
};

static inline void check_far_corners(const struct mesh *mesh)
{
    REQUIRE(mesh->vertex_count == 3 && mesh->exact_positions, "%u", mesh->vertex_count);
    for (int v = 0; v < 3; v++)
        for (int c = 0; c < 3; c++)
            CHECK(mesh->exact_positions[v][c] == far_corners[v][c] &&
                      mesh->positions[v][c] == (float)far_corners[v][c],
                  "vertex %d, %c: %.17g", v, 'x' + c, mesh->exact_positions[v][c]);
    CHECK(warnings == 0, "%s", warning);
}

typedef bool (*mesh_load_fn)(struct scene *scene, const char *path, struct err *err);

// Counts warnings from now on, and loads a file that must be valid; the caller finishes the scene.
// Returns a zero mesh on failure.
static inline struct mesh load_checked(mesh_load_fn load, const char *path, struct scene *scene)
{
    struct err err = {0};
    *scene = (struct scene){0};
    warnings = 0;
    bool is_loaded = load(scene, path, &err);
    CHECK(is_loaded, "%s", err.msg);
    if (!is_loaded)
        return (struct mesh){0};
    check_mesh(scene, &scene->meshes[0]);
    return scene->meshes[0];
}

// Checks that the file is refused with ERR_INPUT and a message that contains `expected`.
static inline void check_mesh_refused(mesh_load_fn load, const char *path, const char *expected)
{
    struct scene scene = {0};
    struct err err = {0};
    bool is_loaded = load(&scene, path, &err);
    CHECK(!is_loaded && err.code == ERR_INPUT && strstr(err.msg, expected),
          "expected '%s', got '%s'", expected, err.msg);
    scene_finish(&scene);
}

// Tries every memory limit from nothing to enough: loading must succeed or fail with an error about
// memory.
static inline void check_memory_limits(mesh_load_fn load, const char *path)
{
    unsigned failures = 0;
    bool is_loaded = false;
    for (size_t limit = 1; limit < 100000 && !is_loaded; limit += 16) {
        struct scene scene = {0};
        struct err err = {0};
        memory_set_budget(memory_used() + limit);
        is_loaded = load(&scene, path, &err);
        CHECK(is_loaded || err.code == ERR_BUDGET, "limit %zu: %s", limit, err.msg);
        memory_set_budget(0);
        failures += !is_loaded;
        scene_finish(&scene);
    }
    CHECK(is_loaded && failures > 10, "%u", failures);
}

// Loads a file with any content: it must give a valid mesh, or ERR_INPUT with a message.
static inline void check_loads_or_fails(mesh_load_fn load, const char *path, const char *how,
                                        size_t where)
{
    struct scene scene = {0};
    struct err err = {0};
    if (load(&scene, path, &err))
        check_mesh(&scene, &scene.meshes[0]);
    else
        CHECK(err.code == ERR_INPUT && err.msg[0], "%s %zu: code %d: %s", how, where, err.code,
              err.msg);
    scene_finish(&scene);
}

// Truncates the file at every byte.
static inline void cut_everywhere(mesh_load_fn load, const char *name, const void *data,
                                  size_t size)
{
    for (size_t length = 0; length <= size; length++)
        check_loads_or_fails(load, write_bytes(name, data, length), "cut at", length);
}

// Makes `count` copies with one to four random bytes changed; SplitMix64 makes the same ones in
// each run.
static inline void flip_bytes(mesh_load_fn load, const char *name, const void *data, size_t size,
                              unsigned count)
{
    uint64_t state = 1;
    unsigned char *copy = malloc(size);
    REQUIRE(copy, "out of memory");
    for (unsigned i = 0; i < count; i++) {
        memcpy(copy, data, size);
        for (unsigned flips = 0; flips <= i % 4; flips++) {
            uint64_t x = state += UINT64_C(0x9e3779b97f4a7c15);
            x = (x ^ (x >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
            x = (x ^ (x >> 27)) * UINT64_C(0x94d049bb133111eb);
            x ^= x >> 31;
            copy[(x >> 8) % size] = (unsigned char)x;
        }
        check_loads_or_fails(load, write_bytes(name, copy, size), "copy", i);
    }
    free(copy);
}

#endif
