#include "render/checkpoint.h"

#include "base/file.h"
#include "base/file_system.h"
#include "base/hash.h"
#include "render/adaptive.h"
#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#define VERSION 2u
#define BYTE_ORDER_WORD 0x01020304u
#define BLOCK_BYTES (UINT64_C(1) << 20)

static const char magic[8] = {'L', 'A', 'M', 'P', 'Y', 'R', 'I', 'S'};

struct header {
    char magic[8];
    uint32_t version, byte_order;
    uint64_t file_bytes, identity_bytes, film_bytes, chunk_pixels;
    uint32_t state_count, tile_count;
};

// --- the renderer's state ------------------------------------------------------------------------

// Visits everything that is saved of the renderer, in the same order for writing and reading.
struct cursor {
    uint64_t *words;
    uint32_t at;
    bool reads;
};

static void visit(struct cursor *c, uint64_t *value)
{
    if (c->reads)
        *value = c->words[c->at++];
    else
        c->words[c->at++] = *value;
}

static void visit_32(struct cursor *c, uint32_t *value)
{
    uint64_t wide = *value;
    visit(c, &wide);
    *value = (uint32_t)wide;
}

static void visit_stats(struct cursor *c, struct render_stats *stats)
{
    uint64_t seconds, recorded = stats->nonfinite.recorded;
    memcpy(&seconds, &stats->render_seconds, sizeof seconds);
    visit(c, &seconds);
    memcpy(&stats->render_seconds, &seconds, sizeof seconds);
    visit(c, &stats->closest_rays);
    visit(c, &stats->shadow_rays);
    for (uint32_t i = 0; i < CLASS_COUNT; i++)
        visit(c, &stats->surface_hits[i]);
    visit(c, &stats->media_lost);
    visit(c, &stats->waves);
    visit(c, &stats->voided_waves);
    visit(c, &stats->suspended);
    for (int site = 0; site < SITE_COUNT; site++)
        visit(c, &stats->nonfinite.count[site]);
    visit(c, &recorded);
    stats->nonfinite.recorded = recorded != 0;
    visit_32(c, &stats->nonfinite.pixel);
    visit_32(c, &stats->nonfinite.sample);
    visit_32(c, &stats->nonfinite.site);
    visit_32(c, &stats->nonfinite.bounce);
}

static void visit_renderer(struct cursor *c, struct renderer *r)
{
    visit(c, &r->next_sample);
    visit(c, &r->round_target);
    visit_32(c, &r->pass.shift);
    visit(c, &r->pass.position);
    visit(c, &r->pass.length);
    visit_stats(c, &r->stats);
    visit(c, &r->emptied_at);
}

#define NOTE_AT (CHECKPOINT_STATE_WORDS - CHECKPOINT_NOTE_WORDS)

_Static_assert(6 + 1 + 2 + CLASS_COUNT + 4 + SITE_COUNT + 5 <= NOTE_AT,
               "room for all of the renderer's state");

// --- writing -------------------------------------------------------------------------------------

struct output {
    struct file_writer writer;
    uint64_t hash;
};

static bool put(struct output *out, const void *data, uint64_t bytes, struct err *err)
{
    out->hash = hash_bytes(out->hash, data, bytes);
    return file_writer_write(&out->writer, data, bytes, err);
}

static bool put_film(struct output *out, struct renderer *r, struct err *err)
{
    char *block = malloc(BLOCK_BYTES);
    bool ok = block || err_memory(err, "a checkpoint", BLOCK_BYTES);
    for (uint32_t i = 0; i < r->plan.film_chunks; i++)
        for (uint64_t at = 0; ok && at < r->film[i].bytes; at += BLOCK_BYTES) {
            uint64_t left = r->film[i].bytes - at;
            uint64_t bytes = left < BLOCK_BYTES ? left : BLOCK_BYTES;
            ok = gpu_download(r->gpu, &r->film[i], at, block, bytes, err) &&
                 put(out, block, bytes, err);
        }
    free(block);
    return ok;
}

static uint64_t film_bytes(const struct renderer *r)
{
    uint64_t bytes = 0;
    for (uint32_t i = 0; i < r->plan.film_chunks; i++)
        bytes += r->film[i].bytes;
    return bytes;
}

