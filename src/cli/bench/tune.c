#include "cli/bench/tune.h"

#include "base/clock.h"
#include "base/file.h"
#include "base/log.h"
#include "cli/commands.h"
#include "cli/render/render_job.h"
#include "report/json_out.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define DEFAULT_SECONDS 60.0
#define USUAL_SAMPLES 16u // of a pixel in one run: a whole pass
// Paths of one run: the largest candidate fills at least one wave.
#define CPU_PATHS (1u << 18)
#define GPU_PATHS (1u << 22)
// Fewer rounds give no interval to go by; more are for when time is left. The rest of it is for the
// last comparison.
#define LEAST_ROUNDS 3u
#define MOST_ROUNDS 8u
#define LEAST_DUEL_ROUNDS 8u
#define CONTESTS_SHARE 0.5

// --- what is to be rendered ----------------------------------------------------------------------

// Pictures of the scene's shape, small enough for a run to be short.
static void shrink(const struct tune *t, struct settings *settings)
{
    double most = (double)(t->gpu.info.is_cpu ? CPU_PATHS : GPU_PATHS) / USUAL_SAMPLES;
    double factor = sqrt(most / ((double)settings->width * settings->height));
    if (factor >= 1.0 || options_given(t->options, OPTION_SIZE))
        return;
    settings->width = (uint32_t)fmax(1.0, round(settings->width * factor));
    settings->height = (uint32_t)fmax(1.0, round(settings->height * factor));
}

static bool open_scene(struct tune *t, uint32_t index, struct err *err)
{
    struct tune_scene *scene = &t->scenes[index];
    struct options options = *t->options;
    uint32_t camera;
    options.arguments[0] = t->options->arguments[index];
    if (!job_load_scene(&options, &scene->scene, &camera, err))
        return false;
    shrink(t, &scene->scene.settings);
    scene->scene.settings.spp = t->samples;
    struct renderer_params params = job_renderer_params(&options, &t->gpu, &scene->scene, camera);
    params.progress = &t->watch;
    if (!renderer_create(&params, &scene->renderer, err))
        return err_prepend(err, "%s", scene->scene.path);
    // Scenes may leave less room than others: the most that any of them takes.
    const struct renderer *r = &scene->renderer;
    if (r->plan.wave_slots > t->usual.wave)
        t->usual.wave = r->plan.wave_slots;
    t->usual.workgroup = r->specialization.workgroup;
    return true;
}

static bool open_all(struct tune *t, struct err *err)
{
    t->scene_count = t->options->argument_count;
    t->scenes = ARENA_NEW(&t->arena, struct tune_scene, t->scene_count);
    if (!t->scenes)
        return err_memory(err, "scenes", t->scene_count * sizeof *t->scenes);
    for (uint32_t i = 0; i < t->scene_count; i++)
        if (!open_scene(t, i, err))
            return false;
    return true;
}

// --- candidates ----------------------------------------------------------------------------------

static bool add(struct tune_contest *c, const char *text, struct tuned sizes, struct err *err)
{
    if (c->count == TUNE_CANDIDATES)
        return err_set(err, ERR_USAGE, "%s: more than %d values", text, TUNE_CANDIDATES);
    for (uint32_t i = 0; i < c->count; i++)
        if (memcmp(&c->candidates[i].sizes, &sizes, sizeof sizes) == 0)
            return true;
    c->candidates[c->count++] =
        (struct tune_candidate){.sizes = sizes, .left = true, .speed = {NAN, NAN, NAN}};
    return true;
}

// The values of --sweep wave=A,B,... or workgroup=A,B,...
static bool take_sweep(struct tune *t, enum option_id id, uint32_t *values, uint32_t *count,
                       struct err *err)
{
    const struct option_def *def = &option_table[id];
    size_t length = strlen(def->name);
    for (uint32_t v = 0; v < t->options->vary_count; v++) {
        const char *text = t->options->vary[v];
        if (strncmp(text, def->name, length) != 0 || text[length] != '=')
            continue;
        for (const char *word = text + length; word; word = strchr(word + 1, ',')) {
            struct options scratch = *t->options;
            const char *value =
                arena_printf(&t->arena, "%.*s", (int)strcspn(word + 1, ","), word + 1);
            if (!value)
                return err_memory(err, "a value", length);
            if (!option_store(def, value, &scratch, err))
                return err_prepend(err, "--sweep \"%s\"", text);
            if (*count == TUNE_CANDIDATES)
                return err_set(err, ERR_USAGE, "--sweep \"%s\": more than %d values", text,
                               TUNE_CANDIDATES);
            values[(*count)++] = id == OPTION_WAVE ? scratch.wave : scratch.workgroup;
        }
    }
    return true;
}

