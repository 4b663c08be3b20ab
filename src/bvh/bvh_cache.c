// Stores hierarchies in files.
#include "bvh/bvh_cache.h"

#include "base/clock.h"
#include "base/file.h"
#include "base/file_handle.h"
#include "base/hash.h"
#include "base/log.h"
#include "base/parallel.h"
#include "bvh/bvh_node.h"
#include "bvh/bvh_triangle.h"
#include <errno.h>
#include <inttypes.h>
#include <limits.h>

// Increase this when the file format changes, or the builder's result for the same input.
#define FORMAT_VERSION 1
#define MAGIC "LampBVH"
#define BYTE_ORDER_MARK 0x01020304u
#define LONGEST_BUILD 1e9 // in seconds; longer times are rejected as damage

// The file consists of this header, the nodes, and triangle_order.
struct header {
    char magic[8];
    uint32_t version;
    uint32_t byte_order; // BYTE_ORDER_MARK in the byte order of the writer
    struct hash128 key;  // hash of the build's input
    struct hash128 sum;  // hash of the nodes, triangle_order and the members below
    uint32_t format;     // enum bvh_format
    uint32_t node_count, triangle_count, reference_count;
    struct bvh_stats stats;
};

// --- hashes --------------------------------------------------------------------------------------

// Each thread hashes pieces of this many elements; then the hashes of the pieces are hashed.
#define PIECE 4096u

struct hash_job {
    const struct bvh_params *params; // whose triangles are hashed; NULL: `bytes` are hashed
    const uint8_t *bytes;
    size_t count; // number of triangles or bytes
    struct hash128 *pieces;
};

static void hash_piece(void *context, size_t begin, size_t end, unsigned thread)
{
    (void)thread;
    const struct hash_job *job = context;
    for (size_t i = begin; i < end; i++) {
        // A piece of bytes is about as large as a piece of triangles.
        size_t length = job->params ? PIECE : PIECE * sizeof(float[3][3]);
        size_t first = i * length, left = job->count - first;
        size_t count = left < length ? left : length;
        if (!job->params) {
            job->pieces[i] = hash128_bytes(job->bytes + first, count);
            continue;
        }
        float vertices[PIECE][3][3];
        for (size_t t = 0; t < count; t++)
            bvh_triangle_load(job->params, (uint32_t)(first + t), vertices[t]);
        job->pieces[i] = hash128_bytes(vertices, count * sizeof *vertices);
    }
}

static bool run_hash(struct hash_job *job, struct hash128 *out)
{
    struct arena scratch = {0};
    size_t length = job->params ? PIECE : PIECE * sizeof(float[3][3]);
    size_t pieces = (job->count + length - 1) / length;
    job->pieces = ARENA_NEW(&scratch, struct hash128, pieces);
    if (job->pieces) {
        parallel_for(pieces, 8, 0, hash_piece, job);
        *out = hash128_bytes(job->pieces, pieces * sizeof *job->pieces);
    }
    bool ok = job->pieces != NULL;
    arena_finish(&scratch);
    return ok;
}

static bool hash_memory(const void *data, size_t size, struct hash128 *out)
{
    struct hash_job job = {.bytes = data, .count = size};
    return run_hash(&job, out);
}

// Everything that a hierarchy depends on. It has no padding, because its bytes are hashed.
struct source {
    uint32_t version, node_bytes;
    uint32_t split, format, optimize, max_leaf;
    uint32_t triangle_count, shape_count, instance_count, spare;
    double costs[2];
    struct hash128 triangles, shapes, instances;
};

static bool find_key(const struct bvh_params *params, struct hash128 *out)
{
    struct source source = {
        .version = FORMAT_VERSION,
        .node_bytes = (uint32_t)bvh_node_bytes(params->method.format),
        .split = params->method.split,
        .format = params->method.format,
        .optimize = params->method.optimize,
        .max_leaf = bvh_max_leaf(&params->method),
        .costs = {bvh_cost(params->method.traversal_cost),
                  bvh_cost(params->method.intersection_cost)},
        .triangle_count = params->triangle_count,
        .shape_count = params->shape_count,
        .instance_count = params->instance_count,
    };
    struct hash_job triangles = {.params = params, .count = params->triangle_count};
    if (!run_hash(&triangles, &source.triangles) ||
        !hash_memory(params->shape_boxes, params->shape_count * sizeof *params->shape_boxes,
                     &source.shapes) ||
        !hash_memory(params->instance_boxes,
                     params->instance_count * sizeof *params->instance_boxes, &source.instances))
        return false;
    *out = hash128_bytes(&source, sizeof source);
    return true;
}

