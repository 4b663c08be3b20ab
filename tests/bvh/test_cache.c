#define _GNU_SOURCE // nftw
// Tests hierarchies read from a cache folder: they equal those that are built, and damaged files
// are refused.
#include "bvh/bvh_cache.h"

#include "base/file.h"
#include "base/log.h"
#include "meshes.h"
#include "temporary_folder.h"
#include "test.h"
#include <stdatomic.h>
#include <sys/wait.h>

struct fixture {
    char folder[256];
    struct arena arena;
    struct mesh mesh;
    struct bvh_params params;
    struct bvh built;
    char *path; // path of its file
};

static _Atomic unsigned warnings;

static void count_warnings(void *context, enum log_level level, const char *message)
{
    (void)context, (void)message;
    atomic_fetch_add(&warnings, level <= LOG_WARN);
}

static bool setup(struct fixture *f, uint32_t rings)
{
    struct err err = {0};
    *f = (struct fixture){0};
    atomic_store(&warnings, 0);
    log_configure(LOG_WARN, count_warnings, NULL);
    if (!temporary_enter(f->folder, sizeof f->folder))
        return false;
    f->mesh = mesh_sphere(&f->arena, rings, 64);
    f->params = mesh_params(&f->mesh);
    f->path = bvh_cache_path("cache", &f->params, &f->arena);
    CHECK(bvh_build(&f->params, &f->arena, &f->built, &err), "%s", err.msg);
    return f->path && err.code == ERR_NONE;
}

static void finish(struct fixture *f)
{
    log_configure(LOG_WARN, NULL, NULL);
    temporary_leave(f->folder);
    arena_finish(&f->arena);
}

static bool same_tree(const struct bvh *a, const struct bvh *b)
{
    return a->format == b->format && a->node_count == b->node_count &&
           a->triangle_count == b->triangle_count && a->reference_count == b->reference_count &&
           memcmp(bvh_nodes_data(a), bvh_nodes_data(b), bvh_nodes_bytes(a)) == 0 &&
           memcmp(a->triangle_order, b->triangle_order,
                  a->reference_count * sizeof *a->triangle_order) == 0 &&
           a->stats.depth == b->stats.depth && a->stats.stack_entries == b->stats.stack_entries &&
           a->stats.leaf_count == b->stats.leaf_count && a->stats.bytes == b->stats.bytes &&
           a->stats.sah_cost == b->stats.sah_cost;
}

// Builds a tree through the cache. Returns whether it was loaded.
static bool build(struct fixture *f, const char *folder, const struct bvh_params *params,
                  struct bvh *out)
{
    struct bvh_cache cache = {.folder = folder};
    struct err err = {0};
    CHECK(bvh_build_cached(&cache, params, &f->arena, out, &err), "%s", err.msg);
    CHECK(cache.loaded == (out->stats.cached_seconds > 0), "%u loaded, %g s", cache.loaded,
          out->stats.cached_seconds);
    return cache.loaded > 0;
}

TEST(what_is_kept_is_loaded)
{
    static const struct bvh_method methods[] = {
        {BVH_SPLIT_SAH, BVH_QUANTISED, 0},
        {BVH_SPLIT_SAH, BVH_FLOAT, 0},
        {BVH_SPLIT_SPATIAL, BVH_QUANTISED, 0},
        {BVH_SPLIT_MEDIAN, BVH_QUANTISED, 0},
        {BVH_SPLIT_SAH, BVH_QUANTISED, BVH_OPTIMIZE_OFF},
        {BVH_SPLIT_SAH, BVH_QUANTISED, .max_leaf = 8},
        {BVH_SPLIT_SAH, BVH_QUANTISED, .traversal_cost = 5},
        {BVH_SPLIT_SAH, BVH_QUANTISED, .intersection_cost = 5},
        {BVH_SPLIT_MIDDLE, BVH_FLOAT, .max_leaf = 8},
    };
    struct fixture f;
    REQUIRE(setup(&f, 40));
    for (size_t i = 0; i < sizeof methods / sizeof *methods; i++) {
        struct bvh built, loaded;
        struct bvh_params params = f.params;
        params.method = methods[i];
        CHECK(!build(&f, "cache", &params, &built), "method %zu: there is one already", i);
        CHECK(build(&f, "cache", &params, &loaded), "method %zu: it was not kept", i);
        CHECK(same_tree(&built, &loaded), "method %zu", i);
        CHECK(loaded.stats.cached_seconds == built.stats.build_seconds);
        CHECK(temporary_entries("cache") == (int)i + 1, "%d files", temporary_entries("cache"));
    }
    CHECK(atomic_load(&warnings) == 0, "%u warnings", atomic_load(&warnings));
    finish(&f);
}

