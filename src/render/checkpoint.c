#include "render/checkpoint.h"

#include "base/file.h"
#include "base/file_system.h"
#include "base/hash.h"
#include "base/memory.h"
#include "render/adaptive.h"
#include "shared/aov.h"
#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#define VERSION 3u
#define BYTE_ORDER_WORD 0x01020304u

static const char magic[8] = {'L', 'A', 'M', 'P', 'Y', 'R', 'I', 'S'};

struct header {
    char magic[8];
    uint32_t version, byte_order;
    uint64_t head_bytes; // bytes before the film, without their hash
    uint64_t file_bytes, identity_bytes, command_bytes, film_bytes;
    uint32_t block_bytes; // bytes of the film in a block, a whole number of records
    uint32_t state_count, tile_count;
    uint32_t is_zero; // padding: fills the header to a multiple of 8 bytes
};

_Static_assert(sizeof(struct header) == 8 + 2 * 4 + 5 * 8 + 4 * 4,
               "the header has no implicit padding");

// --- the renderer's state ------------------------------------------------------------------------

// Visits all saved members of the renderer's state, in the same order for writing and reading.
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

static void visit_state(struct cursor *c, struct film_copy *film)
{
    visit(c, &film->next_sample);
    visit(c, &film->round_target);
    visit_32(c, &film->pass.shift);
    visit(c, &film->pass.position);
    visit(c, &film->pass.length);
    visit_stats(c, &film->stats);
    visit(c, &film->emptied_at);
}

#define NOTE_AT (CHECKPOINT_STATE_WORDS - CHECKPOINT_NOTE_WORDS)

_Static_assert(6 + 1 + 2 + CLASS_COUNT + 4 + SITE_COUNT + 5 <= NOTE_AT,
               "room for all of the renderer's state");

// --- hashes --------------------------------------------------------------------------------------

// The hash of a block of the film includes the hash of everything before the film and the block's
// number, so that blocks from other files or places are detected, too.
static uint64_t hash_block(uint64_t head_hash, uint64_t number, const void *block, uint64_t bytes)
{
    const struct hash128 content = hash128_bytes(block, bytes);
    const uint64_t words[] = {head_hash, number, content.word[0], content.word[1]};
    return hash_bytes(HASH_INIT, words, sizeof words);
}

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

// The source of the film's records: `records` in the host's memory, or, if that is NULL, the
// device, from byte `first` on.
struct source {
    struct renderer *renderer;
    const char *records;
    uint64_t first, bytes, block_bytes;
};

static bool put_film(struct output *out, const struct source *source, struct err *err)
{
    const uint64_t head_hash = out->hash;
    char *block = malloc(source->block_bytes);
    bool ok = block || err_memory(err, "a checkpoint", source->block_bytes);
    for (uint64_t at = 0, number = 0; ok && at < source->bytes; at += source->block_bytes) {
        uint64_t left = source->bytes - at;
        uint64_t bytes = left < source->block_bytes ? left : source->block_bytes;
        const char *content = source->records ? source->records + at : block;
        ok = source->records ||
             film_copy_get_bytes(source->renderer, source->first + at, block, bytes, err);
        uint64_t hash = ok ? hash_block(head_hash, number++, content, bytes) : 0;
        ok = ok && file_writer_write(&out->writer, content, bytes, err) &&
             file_writer_write(&out->writer, &hash, sizeof hash, err);
    }
    free(block);
    return ok;
}

static uint64_t head_bytes(const struct header *header)
{
    return sizeof *header + header->identity_bytes + header->command_bytes +
           sizeof(uint64_t) * (uint64_t)header->state_count +
           2 * sizeof(uint32_t) * (uint64_t)header->tile_count;
}

static uint64_t block_count(const struct header *header)
{
    return (header->film_bytes + header->block_bytes - 1) / header->block_bytes;
}

static uint64_t file_bytes(const struct header *header)
{
    return head_bytes(header) + sizeof(uint64_t) + header->film_bytes +
           sizeof(uint64_t) * block_count(header);
}