static bool same(struct hash128 a, struct hash128 b)
{
    return a.word[0] == b.word[0] && a.word[1] == b.word[1];
}

// Hashes all content that follows header.sum.
static bool find_sum(const struct header *header, const struct bvh *bvh, struct hash128 *out)
{
    struct {
        struct hash128 nodes, order, header;
    } sums;
    const char *rest = (const char *)&header->format;
    sums.header = hash128_bytes(rest, (size_t)((const char *)(header + 1) - rest));
    if (!hash_memory(bvh_nodes_data(bvh), bvh_nodes_bytes(bvh), &sums.nodes) ||
        !hash_memory(bvh->triangle_order, bvh->reference_count * sizeof *bvh->triangle_order,
                     &sums.order))
        return false;
    *out = hash128_bytes(&sums, sizeof sums);
    return true;
}

static char *path_of(const char *folder, struct hash128 key, struct arena *arena)
{
    return arena_printf(arena, "%s/%016" PRIx64 "%016" PRIx64 ".bvh", folder, key.word[1],
                        key.word[0]);
}

char *bvh_cache_path(const char *folder, const struct bvh_params *params, struct arena *arena)
{
    struct hash128 key;
    return find_key(params, &key) ? path_of(folder, key, arena) : NULL;
}

// --- loading -------------------------------------------------------------------------------------

static bool read_fully(int handle, void *data, size_t size, struct err *err)
{
    const int64_t got = file_handle_read(handle, data, size);
    return got == (int64_t)size ||
           err_set(err, ERR_INPUT, "cannot be read: %s",
                   got < 0 ? strerror(errno) : "it was truncated meanwhile");
}

static uint64_t file_bytes_of(const struct header *h)
{
    return sizeof *h + h->node_count * bvh_node_bytes((enum bvh_format)h->format) +
           (uint64_t)h->reference_count * sizeof(uint32_t);
}

static bool check_header(const struct header *h, uint64_t bytes, const struct bvh_params *params,
                         struct hash128 key, struct err *err)
{
    if (memcmp(h->magic, MAGIC, sizeof h->magic) != 0 || h->byte_order != BYTE_ORDER_MARK)
        return err_set(err, ERR_INPUT, "is not a BVH file of this program");
    if (h->version != FORMAT_VERSION)
        return err_set(err, ERR_INPUT, "has version %u; expected %d", h->version, FORMAT_VERSION);
    if (!same(h->key, key) || h->format != params->method.format ||
        h->triangle_count != params->triangle_count)
        return err_set(err, ERR_INPUT, "belongs to another scene or method");
    if (bytes != file_bytes_of(h))
        return err_set(err, ERR_INPUT, "has %" PRIu64 " bytes; expected %" PRIu64, bytes,
                       file_bytes_of(h));
    return true;
}

static bool read_tree(int handle, const struct header *h, const struct bvh_params *params,
                      struct arena *arena, struct bvh *out, struct err *err)
{
    *out = (struct bvh){
        .format = params->method.format,
        .max_leaf = params->method.max_leaf,
        .node_count = h->node_count,
        .triangle_count = h->triangle_count,
        .reference_count = h->reference_count,
        .stats = h->stats,
    };
    out->triangle_order = ARENA_NEW(arena, uint32_t, h->reference_count);
    if (!out->triangle_order || !bvh_nodes_allocate(arena, out, err))
        return err_memory(err, "the BVH", file_bytes_of(h));
    void *nodes = out->format == BVH_FLOAT ? (void *)out->nodes_float : out->nodes;
    struct hash128 sum;
    if (!read_fully(handle, nodes, bvh_nodes_bytes(out), err) ||
        !read_fully(handle, out->triangle_order, h->reference_count * sizeof *out->triangle_order,
                    err))
        return false;
    if (!find_sum(h, out, &sum))
        return err_memory(err, "the BVH's checksum", 0);
    if (!same(sum, h->sum))
        return err_set(err, ERR_INPUT, "is damaged: its checksum does not match");
    if (!(h->stats.build_seconds >= 0 && h->stats.build_seconds <= LONGEST_BUILD))
        return err_set(err, ERR_INPUT, "has a build time of %g s; expected 0 to %g s",
                       h->stats.build_seconds, LONGEST_BUILD);
    return bvh_validate(out, params, err);
}