static bool check_sweeps(const struct options *options, struct err *err)
{
    for (uint32_t v = 0; v < options->vary_count; v++)
        if (strncmp(options->vary[v], "wave=", 5) != 0 &&
            strncmp(options->vary[v], "workgroup=", 10) != 0)
            return err_set(err, ERR_USAGE,
                           "--sweep \"%s\": --tune looks for waves and workgroups; expected "
                           "wave=A,B,... or workgroup=A,B,...",
                           options->vary[v]);
    return true;
}

// Paths of a run of the largest picture: a wave of more would be one of as many.
static uint64_t most_paths(const struct tune *t)
{
    uint64_t most = 0;
    for (uint32_t i = 0; i < t->scene_count; i++) {
        const struct gpu_frame *frame = &t->scenes[i].renderer.frame;
        uint64_t paths = (uint64_t)frame->width * frame->height * t->samples;
        most = paths > most ? paths : most;
    }
    return most;
}

static bool list_waves(struct tune *t, struct err *err)
{
    struct tune_contest *c = &t->contests[TUNE_WAVE];
    uint32_t values[TUNE_CANDIDATES], count = 0;
    uint64_t paths = most_paths(t);
    if (!take_sweep(t, OPTION_WAVE, values, &count, err))
        return false;
    // The first that holds all paths stands for those above it.
    uint32_t least = t->gpu.info.is_cpu ? 1u << 12 : 1u << 16;
    for (uint32_t i = 0; i < 7 && t->options->vary_count == 0 && (least << i) / 2 < paths; i++)
        values[count++] = least << i;
    for (uint32_t i = 0; i < count; i++)
        if (values[i] != t->usual.wave &&
            !add(c, "wave", (struct tuned){values[i], t->usual.workgroup}, err))
            return false;
    return true;
}

static bool list_workgroups(struct tune *t, uint32_t wave, struct err *err)
{
    struct tune_contest *c = &t->contests[TUNE_WORKGROUP];
    uint32_t values[TUNE_CANDIDATES], count = 0;
    if (!take_sweep(t, OPTION_WORKGROUP, values, &count, err))
        return false;
    if (t->options->vary_count == 0)
        for (uint32_t size = 32; size <= 256 && size <= t->gpu.max_invocations; size *= 2)
            values[count++] = size;
    c->count = 0;
    for (uint32_t i = 0; i < count; i++)
        if ((values[i] & (values[i] - 1)) != 0 || values[i] > t->gpu.max_invocations)
            return err_set(err, ERR_USAGE,
                           "--sweep workgroup=%u: expected powers of two of at most %u, the "
                           "device's limit",
                           values[i], t->gpu.max_invocations);
    for (uint32_t i = 0; i < count; i++)
        if (values[i] != t->usual.workgroup &&
            !add(c, "workgroup", (struct tuned){wave, values[i]}, err))
            return false;
    return true;
}

// --- the run -------------------------------------------------------------------------------------

static double left_seconds(const struct tune *t)
{
    return t->budget_seconds - clock_seconds_since(t->start_ns);
}

// As many samples a run, up to a whole pass, as the time allows. All scenes are warm after it.
static bool calibrate(struct tune *t, struct err *err)
{
    double seconds;
    if (!tune_measure(t, t->usual, &seconds, NULL, err))
        return false;
    uint64_t start = clock_ns();
    if (!t->stopped && !tune_measure(t, t->usual, &seconds, NULL, err))
        return false;
    if (t->stopped)
        return true;
    double run = clock_seconds_since(start);
    uint32_t contests = tune_contest_runs(t->contests[TUNE_WAVE].count) +
                        tune_contest_runs(t->contests[TUNE_WORKGROUP].count);
    uint32_t runs = LEAST_ROUNDS * contests + 2 * LEAST_DUEL_ROUNDS;
    bool is_given = options_given(t->options, OPTION_SPP);
    while (run * runs > left_seconds(t) && t->samples > 1 && !is_given) {
        t->samples /= 2;
        run /= 2;
    }
    if (run * runs > 1.5 * left_seconds(t) && !t->stopped)
        log_info("tuning will take about %.0f s: the scenes are slow to render", run * runs);
    double rounds = CONTESTS_SHARE * left_seconds(t) / (run * fmax(contests, 1.0));
    t->rounds_at_once = (uint32_t)fmin(fmax(rounds, LEAST_ROUNDS), MOST_ROUNDS);
    runs += (t->rounds_at_once - LEAST_ROUNDS) * contests;
    t->runs_planned = t->runs_done + runs;
    return tune_measure(t, t->usual, &seconds, NULL, err) && tune_check_pictures(t, t->usual, err);
}