static bool write_file(const char *path, const struct checkpoint_text *text,
                       const uint64_t state[CHECKPOINT_STATE_WORDS], const struct tiles *tiles,
                       const struct source *source, struct err *err)
{
    struct output out = {.hash = HASH_INIT};
    uint64_t list_bytes = tiles->count * sizeof *tiles->counts;
    struct header header = {
        .version = VERSION,
        .byte_order = BYTE_ORDER_WORD,
        .identity_bytes = strlen(text->identity),
        .command_bytes = strlen(text->command),
        .film_bytes = source->bytes,
        .block_bytes = (uint32_t)source->block_bytes,
        .state_count = CHECKPOINT_STATE_WORDS,
        .tile_count = tiles->count,
    };
    memcpy(header.magic, magic, sizeof magic);
    header.head_bytes = head_bytes(&header);
    header.file_bytes = file_bytes(&header);
    if (!file_writer_open(&out.writer, path, err))
        return false;
    bool ok = put(&out, &header, sizeof header, err) &&
              put(&out, text->identity, header.identity_bytes, err) &&
              put(&out, text->command, header.command_bytes, err) &&
              put(&out, state, CHECKPOINT_STATE_WORDS * sizeof *state, err) &&
              put(&out, tiles->counts, list_bytes, err) &&
              put(&out, tiles->done, list_bytes, err) &&
              file_writer_write(&out.writer, &out.hash, sizeof out.hash, err) &&
              put_film(&out, source, err);
    if (ok)
        return file_writer_commit(&out.writer, err);
    file_writer_finish(&out.writer);
    return false;
}

// Returns the size of a block: a whole number of records.
static uint64_t block_bytes(uint32_t aovs)
{
    return CHECKPOINT_BLOCK_BYTES - CHECKPOINT_BLOCK_BYTES % (16 * AOV_FILM_WORDS(aovs));
}

bool checkpoint_write(struct renderer *r, const char *path, const struct checkpoint_text *text,
                      const uint64_t note[CHECKPOINT_NOTE_WORDS], struct err *err)
{
    const struct film_range range = film_copy_range(r);
    const struct source source = {.renderer = r,
                                  .first = range.first,
                                  .bytes = range.bytes,
                                  .block_bytes = block_bytes(r->specialization.aovs)};
    uint64_t state[CHECKPOINT_STATE_WORDS] = {0};
    struct film_copy film = film_copy_state(r);
    visit_state(&(struct cursor){.words = state}, &film);
    memcpy(&state[NOTE_AT], note, CHECKPOINT_NOTE_WORDS * sizeof *note);
    return write_file(path, text, state, &r->tiles, &source, err);
}

bool checkpoint_write_copy(const struct film_copy *film, uint64_t bytes, uint32_t aovs,
                           const struct tiles *tiles, const char *path,
                           const struct checkpoint_text *text,
                           const uint64_t note[CHECKPOINT_NOTE_WORDS], struct err *err)
{
    const struct source source = {
        .records = film->records, .bytes = bytes, .block_bytes = block_bytes(aovs)};
    uint64_t state[CHECKPOINT_STATE_WORDS] = {0};
    struct film_copy copy = *film;
    visit_state(&(struct cursor){.words = state}, &copy);
    memcpy(&state[NOTE_AT], note, CHECKPOINT_NOTE_WORDS * sizeof *note);
    return write_file(path, text, state, tiles ? tiles : &(struct tiles){0}, &source, err);
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
           err_set(err, ERR_INPUT, "%s: its size cannot be determined: %s", c->path,
                   strerror(errno));
}

static bool fail_damaged(const struct checkpoint *c, const char *where, struct err *err)
{
    return err_set(err, ERR_INPUT,
                   "%s: is damaged: the hash of %s does not match; expected the file as it was "
                   "written",
                   c->path, where);
}