// Any change of a vertex, a box or a count leads to another file.
TEST(other_input_is_another_file)
{
    struct fixture f;
    REQUIRE(setup(&f, 90));
    struct bvh_box boxes[2] = {{{0, 0, 0}, {1, 1, 1}}, {{2, 0, 0}, {3, 1, 1}}};
    struct bvh_params params[8] = {f.params, f.params, f.params, f.params,
                                   f.params, f.params, f.params, f.params};
    params[1].triangle_count--;
    params[2].method.max_leaf = 1;
    params[3].shape_boxes = params[4].shape_boxes = boxes;
    params[3].shape_count = 2;
    params[4].shape_count = 1;
    params[5].instance_boxes = boxes;
    params[5].instance_count = 2;
    params[6].method.format = BVH_FLOAT;
    params[7].method.split = BVH_SPLIT_MEDIAN;
    char *paths[8];
    for (int i = 0; i < 8; i++) {
        paths[i] = bvh_cache_path("cache", &params[i], &f.arena);
        for (int k = 0; k < i; k++)
            CHECK(strcmp(paths[i], paths[k]) != 0, "%d and %d", i, k);
    }
    params[3].shape_boxes = (struct bvh_box[]){boxes[0], {{2, 0, 0}, {3, 1, 1.5f}}};
    CHECK(strcmp(paths[3], bvh_cache_path("cache", &params[3], &f.arena)) != 0);
    for (uint32_t i = 0; i < 50; i++) {
        float *value = (float *)f.mesh.vertices + (size_t)i * (f.mesh.count * 9 - 1) / 49,
              old = *value;
        *value = nextafterf(old, 2);
        CHECK(strcmp(paths[0], bvh_cache_path("cache", &f.params, &f.arena)) != 0, "float %u", i);
        *value = old;
    }
    CHECK(strcmp(paths[0], bvh_cache_path("cache", &f.params, &f.arena)) == 0);
    finish(&f);
}

TEST(small_ones_are_not_kept)
{
    struct fixture f;
    struct bvh bvh;
    REQUIRE(setup(&f, 20));
    CHECK(!build(&f, "cache", &f.params, &bvh) && !build(&f, "cache", &f.params, &bvh));
    CHECK(access("cache", F_OK) != 0, "there is a folder");
    finish(&f);
}

// The folder cannot be created, because its parent is missing or a file has its name: the tree is
// built nevertheless, with one warning.
TEST(folders_that_cannot_be)
{
    static const char *const folders[] = {"no/such/folder", "file"};
    struct fixture f;
    struct bvh bvh;
    struct err err = {0};
    REQUIRE(setup(&f, 40) && temporary_write("file", "x"));
    for (int i = 0; i < 2; i++) {
        struct bvh_cache cache = {.folder = folders[i]};
        atomic_store(&warnings, 0);
        for (int again = 0; again < 2; again++)
            CHECK(bvh_build_cached(&cache, &f.params, &f.arena, &bvh, &err), "%s", err.msg);
        CHECK(same_tree(&bvh, &f.built) && cache.is_unwritable && cache.saved == 0);
        CHECK(atomic_load(&warnings) == 1, "%s: %u warnings", folders[i], atomic_load(&warnings));
    }
    finish(&f);
}

// --- damage --------------------------------------------------------------------------------------

struct content {
    uint8_t *data;
    size_t size;
};