static bool confirm(struct tune *t, struct err *err)
{
    struct tune_contest *c = &t->contests[TUNE_CONFIRM];
    c->base = t->usual;
    if (memcmp(&t->best, &t->usual, sizeof t->best) == 0)
        return true;
    if (!add(c, "", t->best, err))
        return false;
    // How many is settled before the first of them is seen: the interval holds for that.
    double spent = clock_seconds_since(t->start_ns);
    double run = spent / fmax(1.0, t->runs_done), rounds = left_seconds(t) / (2.0 * run);
    uint32_t count = (uint32_t)fmin(fmax(rounds, LEAST_DUEL_ROUNDS), TUNE_ROUNDS);
    t->runs_planned = t->runs_done + 2 * count;
    if (!tune_duel(t, TUNE_CONFIRM, count, err))
        return false;
    t->confirmed = curve_judge(c->candidates[0].speed) == CURVE_BETTER;
    if (!t->confirmed)
        t->best = t->usual;
    return true;
}

static bool search(struct tune *t, struct err *err)
{
    t->start_ns = clock_ns();
    if (getloadavg(&t->load, 1) != 1)
        t->load = NAN;
    if (!list_waves(t, err) || !list_workgroups(t, t->usual.wave, err) || !calibrate(t, err) ||
        !tune_contest(t, TUNE_WAVE, t->usual, &t->best, err) ||
        !list_workgroups(t, t->best.wave, err) ||
        !tune_contest(t, TUNE_WORKGROUP, t->best, &t->best, err) || !confirm(t, err))
        return false;
    t->seconds = clock_seconds_since(t->start_ns);
    return !t->stopped || err_set(err, ERR_STOPPED, "stopped: nothing is kept");
}

static bool keep(struct tune *t, struct err *err)
{
    json_t *scenes = json_array();
    for (uint32_t i = 0; i < t->scene_count; i++)
        json_array_append_new(scenes, json_words(path_name(t->scenes[i].scene.path)));
    const struct tune_candidate *winner = &t->contests[TUNE_CONFIRM].candidates[0];
    json_t *speed = t->confirmed ? json_interval(winner->speed) : json_null();
    // The default is not kept as a number: these scenes may have left less room than others do.
    const struct tuned found = {
        .wave = t->best.wave == t->usual.wave ? 0 : t->best.wave,
        .workgroup = t->best.workgroup == t->usual.workgroup ? 0 : t->best.workgroup,
    };
    return tune_cache_keep(
        &t->cache, &t->gpu, found,
        json_pack("{s:s, s:o, s:o}", "version", LAMPYRIS_VERSION, "scenes", scenes, "speed", speed),
        err);
}

static bool check_validation(const struct tune *t, struct err *err)
{
    return t->gpu.validation_messages == 0 ||
           err_set(err, ERR_BUG, "the validation layers reported %u messages",
                   t->gpu.validation_messages);
}

static bool run(struct tune *t, struct err *err)
{
    const struct options *options = t->options;
    t->samples = options_given(options, OPTION_SPP) ? options->settings.spp : USUAL_SAMPLES;
    t->budget_seconds = options->time_seconds > 0.0 ? options->time_seconds : DEFAULT_SECONDS;
    if (options->progress)
        t->watch = (struct progress){.should_stop = options->progress->should_stop,
                                     .context = options->progress->context};
    return check_sweeps(options, err) && tune_cache_open(&t->cache, err) &&
           gpu_open(&options->gpu, &t->gpu, err) && open_all(t, err) && search(t, err) &&
           check_validation(t, err) && keep(t, err);
}

int tune_run(const struct options *options)
{
    struct tune t = {.options = options};
    struct err err = {0};
    int code = EXIT_CODE_OK;
    bool ok = run(&t, &err);
    progress_end(options->progress);
    if (!ok)
        code = command_fail(&err);
    else if (options->json)
        code = tune_print_json(&t);
    else if (!options->quiet)
        tune_print(&t);
    for (uint32_t i = 0; t.scenes && i < t.scene_count; i++) {
        renderer_finish(&t.scenes[i].renderer);
        scene_finish(&t.scenes[i].scene);
    }
    gpu_close(&t.gpu);
    tune_cache_finish(&t.cache);
    arena_finish(&t.arena);
    return code;
}
