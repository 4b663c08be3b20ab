// Adds the blocks that ranks of a lost run have saved (blocks.c): reads their files, renders the
// samples between them, and adds both to the film. Sums of samples do not depend on their order, so
// the bits are those of one run. A file that cannot be added is renamed, so that it is neither
// replaced nor removed.
#include "job/job_internal.h"

#include "base/file_inputs.h"
#include "base/file_system.h"
#include "base/log.h"
#include "shared/aov.h"
#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#define UNUSED_MARK ".unused-blocks-" // in the names of files that were not added

// --- reading -------------------------------------------------------------------------------------

static bool read_ranges(const struct checkpoint *c, struct arena *arena, struct sample_ranges *out,
                        struct err *err)
{
    const char *line = strstr(c->identity, "\n" JOB_SHARD_LINE);
    const char *text = line ? line + strlen("\n" JOB_SHARD_LINE) : "";
    return (samples_parse(text, strcspn(text, "\n"), arena, out) && out->count > 0) ||
           err_set(err, ERR_INPUT, "%s: its list of samples is not readable", c->path);
}

static bool read_film(struct checkpoint *c, char *records, struct arena *arena, struct err *err)
{
    char *block = ARENA_NEW(arena, char, CHECKPOINT_BLOCK_BYTES);
    if (!block)
        return err_memory(err, "a block of a film", CHECKPOINT_BLOCK_BYTES);
    for (uint64_t at = 0, bytes; (bytes = checkpoint_next_bytes(c)) > 0; at += bytes) {
        if (!checkpoint_next_block(c, block, err))
            return false;
        memcpy(records + at, block, bytes);
    }
    return true;
}

// Leaves out a file of this render. It is removed when a checkpoint has its samples.
static bool leave_out_late(struct job *job, const char *path, uint64_t end)
{
    log_warn("%s: has samples up to %" PRIu64 ", but the film is needed at %" PRIu64
             " first; these samples are rendered again",
             path, end, job_next_stop(job));
    return true;
}

// The file of rank 0 has all samples of the checkpoint, and perhaps newer ones, so its film
// replaces that of the checkpoint.
static bool replace_base(struct job *job, struct checkpoint *c, const struct sample_ranges *ranges,
                         struct arena *arena, struct err *err)
{
    struct renderer *r = &job->renderer;
    struct film_copy film = checkpoint_film(c);
    const uint64_t end = ranges->list[ranges->count - 1].end, before = r->next_sample;
    const double seconds = film.stats.render_seconds;
    film.records = ARENA_NEW(arena, char, film_copy_bytes(r));
    if (!film.records)
        return err_memory(err, "a film", film_copy_bytes(r));
    if (!read_film(c, film.records, arena, err))
        return false;
    memcpy(&job->looks_error, &c->note[JOB_NOTE_ERROR], sizeof job->looks_error);
    job->next_look = c->note[JOB_NOTE_NEXT_LOOK];
    r->next_sample = ranges->list[0].end;
    if (end > job_next_stop(job)) {
        r->next_sample = before;
        return leave_out_late(job, c->path, end);
    }
    film.seed = r->frame.seed;
    film.emptied_at = r->emptied_at;
    film.next_sample = ranges->list[0].end;
    for (uint32_t i = 0; i < ranges->count; i++)
        if (i == 0 ? !job_hold_only(job, &ranges->list[i], err)
                   : !job_hold(job, &ranges->list[i], err))
            return false;
    if (!film_copy_put(&film, r, err))
        return false;
    r->stats.render_seconds = seconds;
    return true;
}

static bool add_film(struct job *job, struct checkpoint *c, const struct sample_ranges *ranges,
                     struct arena *arena, struct err *err)
{
    struct job_saved_blocks *saved = &job->saved;
    const uint64_t bytes = film_copy_bytes(&job->renderer);
    struct film_copy *to = &saved->film.copy;
    struct sample_ranges joined;
    // A damaged file must leave the sum as it was, so the film is read before it is added.
    char *records = ARENA_NEW(arena, char, bytes);
    if (!records)
        return err_memory(err, "a film", bytes);
    if (!read_film(c, records, arena, err) ||
        !samples_join(&saved->ranges, ranges, &saved->arena, &joined, err))
        return false;
    if (!to->records && !(to->records = ARENA_NEW(&saved->arena, char, bytes)))
        return err_memory(err, "a film", bytes);
    const struct film_copy film = checkpoint_film(c);
    const struct crew_film part = {
        .copy = {.records = records, .emptied_at = ranges->list[0].first, .stats = film.stats},
        .has_samples = true,
    };
    crew_add(job->renderer.specialization.aovs, bytes, &part, &saved->film);
    saved->ranges = joined;
    return true;
}