static bool read_content(struct fixture *f, struct content *out)
{
    struct file_bytes bytes;
    struct err err = {0};
    if (!file_read(&f->arena, f->path, 0, &bytes, &err))
        return false;
    out->data = ARENA_NEW(&f->arena, uint8_t, bytes.size + 64);
    out->size = bytes.size;
    return out->data && memcpy(out->data, bytes.data, bytes.size);
}

static void write_content(const char *path, const uint8_t *data, size_t size)
{
    FILE *file = fopen(path, "wb");
    CHECK(file && fwrite(data, 1, size, file) == size);
    CHECK(file && fclose(file) == 0);
}

// Checks that the file is refused with a message that names it, and that its memory is released.
static void check_refused(const struct fixture *f, const char *what, size_t number)
{
    struct arena arena = {0};
    struct bvh bvh;
    struct err err = {0};
    CHECK(!bvh_cache_load(f->path, &f->params, &arena, &bvh, &err), "%s %zu: taken", what, number);
    CHECK(err.code == ERR_INPUT && strstr(err.msg, f->path), "%s %zu: %s", what, number, err.msg);
    arena_finish(&arena);
}

TEST(damaged_files_are_refused)
{
    struct fixture f;
    struct bvh bvh;
    struct content good;
    REQUIRE(setup(&f, 40));
    build(&f, "cache", &f.params, &bvh);
    REQUIRE(read_content(&f, &good));
    size_t nodes = (size_t)bvh_nodes_bytes(&f.built), order = f.built.reference_count * 4u;
    size_t header = good.size - nodes - order;
    const size_t lengths[] = {0,
                              1,
                              7,
                              8,
                              header - 1,
                              header,
                              header + 1,
                              header + nodes / 2,
                              header + nodes,
                              header + nodes + 4,
                              good.size - 4,
                              good.size - 1,
                              good.size + 1,
                              good.size + 64};
    for (size_t i = 0; i < sizeof lengths / sizeof *lengths; i++) {
        write_content(f.path, good.data, lengths[i]);
        check_refused(&f, "length", lengths[i]);
    }
    struct random random = {3};
    for (int i = 0; i < 1000; i++) {
        // A third of the flips is in the header, which is much shorter than the rest.
        size_t bits = 8 * (i % 3 ? good.size : header);
        size_t bit = (size_t)(random_unit(&random) * (double)bits);
        good.data[bit / 8] ^= (uint8_t)(1u << bit % 8);
        write_content(f.path, good.data, good.size);
        check_refused(&f, "bit", bit);
        good.data[bit / 8] ^= (uint8_t)(1u << bit % 8);
    }
    // The file of another scene has this name.
    struct bvh_params other = f.params;
    struct err err = {0};
    other.triangle_count--;
    CHECK(bvh_build(&other, &f.arena, &bvh, &err) && bvh_cache_save(f.path, &other, &bvh, &err),
          "%s", err.msg);
    check_refused(&f, "another scene", 0);
    // The tree is built again with a warning; then the file is valid again.
    CHECK(atomic_load(&warnings) == 0);
    CHECK(!build(&f, "cache", &f.params, &bvh) && same_tree(&bvh, &f.built));
    CHECK(atomic_load(&warnings) == 1, "%u warnings", atomic_load(&warnings));
    CHECK(build(&f, "cache", &f.params, &bvh) && same_tree(&bvh, &f.built));
    finish(&f);
}

// The checksum is correct, so the tree itself must be validated. If one bit changes on the way to
// the disk, the older file remains.
TEST(wrongly_stored_files_replace_nothing)
{
    struct fixture f;
    REQUIRE(setup(&f, 64));
    struct err err = {0};
    struct bvh loaded;
    REQUIRE(file_make_folder("cache", &err) && bvh_cache_save(f.path, &f.params, &f.built, &err),
            "%s", err.msg);
    for (uint64_t n = 1; n <= f.built.stats.bytes; n += f.built.stats.bytes / 7) {
        file_corrupt_at(n);
        CHECK(!bvh_cache_save(f.path, &f.params, &f.built, &err) && err.code == ERR_OUTPUT,
              "byte %llu", (unsigned long long)n);
        CHECK(bvh_cache_load(f.path, &f.params, &f.arena, &loaded, &err) &&
                  same_tree(&f.built, &loaded) && temporary_entries("cache") == 1,
              "%s", err.msg);
    }
    finish(&f);
}

