#include "cli/bench/tune.h"

#include "base/clock.h"
#include "base/hash.h"
#include <math.h>

// --- one run -------------------------------------------------------------------------------------

static bool resize(struct tune *t, struct tune_scene *scene, struct tuned sizes, bool *fits,
                   struct err *err)
{
    uint32_t wave = sizes.wave / sizes.workgroup * sizes.workgroup;
    struct err failure = {0};
    if (!renderer_resize(&scene->renderer, sizes.wave, sizes.workgroup, &failure)) {
        // Memory that is not there is no reason to end; the next resize makes all buffers anew.
        if (fits && failure.code != ERR_USAGE && !t->gpu.lost) {
            *fits = false;
            return true;
        }
        *err = failure;
        return false;
    }
    if (fits)
        *fits = scene->renderer.plan.wave_slots == (wave ? wave : sizes.workgroup);
    return true;
}

static bool check_picture(struct tune_scene *scene, struct tuned sizes, struct err *err)
{
    struct arena scratch = {0};
    struct film_image film;
    bool ok = renderer_read(&scene->renderer, &scratch, &film, err);
    if (ok) {
        size_t pixels = (size_t)film.width * film.height;
        uint64_t hash = hash_bytes(HASH_INIT, film.mean, pixels * sizeof *film.mean);
        if (!scene->image_hash)
            scene->image_hash = hash;
        if (scene->image_hash != hash)
            ok = err_set(err, ERR_BUG,
                         "%s: waves of %u paths and workgroups of %u threads change the picture",
                         scene->scene.path, sizes.wave, sizes.workgroup);
    }
    arena_finish(&scratch);
    return ok;
}

bool tune_check_pictures(struct tune *t, struct tuned sizes, struct err *err)
{
    for (uint32_t i = 0; i < t->scene_count && !t->stopped; i++)
        if (!check_picture(&t->scenes[i], sizes, err))
            return false;
    return true;
}

bool tune_measure(struct tune *t, struct tuned sizes, double *seconds, bool *fits, struct err *err)
{
    double logs = 0.0;
    for (uint32_t i = 0; i < t->scene_count; i++) {
        struct tune_scene *scene = &t->scenes[i];
        struct renderer *r = &scene->renderer;
        struct render_call call = {.samples = t->samples, .stopped = &t->stopped};
        if (!resize(t, scene, sizes, fits, err))
            return false;
        if (fits && !*fits)
            return true;
        if (!renderer_restart(r, scene->scene.settings.seed, err))
            return false;
        // The renderer asks between the waves of a call, and a call may be one wave.
        t->stopped |= progress_should_stop(t->options->progress);
        uint64_t start = clock_ns();
        if (!t->stopped && !renderer_render(r, &call, err))
            return false;
        // Clocks may be coarse, and pictures small.
        logs += log(fmax(clock_seconds_since(start), 1e-9));
        if (t->stopped)
            return true;
    }
    *seconds = exp(logs / t->scene_count);
    t->runs_done++;
    if (t->runs_planned)
        progress_report(t->options->progress, "Tuning",
                        fmin((double)t->runs_done / t->runs_planned, 1.0));
    return true;
}

// --- rounds --------------------------------------------------------------------------------------

static uint32_t count_left(const struct tune_contest *c)
{
    uint32_t left = 0;
    for (uint32_t i = 0; i < c->count; i++)
        left += c->candidates[i].left;
    return left;
}

static void conclude(struct tune_candidate *candidate)
{
    candidate->speed =
        curve_paired_ratio(candidate->base_seconds, candidate->seconds, candidate->rounds);
}

// The base and all that are left, once each; who is first changes from round to round.
static bool run_round(struct tune *t, struct tune_contest *c, uint32_t number, struct err *err)
{
    double base_seconds = NAN, seconds[TUNE_CANDIDATES];
    for (uint32_t i = 0; i <= c->count && !t->stopped; i++) {
        uint32_t at = (i + number) % (c->count + 1);
        struct tune_candidate *candidate = at < c->count ? &c->candidates[at] : NULL;
        if (!candidate) {
            if (!tune_measure(t, c->base, &base_seconds, NULL, err))
                return false;
            continue;
        }
        if (!candidate->left)
            continue;
        // Whether it fits, and that the picture stays the same, shows at the first time.
        bool *fits = candidate->rounds == 0 ? &candidate->fits : NULL;
        if (!tune_measure(t, candidate->sizes, &seconds[at], fits, err))
            return false;
        candidate->left = candidate->fits;
        if (fits && *fits && !tune_check_pictures(t, candidate->sizes, err))
            return false;
    }
    for (uint32_t i = 0; i < c->count && !t->stopped; i++) {
        struct tune_candidate *candidate = &c->candidates[i];
        if (!candidate->left || candidate->rounds == TUNE_ROUNDS)
            continue;
        candidate->seconds[candidate->rounds] = seconds[i];
        candidate->base_seconds[candidate->rounds++] = base_seconds;
        conclude(candidate);
    }
    return true;
}

static struct tune_candidate *slowest_left(struct tune_contest *c)
{
    struct tune_candidate *slowest = NULL;
    for (uint32_t i = 0; i < c->count; i++) {
        struct tune_candidate *candidate = &c->candidates[i];
        if (candidate->left && (!slowest || candidate->speed.value < slowest->speed.value))
            slowest = candidate;
    }
    return slowest;
}

uint32_t tune_contest_runs(uint32_t candidates)
{
    uint32_t runs = 0;
    for (uint32_t left = candidates; left > 0; left = left > 1 ? (left + 1) / 2 : 0)
        runs += left + 1;
    return runs;
}

bool tune_contest(struct tune *t, enum tune_stage stage, struct tuned base, struct tuned *best,
                  struct err *err)
{
    struct tune_contest *c = &t->contests[stage];
    c->base = *best = base;
    uint32_t round = 0, left = c->count;
    while (left > 0 && !t->stopped) {
        for (uint32_t i = 0; i < t->rounds_at_once && !t->stopped; i++)
            if (!run_round(t, c, round++, err))
                return false;
        left = count_left(c);
        if (left <= 1)
            break;
        for (uint32_t keep = (left + 1) / 2; left > keep; left--)
            slowest_left(c)->left = false;
    }
    const struct tune_candidate *winner = slowest_left(c); // and the fastest: the only one
    if (winner && winner->speed.value > 1.0)
        *best = winner->sizes;
    return true;
}

bool tune_duel(struct tune *t, enum tune_stage stage, uint32_t rounds, struct err *err)
{
    struct tune_contest *c = &t->contests[stage];
    for (uint32_t i = 0; i < rounds && !t->stopped; i++)
        if (!run_round(t, c, i, err))
            return false;
    return true;
}