static bool check_header(const struct checkpoint *c, const struct header *h, uint64_t bytes,
                         struct err *err)
{
    if (memcmp(h->magic, magic, sizeof magic) != 0)
        return err_set(err, ERR_INPUT, "%s: is not a checkpoint of lampyris", c->path);
    if (h->version != VERSION || h->byte_order != BYTE_ORDER_WORD ||
        h->state_count != CHECKPOINT_STATE_WORDS)
        return err_set(err, ERR_INPUT,
                       "%s: is a checkpoint of version %u from another build or machine; expected "
                       "version %u from this build",
                       c->path, h->version, VERSION);
    if (h->file_bytes != bytes)
        return err_set(err, ERR_INPUT, "%s: has %" PRIu64 " bytes; expected %" PRIu64, c->path,
                       bytes, h->file_bytes);
    if (h->identity_bytes > CHECKPOINT_TEXT_MAX || h->command_bytes > CHECKPOINT_TEXT_MAX ||
        h->film_bytes > bytes || (uint64_t)h->tile_count > bytes / 8 || h->block_bytes == 0 ||
        h->block_bytes > CHECKPOINT_BLOCK_BYTES || h->is_zero != 0 ||
        head_bytes(h) != h->head_bytes || file_bytes(h) != bytes)
        return err_set(err, ERR_INPUT,
                       "%s: is damaged: the sizes in its header do not fit %" PRIu64 " bytes",
                       c->path, bytes);
    return true;
}

// Reads bytes that precede the film, and adds them to the hash.
static bool get_head(struct checkpoint *c, void *data, uint64_t bytes, struct err *err)
{
    if (!get(c, data, bytes, err))
        return false;
    c->head_hash = hash_bytes(c->head_hash, data, bytes);
    return true;
}

static bool read_head(struct checkpoint *c, const struct header *h, struct arena *arena,
                      struct err *err)
{
    char *identity = ARENA_NEW(arena, char, h->identity_bytes + 1);
    char *command = ARENA_NEW(arena, char, h->command_bytes + 1);
    c->tile_count = h->tile_count;
    c->counts = ARENA_NEW(arena, uint32_t, h->tile_count);
    c->done = ARENA_NEW(arena, uint32_t, h->tile_count);
    if (!identity || !command || !c->counts || !c->done)
        return err_memory(err, "a checkpoint", h->head_bytes);
    c->identity = identity;
    c->command = command;
    c->film_bytes = h->film_bytes;
    c->block_bytes = h->block_bytes;
    uint64_t list_bytes = h->tile_count * sizeof *c->counts, hash;
    if (!get_head(c, identity, h->identity_bytes, err) ||
        !get_head(c, command, h->command_bytes, err) ||
        !get_head(c, c->state, sizeof c->state, err) || !get_head(c, c->counts, list_bytes, err) ||
        !get_head(c, c->done, list_bytes, err) || !get(c, &hash, sizeof hash, err))
        return false;
    if (hash != c->head_hash)
        return fail_damaged(c, "the part before its film", err);
    memcpy(c->note, &c->state[NOTE_AT], sizeof c->note);
    return true;
}

bool checkpoint_read(FILE *file, const char *path, struct arena *arena, struct checkpoint *out,
                     struct err *err)
{
    *out = (struct checkpoint){.file = file, .path = path, .head_hash = HASH_INIT};
    uint64_t bytes;
    struct header header;
    if (!measure(out, &bytes, err))
        return false;
    if (bytes < sizeof header + sizeof(uint64_t))
        return err_set(err, ERR_INPUT,
                       "%s: is not a checkpoint of lampyris: it has %" PRIu64 " bytes", path,
                       bytes);
    return get_head(out, &header, sizeof header, err) && check_header(out, &header, bytes, err) &&
           read_head(out, &header, arena, err);
}

uint64_t checkpoint_next_bytes(const struct checkpoint *c)
{
    uint64_t at = c->block * c->block_bytes;
    uint64_t left = at < c->film_bytes ? c->film_bytes - at : 0;
    return left < c->block_bytes ? left : c->block_bytes;
}

bool checkpoint_next_block(struct checkpoint *c, void *block, struct err *err)
{
    uint64_t bytes = checkpoint_next_bytes(c), hash;
    if (!get(c, block, bytes, err) || !get(c, &hash, sizeof hash, err))
        return false;
    if (hash_block(c->head_hash, c->block, block, bytes) != hash)
        return fail_damaged(c, "a block of its film", err);
    c->block++;
    return true;
}