static bool load_open_file(int handle, const struct bvh_params *params, struct hash128 key,
                           struct arena *arena, struct bvh *out, struct err *err)
{
    struct file_status status;
    struct header header;
    if (!file_handle_status(handle, &status) || status.kind != FILE_REGULAR)
        return err_set(err, ERR_INPUT, "is not a regular file");
    if (status.size < sizeof header)
        return err_set(err, ERR_INPUT, "has only %" PRIu64 " bytes", status.size);
    return read_fully(handle, &header, sizeof header, err) &&
           check_header(&header, status.size, params, key, err) &&
           read_tree(handle, &header, params, arena, out, err);
}

static bool load(const char *path, const struct bvh_params *params, struct hash128 key,
                 struct arena *arena, struct bvh *out, struct err *err)
{
    uint64_t start = clock_ns();
    const int handle = file_handle_open(path);
    *err = (struct err){0};
    if (handle < 0)
        return errno == ENOENT || errno == ENOTDIR
                   ? false
                   : err_set(err, ERR_INPUT, "%s: cannot be opened: %s", path, strerror(errno));
    bool ok = load_open_file(handle, params, key, arena, out, err) || err_prepend(err, "%s", path);
    file_handle_close(handle);
    if (ok) {
        out->stats.cached_seconds = out->stats.build_seconds;
        out->stats.build_seconds = clock_seconds_since(start);
    }
    return ok;
}

bool bvh_cache_load(const char *path, const struct bvh_params *params, struct arena *arena,
                    struct bvh *out, struct err *err)
{
    struct hash128 key;
    if (!find_key(params, &key))
        return err_memory(err, "the BVH's hash", 0);
    return load(path, params, key, arena, out, err);
}

// --- saving --------------------------------------------------------------------------------------

static bool save(const char *path, const struct bvh *bvh, struct hash128 key, struct err *err)
{
    struct header header = {
        .magic = MAGIC,
        .version = FORMAT_VERSION,
        .byte_order = BYTE_ORDER_MARK,
        .key = key,
        .format = bvh->format,
        .node_count = bvh->node_count,
        .triangle_count = bvh->triangle_count,
        .reference_count = bvh->reference_count,
        .stats = bvh->stats,
    };
    struct file_writer writer;
    if (!find_sum(&header, bvh, &header.sum))
        return err_memory(err, "the BVH's checksum", 0);
    if (!file_check_space(path, file_bytes_of(&header), err) ||
        !file_writer_open(&writer, path, err))
        return false;
    bool ok = file_writer_write(&writer, &header, sizeof header, err) &&
              file_writer_write(&writer, bvh_nodes_data(bvh), bvh_nodes_bytes(bvh), err) &&
              file_writer_write(&writer, bvh->triangle_order,
                                bvh->reference_count * sizeof *bvh->triangle_order, err);
    if (ok)
        return file_writer_commit(&writer, err);
    file_writer_finish(&writer);
    return false;
}

bool bvh_cache_save(const char *path, const struct bvh_params *params, const struct bvh *bvh,
                    struct err *err)
{
    struct hash128 key;
    return find_key(params, &key) ? save(path, bvh, key, err)
                                  : err_memory(err, "the BVH's hash", 0);
}

static void try_save(struct bvh_cache *cache, const char *path, const struct bvh *bvh,
                     struct hash128 key)
{
    struct err err = {0};
    if (cache->is_unwritable)
        return;
    if (file_make_folder(cache->folder, &err) && save(path, bvh, key, &err)) {
        cache->saved++;
        return;
    }
    cache->is_unwritable = true;
    log_warn("the BVH is not cached: %s", err.msg);
}

bool bvh_build_cached(struct bvh_cache *cache, const struct bvh_params *params, struct arena *arena,
                      struct bvh *out, struct err *err)
{
    uint64_t count =
        (uint64_t)params->triangle_count + params->shape_count + params->instance_count;
    struct arena scratch = {0};
    struct hash128 key;
    struct err refused = {0};
    char *path = NULL;
    uint64_t start = clock_ns();
    if (cache->folder && count >= BVH_CACHE_LEAST && find_key(params, &key))
        path = path_of(cache->folder, key, &scratch);
    bool ok = path && load(path, params, key, arena, out, &refused);
    if (ok) {
        cache->loaded++;
        out->stats.build_seconds = clock_seconds_since(start);
        progress_report(params->progress, "Building BVH", 1);
    } else {
        if (refused.code != ERR_NONE)
            log_warn("%s; the BVH is rebuilt", refused.msg);
        ok = bvh_build(params, arena, out, err);
        if (ok && path)
            try_save(cache, path, out, key);
    }
    arena_finish(&scratch);
    return ok;
}