static uint64_t bytes_before_film(const struct header *header)
{
    return sizeof *header + header->identity_bytes +
           sizeof(uint64_t) * (uint64_t)header->state_count +
           2 * sizeof(uint32_t) * (uint64_t)header->tile_count;
}

static struct header make_header(const struct renderer *r, const char *identity)
{
    struct header header = {
        .version = VERSION,
        .byte_order = BYTE_ORDER_WORD,
        .identity_bytes = strlen(identity),
        .film_bytes = film_bytes(r),
        .chunk_pixels = r->plan.film_chunk_pixels,
        .state_count = CHECKPOINT_STATE_WORDS,
        .tile_count = r->tiles.count,
    };
    memcpy(header.magic, magic, sizeof magic);
    header.file_bytes = bytes_before_film(&header) + header.film_bytes + sizeof(uint64_t);
    return header;
}

bool checkpoint_write(struct renderer *r, const char *path, const char *identity,
                      const uint64_t note[CHECKPOINT_NOTE_WORDS], struct err *err)
{
    struct output out = {.hash = HASH_INIT};
    uint64_t state[CHECKPOINT_STATE_WORDS] = {0};
    visit_renderer(&(struct cursor){.words = state}, r);
    memcpy(&state[NOTE_AT], note, CHECKPOINT_NOTE_WORDS * sizeof *note);
    struct header header = make_header(r, identity);
    uint64_t list_bytes = r->tiles.count * sizeof *r->tiles.counts;
    if (!file_writer_open(&out.writer, path, err))
        return false;
    bool ok = put(&out, &header, sizeof header, err) &&
              put(&out, identity, header.identity_bytes, err) &&
              put(&out, state, sizeof state, err) && put(&out, r->tiles.counts, list_bytes, err) &&
              put(&out, r->tiles.done, list_bytes, err) && put_film(&out, r, err) &&
              file_writer_write(&out.writer, &out.hash, sizeof out.hash, err);
    if (ok)
        return file_writer_commit(&out.writer, err);
    file_writer_finish(&out.writer);
    return false;
}

// --- reading -------------------------------------------------------------------------------------

static bool fail_reading(const struct checkpoint *c, struct err *err)
{
    if (ferror(c->file))
        return err_set(err, ERR_INPUT, "%s: cannot read: %s", c->path, strerror(errno));
    return err_set(err, ERR_INPUT, "%s: is cut short; expected a whole checkpoint", c->path);
}

static bool get(const struct checkpoint *c, void *data, uint64_t bytes, struct err *err)
{
    return bytes == 0 || fread(data, 1, bytes, c->file) == bytes || fail_reading(c, err);
}

static bool measure(const struct checkpoint *c, uint64_t *bytes, struct err *err)
{
    return file_stream_size(c->file, bytes) ||
           err_set(err, ERR_INPUT, "%s: cannot be read from its beginning to its end: %s", c->path,
                   strerror(errno));
}

static bool check_header(const struct checkpoint *c, const struct header *h, uint64_t file_bytes,
                         struct err *err)
{
    if (memcmp(h->magic, magic, sizeof magic) != 0)
        return err_set(err, ERR_INPUT, "%s: is not a checkpoint of lampyris", c->path);
    if (h->version != VERSION || h->byte_order != BYTE_ORDER_WORD ||
        h->state_count != CHECKPOINT_STATE_WORDS)
        return err_set(err, ERR_INPUT,
                       "%s: is a checkpoint of version %u, of another build or machine; expected "
                       "version %u of this one",
                       c->path, h->version, VERSION);
    if (h->file_bytes != file_bytes)
        return err_set(err, ERR_INPUT, "%s: has %" PRIu64 " bytes; expected %" PRIu64, c->path,
                       file_bytes, h->file_bytes);
    uint64_t limit = file_bytes;
    if (h->identity_bytes > CHECKPOINT_IDENTITY_MAX || h->film_bytes > limit ||
        (uint64_t)h->tile_count > limit / 8 ||
        bytes_before_film(h) + h->film_bytes + sizeof(uint64_t) != file_bytes)
        return err_set(err, ERR_INPUT,
                       "%s: is damaged: its parts do not make up its %" PRIu64 " bytes", c->path,
                       file_bytes);
    return true;
}

