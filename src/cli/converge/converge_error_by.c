// Option --error-by: splits the error of the last images of a curve by its sources.
#include "cli/converge/converge.h"

bool converge_split_error(struct converge *c, struct converge_curve *curve, uint32_t replicate,
                          struct err *err)
{
    if (!c->options->error_by)
        return true;
    if (!curve->sources)
        curve->sources = ARENA_NEW(&c->arena, struct error_sources, c->replicate_count);
    if (!curve->sources)
        return err_memory(err, "shares of the error", c->replicate_count * sizeof *curve->sources);
    return job_find_sources(&curve->job, &curve->sources[replicate], err);
}

// Returns why there is no split, or NULL. All replicates of a curve have the same number of
// samples, so either all have a split or each gives a reason.
static const char *find_reason(const struct converge *c, const struct converge_curve *curve)
{
    for (uint32_t r = 0; r < c->replicates_done; r++)
        if (curve->sources[r].reason)
            return curve->sources[r].reason;
    return NULL;
}

bool converge_pool_sources(struct converge *c, struct converge_curve *curve, struct err *err)
{
    if (!curve->sources)
        return true;
    struct error_by *pictures = ARENA_NEW(&c->arena, struct error_by, c->replicates_done);
    if (!pictures)
        return err_memory(err, "shares of the error", c->replicates_done * sizeof *pictures);
    curve->pooled = (struct error_sources){
        .kinds = curve->sources[0].kinds,
        .reason = find_reason(c, curve),
        .has_intervals = c->replicates_done > 1,
    };
    for (int kind = 0; kind < ERROR_KIND_COUNT && !curve->pooled.reason; kind++) {
        if (!(curve->pooled.kinds & error_kind_aov((enum error_kind)kind)))
            continue;
        for (uint32_t r = 0; r < c->replicates_done; r++)
            pictures[r] = curve->sources[r].by[kind];
        metrics_error_by_pool(pictures, c->replicates_done, &curve->pooled.by[kind]);
    }
    return true;
}