// Refuses a file that does not belong to this render.
static bool check_blocks(struct job *job, const struct checkpoint *c, struct arena *arena,
                         struct err *err)
{
    const struct renderer *r = &job->renderer;
    const char *was = blocks_identity(c->identity, arena);
    const char *is = blocks_identity(job_identity(job), arena);
    if (!was || !is)
        return err_memory(err, "saved blocks", CHECKPOINT_TEXT_MAX);
    if (!checkpoint_compare(c->path, was, "this render", is, err))
        return false;
    return (c->film_bytes == film_copy_bytes(r) && c->tile_count == 0 &&
            c->block_bytes % (16 * AOV_FILM_WORDS(r->specialization.aovs)) == 0) ||
           err_set(err, ERR_INPUT, "%s: its film does not belong to this render", c->path);
}

// Adds one file, if it has samples that the film lacks.
static bool take_file(struct job *job, const char *path, struct arena *arena, struct err *err)
{
    struct checkpoint c = {0};
    struct sample_ranges ranges;
    struct sample_range common;
    const uint64_t next = job->renderer.next_sample;
    bool ok = file_inputs_add_own(path, err) && checkpoint_open(path, arena, &c, err) &&
              check_blocks(job, &c, arena, err) && read_ranges(&c, arena, &ranges, err);
    const uint64_t end = ok ? ranges.list[ranges.count - 1].end : 0;
    if (ok && ranges.list[0].first == job->samples_first) {
        if (ranges.list[0].end >= next && end > next && end <= job->samples_most)
            ok = replace_base(job, &c, &ranges, arena, err);
    } else if (ok && !samples_overlap(&job->held, &ranges, &common) &&
               !samples_overlap(&job->saved.ranges, &ranges, &common)) {
        ok = end <= job_next_stop(job) ? add_film(job, &c, &ranges, arena, err)
                                       : leave_out_late(job, path, end);
    }
    checkpoint_close(&c);
    return ok;
}