TEST(wrong_trees_are_refused)
{
    struct fixture f;
    struct err err = {0};
    REQUIRE(setup(&f, 40));
    REQUIRE(file_make_folder("cache", &err) && bvh_cache_save(f.path, &f.params, &f.built, &err),
            "%s", err.msg);
    struct bvh bvh = f.built;
    uint32_t *inner = NULL, *leaf = NULL;
    for (int i = 0; i < 4; i++) {
        uint32_t *child = &bvh.nodes[0].child[i];
        inner = *child & BVH_LEAF ? inner : child;
    }
    for (uint32_t n = 0; n < bvh.node_count && !leaf; n++)
        leaf = bvh.nodes[n].child[0] & BVH_LEAF ? &bvh.nodes[n].child[0] : NULL;
    REQUIRE(inner && leaf);
    const struct {
        uint32_t *word, value;
    } wrong[] = {
        {inner, 0},                                      // a cycle
        {inner, bvh.node_count},                         // beyond the nodes
        {inner, *inner + 1},                             // child of another node
        {leaf, BVH_LEAF | bvh.reference_count},          // beyond the triangles
        {leaf, *leaf | BVH_LEAF_SHAPE},                  // a shape, although there are none
        {leaf, BVH_LEAF | BVH_LEAF_INSTANCE},            // an instance
        {leaf, BVH_EMPTY},                               // an empty child before others
        {&bvh.triangle_order[7], bvh.triangle_order[8]}, // a triangle that occurs twice
        {&bvh.triangle_order[7], UINT32_MAX},
        {&bvh.nodes[0].hi[1], 0}, // boxes that are too small
        {&bvh.nodes[0].exponents, 0},
        {&bvh.stats.stack_entries, 1}, // traversals would overflow their stacks
        {&bvh.stats.depth, 1},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        uint32_t right = *wrong[i].word;
        *wrong[i].word = wrong[i].value;
        CHECK(bvh_cache_save(f.path, &f.params, &bvh, &err), "%s", err.msg);
        *wrong[i].word = right;
        check_refused(&f, "tree", i);
    }
    CHECK(bvh_cache_save(f.path, &f.params, &bvh, &err), "%s", err.msg);
    CHECK(bvh_cache_load(f.path, &f.params, &f.arena, &bvh, &err), "%s", err.msg);
    finish(&f);
}

// Several processes load, build, save and remove the same file; each gets a valid tree.
TEST(several_processes)
{
    enum { PROCESSES = 4, ROUNDS = 12 };
    struct fixture f;
    pid_t children[PROCESSES];
    REQUIRE(setup(&f, 40));
    for (int p = 0; p < PROCESSES; p++) {
        children[p] = fork();
        if (children[p] != 0)
            continue;
        struct bvh bvh;
        bool ok = true;
        for (int i = 0; i < ROUNDS; i++) {
            build(&f, "cache", &f.params, &bvh);
            ok = ok && same_tree(&bvh, &f.built);
            if ((i + p) % 3 == 0)
                remove(f.path);
        }
        _exit(ok && atomic_load(&warnings) == 0 && test_failures == 0 ? 0 : 1);
    }
    for (int p = 0; p < PROCESSES; p++) {
        int status = 1;
        CHECK(children[p] > 0 && waitpid(children[p], &status, 0) == children[p]);
        CHECK(WIFEXITED(status) && WEXITSTATUS(status) == 0, "process %d: %d", p, status);
    }
    CHECK(temporary_entries("cache") <= 1, "%d files", temporary_entries("cache"));
    finish(&f);
}

TEST_MAIN(TEST_CASE(what_is_kept_is_loaded), TEST_CASE(other_input_is_another_file),
          TEST_CASE(small_ones_are_not_kept), TEST_CASE(folders_that_cannot_be),
          TEST_CASE(damaged_files_are_refused), TEST_CASE(wrong_trees_are_refused),
          TEST_CASE(wrongly_stored_files_replace_nothing), TEST_CASE(several_processes))
