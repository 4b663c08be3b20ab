// The blocks of ranks. A checkpoint has all samples below some index. If a rank is lost before the
// next checkpoint, each other rank saves its film beside the last checkpoint, as a part (merge.h).
// Such a film has blocks of samples with gaps. The next run adds these files (blocks_add.c).
#include "job/job_internal.h"

#include "base/file.h"
#include "base/file_system.h"
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

// --- the samples of a film -----------------------------------------------------------------------

bool job_hold(struct job *job, const struct sample_range *block, struct err *err)
{
    struct sample_ranges *held = &job->held, joined;
    struct sample_range *last = held->count > 0 ? &held->list[held->count - 1] : NULL;
    if (last && last->end == block->first) {
        last->end = block->end;
        return true;
    }
    if (last && last->end > block->first) { // the block is between saved blocks
        const struct sample_ranges one = {&(struct sample_range){block->first, block->end}, 1};
        if (!samples_join(held, &one, &job->arena, &joined, err))
            return false;
        *held = joined;
        job->held_capacity = joined.count;
        return true;
    }
    struct sample_range *added = arena_append(&job->arena, &held->list, &held->count,
                                              &job->held_capacity, sizeof *added, NULL);
    if (!added)
        return err_memory(err, "ranges of samples", sizeof *added);
    *added = *block;
    return true;
}

bool job_hold_only(struct job *job, const struct sample_range *range, struct err *err)
{
    job->held.count = 0;
    job->held_saved = 0;
    return range->first == range->end || job_hold(job, range, err);
}

// --- saving --------------------------------------------------------------------------------------

const char *blocks_identity(const char *identity, struct arena *arena)
{
    static const char *const own_lines[] = {JOB_SHARD_LINE, JOB_SHARD_BY_LINE};
    return job_identity_without(identity, own_lines, 2, arena);
}

static bool write_blocks(struct job *job, const char *path, struct arena *arena, struct err *err)
{
    struct renderer *r = &job->renderer;
    const struct sample_ranges *held = &job->held;
    const char *identity = job_identity(job), *samples = samples_text(held, arena);
    identity = identity ? blocks_identity(identity, arena) : NULL;
    identity = identity && samples
                   ? arena_printf(arena, "%s" JOB_SHARD_BY_LINE "samples\n" JOB_SHARD_LINE "%s\n",
                                  identity, samples)
                   : NULL;
    const char *name = arena_printf(arena, "%s" BLOCKS_MARK "%" PRIu64, path, held->list[0].first);
    struct film_copy film;
    if (!identity || !name)
        return err_memory(err, "saved blocks", CHECKPOINT_TEXT_MAX);
    if (!film_copy_take(r, false, arena, &film, err))
        return false;
    film.emptied_at = held->list[0].first;
    film.next_sample = held->list[held->count - 1].end;
    const struct checkpoint_text text = {identity, job->params.command};
    uint64_t note[CHECKPOINT_NOTE_WORDS];
    job_checkpoint_note(job, note);
    return checkpoint_write_copy(&film, film_copy_bytes(r), r->specialization.aovs, NULL, name,
                                 &text, note, err);
}

bool crew_save(struct job *job, const char *path, struct err *err)
{
    const uint64_t count = samples_count(&job->held);
    struct arena arena = {0};
    if (!path || job->held.count == 0 || count == job->held_saved || job->deal.is_in_block ||
        job->renderer.pass.position > 0)
        return true;
    bool ok = write_blocks(job, path, &arena, err);
    if (ok)
        job->held_saved = count;
    arena_finish(&arena);
    return ok;
}

// --- files ---------------------------------------------------------------------------------------

// Returns whether `name` is the file name of blocks that were saved beside the checkpoint with the
// file name `checkpoint`.
static bool parse_name(const char *name, const char *checkpoint, uint64_t *first)
{
    const size_t length = strlen(checkpoint);
    char *end;
    if (strncmp(name, checkpoint, length) != 0 ||
        strncmp(name + length, BLOCKS_MARK, strlen(BLOCKS_MARK)) != 0)
        return false;
    name += length + strlen(BLOCKS_MARK);
    const bool is_number = *name >= '0' && *name <= '9' && (*name != '0' || name[1] == '\0');
    *first = is_number ? strtoull(name, &end, 10) : 0;
    return is_number && *end == '\0';
}

void blocks_list(const char *path, struct arena *arena, struct blocks_firsts *out)
{
    const char *name = path_name(path);
    const char *folder = name > path ? arena_printf(arena, "%.*s", (int)(name - path), path) : ".";
    struct folder_reader *reader = folder ? folder_open(folder) : NULL;
    uint64_t first;
    for (const char *other; reader && (other = folder_next(reader));) {
        if (!parse_name(other, name, &first))
            continue;
        uint64_t *added =
            arena_append(arena, &out->list, &out->count, &out->capacity, sizeof *added, NULL);
        if (added)
            *added = first;
    }
    folder_close(reader);
}

bool job_check_no_blocks(const char *path, struct err *err)
{
    struct arena arena = {0};
    struct blocks_firsts firsts = {0};
    blocks_list(path, &arena, &firsts);
    const bool is_free = firsts.count == 0;
    if (!is_free)
        err_set(err, ERR_INPUT,
                "%s" BLOCKS_MARK "%" PRIu64
                ": exists already, with samples that a rank of a lost run has "
                "saved; expected --resume, to continue from it, or another name",
                path, firsts.list[0]);
    arena_finish(&arena);
    return is_free;
}

void job_remove_blocks(const struct job *job)
{
    const struct job_checkpoint_params *params = &job->params.checkpoint;
    struct arena arena = {0};
    struct blocks_firsts firsts = {0};
    if (!job->removes_blocks)
        return;
    blocks_list(params->path, &arena, &firsts);
    for (uint32_t i = 0; i < firsts.count; i++) {
        const char *name =
            arena_printf(&arena, "%s" BLOCKS_MARK "%" PRIu64, params->path, firsts.list[i]);
        if (name && firsts.list[i] < job->renderer.next_sample)
            file_remove(name);
    }
    arena_finish(&arena);
}