// The hash, at the end of the file, covers everything before it.
static bool check_hash(const struct checkpoint *c, uint64_t file_bytes, struct err *err)
{
    char *block = malloc(BLOCK_BYTES);
    if (!block)
        return err_memory(err, "a checkpoint", BLOCK_BYTES);
    uint64_t hash = HASH_INIT, expected = 0, left = file_bytes - sizeof hash;
    rewind(c->file);
    bool ok = true;
    while (ok && left > 0) {
        uint64_t bytes = left < BLOCK_BYTES ? left : BLOCK_BYTES;
        ok = get(c, block, bytes, err);
        hash = ok ? hash_bytes(hash, block, bytes) : hash;
        left -= bytes;
    }
    free(block);
    if (!ok || !get(c, &expected, sizeof expected, err))
        return false;
    if (hash != expected)
        return err_set(err, ERR_INPUT,
                       "%s: is damaged: its content has hash %016" PRIx64 "; expected %016" PRIx64,
                       c->path, hash, expected);
    rewind(c->file);
    return true;
}

static bool read_parts(struct checkpoint *c, const struct header *h, struct arena *arena,
                       struct err *err)
{
    char *identity = ARENA_NEW(arena, char, h->identity_bytes + 1);
    c->tile_count = h->tile_count;
    c->counts = ARENA_NEW(arena, uint32_t, h->tile_count);
    c->done = ARENA_NEW(arena, uint32_t, h->tile_count);
    if (!identity || !c->counts || !c->done)
        return err_memory(err, "a checkpoint", bytes_before_film(h));
    c->identity = identity;
    c->chunk_pixels = h->chunk_pixels;
    c->film_bytes = h->film_bytes;
    uint64_t list_bytes = h->tile_count * sizeof *c->counts;
    struct header again;
    if (!get(c, &again, sizeof again, err) || !get(c, identity, h->identity_bytes, err) ||
        !get(c, c->state, sizeof c->state, err) || !get(c, c->counts, list_bytes, err) ||
        !get(c, c->done, list_bytes, err))
        return false;
    identity[h->identity_bytes] = '\0';
    memcpy(c->note, &c->state[NOTE_AT], sizeof c->note);
    return true;
}

bool checkpoint_read(FILE *file, const char *path, struct arena *arena, struct checkpoint *out,
                     struct err *err)
{
    *out = (struct checkpoint){.file = file, .path = path};
    uint64_t bytes;
    struct header header;
    if (!measure(out, &bytes, err))
        return false;
    if (bytes < sizeof header + sizeof(uint64_t))
        return err_set(err, ERR_INPUT,
                       "%s: is not a checkpoint of lampyris: it has %" PRIu64 " bytes", path,
                       bytes);
    return get(out, &header, sizeof header, err) && check_header(out, &header, bytes, err) &&
           check_hash(out, bytes, err) && read_parts(out, &header, arena, err);
}

bool checkpoint_open(const char *path, struct arena *arena, struct checkpoint *out, struct err *err)
{
    *out = (struct checkpoint){0};
    if (file_is_special(path))
        return err_set(err, ERR_INPUT, "%s: is no regular file; expected a checkpoint", path);
    FILE *file = file_stream(path, "rb");
    if (!file)
        return err_set(err, ERR_INPUT, "%s: cannot open: %s", path, strerror(errno));
    if (checkpoint_read(file, path, arena, out, err))
        return true;
    fclose(file);
    *out = (struct checkpoint){0};
    return false;
}

void checkpoint_close(struct checkpoint *c)
{
    if (!c)
        return;
    if (c->file)
        fclose(c->file);
    *c = (struct checkpoint){0};
}

// --- going on ------------------------------------------------------------------------------------

static int line_length(const char *line)
{
    return (int)strcspn(line, "\n");
}

static const char *next_line(const char *line)
{
    line += line_length(line);
    return *line ? line + 1 : line;
}

static int name_length(const char *line)
{
    return (int)strcspn(line, "=\n");
}

