// Shards, each of which renders some of the samples, or some rows, of a picture that several
// processes share. This file also prepares the job that writes the picture of a merged film.
#include "job/job_internal.h"

#include "base/log.h"
#include "render/adaptive.h"
#include "render/sampling_plan.h"
#include <inttypes.h>
#include <string.h>

bool job_is_shard(const struct job *job)
{
    return job->params.shard.count > 0 || job->params.shard.range.end > 0;
}

// Refuses settings with which the film is not a sum that can be computed in any order.
bool job_check_divisible(const struct job *job, enum job_division division, struct err *err)
{
    static const char *const names[] = {
        [JOB_BY_SAMPLES] = "--shard",
        [JOB_BY_ROWS] = "--shard-by tiles",
        [JOB_BY_CREW] = "several devices (--device) or ranks (mpirun)",
    };
    const struct job_goal *goal = &job->params.goal;
    const struct settings *settings = &job->scene->settings;
    const bool is_crew = division == JOB_BY_CREW;
    const char *what = NULL, *why = NULL;
    if (goal->adaptive && is_crew) {
        what = "--adaptive on";
        why = "they share the samples of the whole picture, but its tiles have different numbers "
              "of samples; expected --adaptive off, or one device, or parts by rows, each on a "
              "device of its own: --shard I/N --shard-by tiles --device INDEX";
    } else if (goal->adaptive && division == JOB_BY_SAMPLES) {
        what = "--adaptive on";
        why = "its tiles have different numbers of samples, but parts have the same samples of "
              "all pixels; expected --adaptive off, or --shard-by tiles";
    } else if (goal->frames) {
        what = "--frames";
        why = is_crew ? "they share the samples of one picture; expected --spp, or one device"
                      : "all parts have samples of one picture; expected --spp";
    } else if (settings->accumulation != ACCUMULATION_BINNED) {
        what = "--accumulation sum or running";
        why = "these sums depend on the order of samples; expected --accumulation binned";
    } else if (settings->halves == HALVES_CONTIGUOUS && division != JOB_BY_ROWS) {
        what = "--halves contiguous";
        why = is_crew ? "every block of samples needs equally many of both halves; expected "
                        "--halves independent, or one device"
                      : "every part needs equally many samples of both halves; expected --halves "
                        "independent";
    }
    return !what ||
           err_set(err, ERR_USAGE, "%s cannot be combined with %s: %s", names[division], what, why);
}

// Refuses goals that depend on samples of other shards.
static bool check_goal(const struct job *job, struct err *err)
{
    const struct job_goal *goal = &job->params.goal;
    if (goal->error > 0.0)
        return err_set(err, ERR_USAGE,
                       "--shard cannot be combined with --error, which is the error of all shards "
                       "together; expected only --spp, and merge, which reports the error");
    if (goal->seconds > 0.0)
        return err_set(err, ERR_USAGE,
                       "--shard cannot be combined with --time: the samples of a shard must not "
                       "depend on the clock; expected only --spp");
    if (job->params.reference && job->params.shard.by_tiles)
        return err_set(err, ERR_USAGE,
                       "--shard-by tiles cannot be combined with --reference, which compares whole "
                       "pictures; expected merge, and then compare");
    return job_check_divisible(job, job->params.shard.by_tiles ? JOB_BY_ROWS : JOB_BY_SAMPLES, err);
}

static bool settle_rows(struct job *job, struct err *err)
{
    const struct job_shard *shard = &job->params.shard;
    const uint32_t rows = job->scene->settings.height, tiles = tiles_along(rows);
    if (shard->count > tiles)
        return err_set(err, ERR_USAGE,
                       "--shard %u/%u --shard-by tiles: a shard needs at least one row of tiles, "
                       "%u pixels high, and the picture has %u of them; expected at most %u "
                       "shards, or --shard-by samples",
                       shard->index, shard->count, TILE_SIDE, tiles, tiles);
    struct sample_range range = shard->range;
    if (shard->count > 0)
        range = rows_of_part(shard->index, shard->count, rows, TILE_SIDE);
    const bool is_whole = range.first % TILE_SIDE == 0 &&
                          (range.end % TILE_SIDE == 0 || range.end == rows) && range.end <= rows;
    if (!is_whole)
        return err_set(err, ERR_USAGE,
                       "--shard %" PRIu64 ":%" PRIu64 " --shard-by tiles: expected rows of pixels, "
                       "in multiples of %u up to the %u rows of the picture",
                       range.first, range.end, TILE_SIDE, rows);
    job->rows = range;
    return true;
}

