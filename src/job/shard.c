// A render of some of the samples, for several processes to share one, and the film that was merged
// of all of them.
#include "job/job_internal.h"

#include "base/log.h"
#include "render/sampling_plan.h"
#include <inttypes.h>
#include <string.h>

bool job_is_shard(const struct job *job)
{
    return job->params.shard.count > 0 || job->params.shard.samples.end > 0;
}

// Only sums that have no order can be those of several.
bool job_check_divisible(const struct job *job, const char *whose, struct err *err)
{
    const struct job_goal *goal = &job->params.goal;
    const struct settings *settings = &job->scene->settings;
    const char *what = NULL, *why = NULL;
    if (goal->adaptive) {
        what = "--adaptive on";
        why = "its tiles have different numbers of samples, and parts have the same samples of "
              "all pixels: expected --adaptive off";
    } else if (goal->frames) {
        what = "--frames";
        why = "samples of parts are those of one picture: expected --spp";
    } else if (settings->accumulation != ACCUMULATION_BINNED) {
        what = "--accumulation sum or running";
        why = "these sums depend on the order of samples: expected --accumulation binned";
    } else if (settings->halves == HALVES_CONTIGUOUS) {
        what = "--halves contiguous";
        why = "every part needs as many samples of one half as of the other: expected --halves "
              "independent";
    }
    return !what || err_set(err, ERR_USAGE, "%s cannot be combined with %s: %s", whose, what, why);
}

// A shard cannot know what the others see.
static bool check_goal(const struct job *job, struct err *err)
{
    const struct job_goal *goal = &job->params.goal;
    if (goal->error > 0.0)
        return err_set(err, ERR_USAGE,
                       "--shard cannot be combined with --error: the error is that of all shards "
                       "together, which no shard knows: expected --spp alone; merge reports the "
                       "error");
    if (goal->seconds > 0.0)
        return err_set(err, ERR_USAGE,
                       "--shard cannot be combined with --time: which samples it has must not "
                       "depend on the clock: expected --spp alone");
    return job_check_divisible(job, "--shard", err);
}

bool job_settle_shard(struct job *job, struct err *err)
{
    const struct job_shard *shard = &job->params.shard;
    const uint64_t samples = job->samples_most;
    if (!job_is_shard(job))
        return true;
    if (!check_goal(job, err))
        return false;
    if (shard->count > 1 && shard->count > samples / 2)
        return err_set(
            err, ERR_USAGE,
            "--shard %u/%u: a shard has at least two samples a pixel, and the render has "
            "%" PRIu64 "; expected at most %" PRIu64 " shards, or a larger --spp",
            shard->index, shard->count, samples, samples < 2 ? UINT64_C(1) : samples / 2);
    struct sample_range range = shard->samples;
    if (shard->count > 0)
        range = samples_of_part(shard->index, shard->count, samples);
    bool is_even = range.first % 2 == 0 && (range.end % 2 == 0 || range.end == samples);
    if (!is_even || range.end > samples)
        return err_set(err, ERR_USAGE,
                       "--shard %" PRIu64 ":%" PRIu64 ": expected even numbers up to the %" PRIu64
                       " samples of --spp",
                       range.first, range.end, samples);
    job->samples_first = range.first;
    job->samples_most = range.end;
    return true;
}

bool job_check_merged(struct job *job, struct err *err)
{
    static const char *const names[] = {JOB_SHARD_LINE, "device=", "driver="};
    const struct job_merged *merged = job->params.merged;
    if (!merged)
        return true;
    struct arena arena = {0};
    const char *own = job_identity(job), *of_parts[2] = {0}, *of_job[2] = {0};
    for (uint32_t i = 0; own && i < 2; i++) { // with the device, and without
        of_parts[i] = job_identity_without(merged->identity, names, i == 0 ? 1 : 3, &arena);
        of_job[i] = job_identity_without(own, names, i == 0 ? 1 : 3, &arena);
    }
    bool ok = of_parts[0] && of_parts[1] && of_job[0] && of_job[1];
    if (!ok)
        err_memory(err, "a merged film", 4 * CHECKPOINT_TEXT_MAX);
    else
        ok = checkpoint_compare("the sum of the parts", of_parts[1], "the scene as it is here",
                                of_job[1], err);
    if (ok && strcmp(of_parts[0], of_job[0]) != 0)
        log_warn(
            "%s (%s) is not the device, or not the driver, of the parts: the means are computed "
            "here from their sums, and may be rounded in another way; expected --device",
            job->gpu->info.name, job->gpu->info.driver);
    arena_finish(&arena);
    return ok;
}

bool job_begin_shard(struct job *job, struct err *err)
{
    struct renderer *r = &job->renderer;
    struct job_merged *merged = job->params.merged;
    if (job_is_shard(job))
        r->next_sample = r->emptied_at = job->samples_first;
    if (!merged)
        return true;
    merged->film.seed = r->frame.seed;
    merged->film.emptied_at = 0;
    merged->film.next_sample = job->samples_most; // nothing is to be rendered
    bool ok = film_copy_put(&merged->film, r, err);
    arena_finish(&merged->arena);
    merged->film.records = NULL;
    r->stats.render_seconds = merged->film.stats.render_seconds;
    return ok;
}