static int compare_firsts(const void *a, const void *b)
{
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

static bool can_have_blocks(struct job *job)
{
    const struct renderer *r = &job->renderer;
    struct err why;
    return job->params.checkpoint.path && job->params.checkpoint.resume && !job_is_shard(job) &&
           !job->params.merged && r->pass.position == 0 && r->next_sample % 2 == 0 &&
           job_check_divisible(job, JOB_BY_CREW, &why);
}

// Renames a file that cannot be added, because files of this run may get its name.
static bool set_aside(const char *path, uint64_t first, const struct err *why, struct arena *arena,
                      struct err *err)
{
    const char *from = arena_printf(arena, "%s" BLOCKS_MARK "%" PRIu64, path, first);
    const char *to = arena_printf(arena, "%s" UNUSED_MARK "%" PRIu64, path, first);
    for (uint32_t i = 2; to && file_exists(to); i++)
        to = arena_printf(arena, "%s" UNUSED_MARK "%" PRIu64 "-%u", path, first, i);
    if (!from || !to)
        return err_memory(err, "a path", strlen(path));
    if (!file_rename(from, to))
        return err_set(err, ERR_OUTPUT, "%s; it cannot be renamed to %s: %s", why->msg, to,
                       strerror(errno));
    log_warn("%s; these samples are rendered again, and the file is kept as %s", why->msg, to);
    return true;
}

bool job_open_blocks(struct job *job, struct err *err)
{
    const char *path = job->params.checkpoint.path;
    struct blocks_firsts firsts = {0};
    struct job_saved_blocks *saved = &job->saved;
    if (path)
        blocks_list(path, &saved->arena, &firsts);
    // Files that are not looked at are kept. With none, all files will be those of this run.
    job->removes_blocks = firsts.count == 0 || can_have_blocks(job);
    if (!can_have_blocks(job))
        return true;
    if (!job_hold_only(job, &(struct sample_range){job->samples_first, job->renderer.next_sample},
                       err))
        return false;
    const uint64_t before = samples_count(&job->held);
    if (firsts.count > 0) // the file of rank 0 comes first
        qsort(firsts.list, firsts.count, sizeof *firsts.list, compare_firsts);
    for (uint32_t i = 0; i < firsts.count; i++) {
        struct arena arena = {0};
        struct err failure = {0};
        const char *name =
            arena_printf(&saved->arena, "%s" BLOCKS_MARK "%" PRIu64, path, firsts.list[i]);
        bool ok = name ? take_file(job, name, &arena, &failure)
                       : err_memory(&failure, "a path", strlen(path));
        arena_finish(&arena);
        if (!ok && failure.code != ERR_INPUT) {
            *err = failure;
            return false;
        }
        if (!ok && !set_aside(path, firsts.list[i], &failure, &saved->arena, err))
            return false;
    }
    const uint64_t found = samples_count(&job->held) + samples_count(&saved->ranges) - before;
    if (found == 0)
        return true;
    job->has_checkpoint = true;
    saved->end = job->held.count > 0 ? job->held.list[job->held.count - 1].end : 0;
    if (saved->ranges.count > 0 && saved->ranges.list[saved->ranges.count - 1].end > saved->end)
        saved->end = saved->ranges.list[saved->ranges.count - 1].end;
    log_warn("%s: %" PRIu64
             " samples per pixel are added, which ranks of a lost run had saved after "
             "the checkpoint",
             path, found);
    return true;
}

// --- filling -------------------------------------------------------------------------------------

static bool render_gap(struct job *job, const struct sample_range *gap, struct err *err)
{
    struct renderer *r = &job->renderer;
    const struct job_step step = {.samples = gap->end};
    const struct sample_ranges none = {0};
    struct sample_ranges before, joined;
    r->next_sample = gap->first;
    bool ok = samples_join(&job->held, &none, &job->arena, &before, err) &&
              job_rescue_begin(job, err) &&
              (job->params.crew ? job_advance_crew_once(job, &step, err)
                                : job_render_to(job, &step, gap->end, 0.0, 0.0, err));
    struct sample_range done = {gap->first, r->next_sample};
    const struct sample_ranges one = {&done, done.end > done.first};
    if (!ok || !samples_join(&before, &one, &job->arena, &joined, err))
        return false;
    job->held = joined;
    job->held_capacity = joined.count;
    return true;
}

static bool add_saved(struct job *job, struct err *err)
{
    struct renderer *r = &job->renderer;
    struct job_saved_blocks *saved = &job->saved;
    struct arena arena = {0};
    struct crew_film film = {.has_samples = true};
    const double seconds = r->stats.render_seconds;
    bool ok = true;
    if (saved->film.has_samples) {
        ok = film_copy_take(r, false, &arena, &film.copy, err);
        film.copy.emptied_at = job->samples_first;
        if (ok)
            crew_add(r->specialization.aovs, film_copy_bytes(r), &saved->film, &film);
        film.copy.next_sample = saved->end;
        ok = ok && film_copy_put(&film.copy, r, err);
        r->stats.render_seconds = seconds;
    }
    r->next_sample = saved->end;
    const struct sample_range all = {job->samples_first, saved->end};
    arena_finish(&arena);
    arena_finish(&saved->arena);
    *saved = (struct job_saved_blocks){0};
    return ok && job_hold_only(job, &all, err);
}

bool job_fill_blocks(struct job *job, struct err *err)
{
    struct job_saved_blocks *saved = &job->saved;
    struct sample_ranges all, gaps;
    struct err failure = {0};
    if (saved->end == 0)
        return true;
    if (!samples_join(&job->held, &saved->ranges, &job->arena, &all, err) ||
        !samples_missing(&all, saved->end, &job->arena, &gaps, err))
        return false;
    for (uint32_t i = 0; i < gaps.count; i++) {
        if (!render_gap(job, &gaps.list[i], err))
            return false;
        if (job_is_stopped(job)) {
            log_warn("stopped before all samples between the saved blocks were rendered: no --spp "
                     "renders this picture again, but --resume continues");
            return true;
        }
    }
    if (!add_saved(job, err) || !job_rescue_begin(job, err))
        return false;
    if (!job_checkpoint_save(job, &failure))
        log_warn("no checkpoint was written: %s", failure.msg);
    return true;
}