bool job_settle_shard(struct job *job, struct err *err)
{
    const struct job_shard *shard = &job->params.shard;
    const uint64_t samples = job->samples_most;
    if (!job_is_shard(job))
        return true;
    if (!check_goal(job, err))
        return false;
    if (shard->by_tiles)
        return settle_rows(job, err);
    if (shard->count > 1 && shard->count > samples / 2)
        return err_set(
            err, ERR_USAGE,
            "--shard %u/%u: a shard needs at least two samples per pixel, and the render has "
            "%" PRIu64 "; expected at most %" PRIu64 " shards, or a larger --spp",
            shard->index, shard->count, samples, samples < 2 ? UINT64_C(1) : samples / 2);
    struct sample_range range = shard->range;
    if (shard->count > 0)
        range = samples_of_part(shard->index, shard->count, samples);
    bool is_even = range.first % 2 == 0 && (range.end % 2 == 0 || range.end == samples);
    if (!is_even || range.end > samples)
        return err_set(err, ERR_USAGE,
                       "--shard %" PRIu64 ":%" PRIu64 ": expected even numbers up to the %" PRIu64
                       " samples of --spp (the end may be an odd --spp)",
                       range.first, range.end, samples);
    job->samples_first = range.first;
    job->samples_most = range.end;
    return true;
}

bool job_check_merged(struct job *job, struct err *err)
{
    static const char *const names[] = {JOB_SHARD_LINE, JOB_DEVICE_LINE, JOB_DRIVER_LINE};
    const struct job_merged *merged = job->params.merged;
    if (!merged)
        return true;
    struct arena arena = {0};
    const char *own = job_identity(job), *of_parts[2] = {0}, *of_job[2] = {0};
    for (uint32_t i = 0; own && i < 2; i++) { // 0: with the device and driver; 1: without them
        of_parts[i] = job_identity_without(merged->identity, names, i == 0 ? 1 : 3, &arena);
        of_job[i] = job_identity_without(own, names, i == 0 ? 1 : 3, &arena);
    }
    bool ok = of_parts[0] && of_parts[1] && of_job[0] && of_job[1];
    if (!ok)
        err_memory(err, "a merged film", 4 * CHECKPOINT_TEXT_MAX);
    else
        ok = checkpoint_compare("the sum of the parts", of_parts[1], "the present scene", of_job[1],
                                err);
    if (ok && !merged->devices && strcmp(of_parts[0], of_job[0]) != 0)
        log_warn("%s (%s) is not the device, or not the driver, of the parts: it computes the "
                 "means from their sums, and may round them differently; expected --device",
                 job->gpu->info.name, job->gpu->info.driver);
    arena_finish(&arena);
    return ok;
}

uint64_t job_steps(const struct job *job)
{
    return job->samples_most / job_step_samples(job);
}

// Puts the merged film into the renderer. The plan of the tiles is that of the parts, so no pilot
// is needed.
static bool put_merged(struct job *job, struct job_merged *merged, struct err *err)
{
    struct renderer *r = &job->renderer;
    merged->film.seed = r->frame.seed;
    merged->film.emptied_at = 0;
    merged->film.next_sample = merged->film.round_target = job_steps(job); // no sample is missing
    merged->film.pass = (struct pass){0};
    if (merged->counts) {
        const struct tile_plan plan = tile_plan_of(r->frame.width, r->frame.height, merged->counts);
        if (!renderer_set_plan(r, &plan, err))
            return false;
        job->plan = tile_plan_of(r->frame.width, r->frame.height, r->tiles.counts);
    }
    return film_copy_put(&merged->film, r, err);
}

bool job_begin_shard(struct job *job, struct err *err)
{
    struct renderer *r = &job->renderer;
    struct job_merged *merged = job->params.merged;
    if (job->rows.end > 0)
        renderer_set_rows(r,
                          &(struct film_rows){(uint32_t)job->rows.first, (uint32_t)job->rows.end});
    else if (job_is_shard(job))
        r->next_sample = r->emptied_at = job->samples_first;
    r->takes_pairs = job_is_shard(job);
    if (!merged)
        return true;
    bool ok = put_merged(job, merged, err);
    arena_finish(&merged->arena);
    merged->film.records = NULL;
    merged->film.done = merged->counts = NULL;
    r->stats.render_seconds = merged->film.stats.render_seconds;
    return ok;
}