bool checkpoint_check(const struct checkpoint *c, const char *identity, struct err *err)
{
    const char *was = c->identity, *is = identity;
    while (*was && *is && line_length(was) == line_length(is) &&
           memcmp(was, is, (size_t)line_length(was)) == 0) {
        was = next_line(was);
        is = next_line(is);
    }
    if (!*was && !*is)
        return true;
    bool same_name =
        name_length(was) == name_length(is) && memcmp(was, is, (size_t)name_length(was)) == 0;
    if (same_name && *was && *is) {
        const char *value = is + name_length(is) + (is[name_length(is)] == '=');
        return err_set(err, ERR_INPUT, "%s: was made with %.*s, but this run has %.*s", c->path,
                       line_length(was), was, line_length(value), value);
    }
    // The lines before them determine which lines follow.
    return err_set(err, ERR_INPUT,
                   "%s: was made by another build of lampyris, which tells \"%.*s\" where this one "
                   "tells \"%.*s\"; expected a checkpoint of this build",
                   c->path, name_length(was), was, name_length(is), is);
}

static bool upload_film(struct checkpoint *c, struct renderer *r, struct err *err)
{
    char *block = malloc(BLOCK_BYTES);
    bool ok = block || err_memory(err, "a checkpoint", BLOCK_BYTES);
    for (uint32_t i = 0; i < r->plan.film_chunks; i++)
        for (uint64_t at = 0; ok && at < r->film[i].bytes; at += BLOCK_BYTES) {
            uint64_t left = r->film[i].bytes - at;
            uint64_t bytes = left < BLOCK_BYTES ? left : BLOCK_BYTES;
            ok =
                get(c, block, bytes, err) && gpu_upload(r->gpu, &r->film[i], at, block, bytes, err);
        }
    free(block);
    return ok;
}

static bool check_state(const struct checkpoint *c, const struct renderer *r, struct err *err)
{
    uint64_t pixels = (uint64_t)r->frame.width * r->frame.height;
    bool ok = r->pass.shift <= MAX_SAMPLE_SHIFT && r->pass.position <= r->pass.length &&
              r->pass.length <= pixels && r->next_sample <= UINT32_MAX;
    for (uint32_t i = 0; ok && i < c->tile_count; i++)
        ok = c->counts[i] > 0 && c->done[i] <= c->counts[i] * r->round_target;
    if (!ok)
        return err_set(err, ERR_INPUT, "%s: holds a state that no render can be in", c->path);
    return r->pass.position == 0 || 1u << r->pass.shift <= r->plan.wave_samples ||
           err_set(err, ERR_INPUT,
                   "%s: ended amid waves of %u samples a pixel, which waves of %u paths do not "
                   "hold; expected a larger --wave",
                   c->path, 1u << r->pass.shift, r->plan.wave_samples);
}

bool checkpoint_restore(struct checkpoint *c, struct renderer *r, struct err *err)
{
    if (c->chunk_pixels != r->plan.film_chunk_pixels || c->film_bytes != film_bytes(r))
        return err_set(err, ERR_INPUT,
                       "%s: was made with a film of %" PRIu64 " bytes in buffers of %" PRIu64
                       " pixels, but this run has %" PRIu64 " and %" PRIu64,
                       c->path, c->film_bytes, c->chunk_pixels, film_bytes(r),
                       r->plan.film_chunk_pixels);
    bool has_tiles = r->specialization.features & FEATURE_TILES;
    uint32_t across = tiles_along(r->frame.width), down = tiles_along(r->frame.height);
    if (c->tile_count != (has_tiles ? across * down : 0))
        return err_set(err, ERR_INPUT, "%s: has %u tiles; expected %u", c->path, c->tile_count,
                       has_tiles ? across * down : 0);
    visit_renderer(&(struct cursor){.words = c->state, .reads = true}, r);
    if (!check_state(c, r, err))
        return false;
    if (r->pass.position == 0)
        r->pass = (struct pass){0}; // not begun: this run may have other waves
    if (has_tiles) {
        struct tile_plan plan = tile_plan_of(r->frame.width, r->frame.height, c->counts);
        if (!renderer_set_plan(r, &plan, err))
            return false;
        memcpy(r->tiles.done, c->done, c->tile_count * sizeof *c->done);
    }
    return upload_film(c, r, err);
}