bool checkpoint_open(const char *path, struct arena *arena, struct checkpoint *out, struct err *err)
{
    *out = (struct checkpoint){0};
    if (file_is_special(path))
        return err_set(err, ERR_INPUT, "%s: is not a regular file; expected a checkpoint", path);
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

struct film_copy checkpoint_film(const struct checkpoint *c)
{
    uint64_t state[CHECKPOINT_STATE_WORDS];
    struct film_copy film = {0};
    memcpy(state, c->state, sizeof state);
    visit_state(&(struct cursor){.words = state, .reads = true}, &film);
    return film;
}

// --- continuing from a checkpoint ----------------------------------------------------------------

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

bool checkpoint_compare(const char *path, const char *was, const char *whose, const char *is,
                        struct err *err)
{
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
        return err_set(err, ERR_INPUT, "%s: was made with %.*s, but %s has %.*s", path,
                       line_length(was), was, whose, line_length(value), value);
    }
    // The names differ although all lines before them are equal. The lines before a line determine
    // its name, so the file is from another build.
    return err_set(
        err, ERR_INPUT,
        "%s: was made by another build of lampyris, which records \"%.*s\" where this one "
        "records \"%.*s\"; expected a checkpoint of this build",
        path, name_length(was), was, name_length(is), is);
}

bool checkpoint_check(const struct checkpoint *c, const char *identity, struct err *err)
{
    return checkpoint_compare(c->path, c->identity, "this run", identity, err);
}

static bool upload_film(struct checkpoint *c, struct renderer *r, struct err *err)
{
    const uint64_t first = film_copy_range(r).first;
    char *block = malloc(c->block_bytes);
    bool ok = block || err_memory(err, "a checkpoint", c->block_bytes);
    for (uint64_t at = 0, bytes; ok && (bytes = checkpoint_next_bytes(c)) > 0; at += bytes)
        ok = checkpoint_next_block(c, block, err) &&
             film_copy_put_bytes(r, first + at, block, bytes, err);
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
        return err_set(err, ERR_INPUT, "%s: contains a renderer state that is not valid", c->path);
    return r->pass.position == 0 || 1u << r->pass.shift <= r->plan.wave_samples ||
           err_set(err, ERR_INPUT,
                   "%s: was written during a pass of %u samples per pixel, but a wave of this run "
                   "has only %u samples; expected a larger --wave",
                   c->path, 1u << r->pass.shift, r->plan.wave_samples);
}

bool checkpoint_restore(struct checkpoint *c, struct renderer *r, struct err *err)
{
    const uint64_t bytes = film_copy_range(r).bytes;
    if (c->film_bytes != bytes)
        return err_set(err, ERR_INPUT,
                       "%s: was made with a film of %s, but this run has %s; expected the same "
                       "--size and --aov",
                       c->path, memory_print(c->film_bytes).text, memory_print(bytes).text);
    bool has_tiles = r->specialization.features & FEATURE_TILES;
    uint32_t across = tiles_along(r->frame.width), down = tiles_along(r->frame.height);
    if (c->tile_count != (has_tiles ? across * down : 0))
        return err_set(err, ERR_INPUT, "%s: has %u tiles; expected %u", c->path, c->tile_count,
                       has_tiles ? across * down : 0);
    struct film_copy film = film_copy_state(r);
    visit_state(&(struct cursor){.words = c->state, .reads = true}, &film);
    r->next_sample = film.next_sample;
    r->round_target = film.round_target;
    r->emptied_at = film.emptied_at;
    r->pass = film.pass;
    r->stats = film.stats;
    if (!check_state(c, r, err))
        return false;
    if (r->pass.position == 0)
        r->pass = (struct pass){0}; // the pass has not begun: this run may choose another shift
    if (has_tiles) {
        struct tile_plan plan = tile_plan_of(r->frame.width, r->frame.height, c->counts);
        if (!renderer_set_plan(r, &plan, err))
            return false;
        memcpy(r->tiles.done, c->done, c->tile_count * sizeof *c->done);
    }
    return upload_film(c, r, err);
}
