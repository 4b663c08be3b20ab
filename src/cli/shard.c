#include "cli/shard.h"

#include "base/file.h"
#include "cli/options.h"
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// --- environment variables -----------------------------------------------------------------------

// The index of this process among the processes of the render, and the number of processes.
struct place {
    uint64_t index, count; // index from 0; count 0: not known
};

static bool read_number(const char *variable, uint64_t *out, struct err *err)
{
    const char *text = getenv(variable);
    char *end;
    if (!text)
        return err_set(err, ERR_USAGE, "%s is not set; expected a number, or --shard I/N",
                       variable);
    *out = *text >= '0' && *text <= '9' ? strtoull(text, &end, 10) : UINT64_MAX;
    return (*out <= UINT32_MAX && *end == '\0') ||
           err_set(err, ERR_USAGE, "%s is \"%s\"; expected a number, or --shard I/N", variable,
                   text);
}

// Variables with the rank of a process and the number of ranks, by the program that started them.
// Within a job of Slurm, mpirun starts its daemons by srun. Processes inherit SLURM_PROCID from
// these daemons, so it is read last.
static const struct {
    const char *index, *count;
} ranks[] = {
    {"OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE"}, // mpirun of Open MPI
    {"PMI_RANK", "PMI_SIZE"},                         // set by MPICH and its relatives
    {"PMIX_RANK", "SLURM_NTASKS"},                    // srun --mpi=pmix
    {"SLURM_PROCID", "SLURM_NTASKS"},
};

static bool read_rank(struct place *out, struct err *err)
{
    *out = (struct place){0, 1};
    size_t i = 0, count = sizeof ranks / sizeof ranks[0];
    while (i < count && !getenv(ranks[i].index))
        i++;
    if (i == count)
        return true;
    // In a batch script of one process, only SLURM_PROCID is set.
    bool is_alone =
        i + 1 == count && strcmp(getenv(ranks[i].index), "0") == 0 && !getenv(ranks[i].count);
    return is_alone || (read_number(ranks[i].index, &out->index, err) &&
                        read_number(ranks[i].count, &out->count, err));
}

// Reads the place of a task in a Slurm array, which may begin at any number and have any step.
// Arrays that are lists with gaps, for example of tasks that are submitted again, are refused: the
// place of a task is not known then.
static bool read_slurm_array(struct place *out, struct err *err)
{
    uint64_t id, min, max, step = 1;
    if (!read_number("SLURM_ARRAY_TASK_ID", &id, err) ||
        !read_number("SLURM_ARRAY_TASK_COUNT", &out->count, err) ||
        !read_number("SLURM_ARRAY_TASK_MIN", &min, err) ||
        !read_number("SLURM_ARRAY_TASK_MAX", &max, err) ||
        (getenv("SLURM_ARRAY_TASK_STEP") && !read_number("SLURM_ARRAY_TASK_STEP", &step, err)))
        return false;
    bool is_even = out->count > 0 && step > 0 && id >= min && id <= max && (id - min) % step == 0 &&
                   max - min == (out->count - 1) * step;
    out->index = is_even ? (id - min) / step : 0;
    return is_even || err_set(err, ERR_USAGE,
                              "the array of Slurm has %" PRIu64 " tasks from %" PRIu64
                              " to %" PRIu64 " in steps of %" PRIu64 ", of which this is %" PRIu64
                              ": the part of this task is not known; expected --array FROM-TO, "
                              "or --shard I/N",
                              out->count, min, max, step, id);
}

static bool read_array(struct place *out, struct err *err)
{
    *out = (struct place){0, 1};
    if (getenv("SLURM_ARRAY_TASK_ID"))
        return read_slurm_array(out, err);
    if (!getenv("JOB_COMPLETION_INDEX"))
        return true;
    out->count = 0;
    return read_number("JOB_COMPLETION_INDEX", &out->index, err);
}

static bool is_started_by_many(void)
{
    bool is = getenv("SLURM_ARRAY_TASK_ID") || getenv("JOB_COMPLETION_INDEX");
    for (size_t i = 0; i < sizeof ranks / sizeof ranks[0]; i++)
        is |= getenv(ranks[i].index) != NULL;
    return is;
}

// Determines the place of this process among all shards. `wanted` is N of auto/N; 0: not given.
static bool find_place(uint64_t wanted, struct place *out, struct err *err)
{
    if (!is_started_by_many())
        return err_set(
            err, ERR_USAGE,
            "none of SLURM_ARRAY_TASK_ID, SLURM_PROCID, OMPI_COMM_WORLD_RANK, PMI_RANK, "
            "PMIX_RANK and JOB_COMPLETION_INDEX is set; expected to be started by Slurm, "
            "mpirun or Kubernetes, or --shard I/N");
    struct place array, rank;
    if (!read_array(&array, err) || !read_rank(&rank, err))
        return false;
    if (array.count == 0 && wanted == 0)
        return err_set(err, ERR_USAGE,
                       "Kubernetes sets JOB_COMPLETION_INDEX and not the number of completions; "
                       "expected --shard auto/N");
    if (array.count == 0 && rank.count > 0 && wanted % rank.count != 0)
        return err_set(err, ERR_USAGE,
                       "each completion of the Kubernetes job has %" PRIu64
                       " processes, so the number of shards is a multiple of that, but it is "
                       "%" PRIu64 "; expected auto/%" PRIu64 ", for example",
                       rank.count, wanted, (wanted / rank.count + 1) * rank.count);
    if (array.count == 0 && rank.count > 0)
        array.count = wanted / rank.count;
    *out = (struct place){array.index * rank.count + rank.index, array.count * rank.count};
    if (out->index >= out->count || out->count > UINT32_MAX)
        return err_set(err, ERR_USAGE,
                       "the environment variables say that this is process %" PRIu64
                       " (counted from 0) of %" PRIu64
                       "; expected a smaller process number, or --shard I/N",
                       out->index, out->count);
    return wanted == 0 || wanted == out->count ||
           err_set(err, ERR_USAGE,
                   "the environment variables say that there are %" PRIu64
                   " processes; expected %" PRIu64 ", the number in --shard",
                   out->count, wanted);
}

// --- the option ----------------------------------------------------------------------------------

static bool parse_auto(const char *text, struct job_shard *out, struct err *err)
{
    char *end;
    uint64_t wanted = 0;
    if (*text == '/') {
        wanted = strtoull(text + 1, &end, 10);
        if (text[1] < '1' || text[1] > '9' || *end != '\0' || wanted > UINT32_MAX)
            return err_set(err, ERR_USAGE,
                           "\"auto%s\" has no valid number of shards; expected auto/N", text);
    }
    struct place place;
    if (!find_place(wanted, &place, err))
        return false;
    out->index = (uint32_t)place.index + 1;
    out->count = (uint32_t)place.count;
    return true;
}

bool shard_parse(const char *text, struct job_shard *out, struct err *err)
{
    *out = (struct job_shard){0};
    if (strncmp(text, "auto", 4) == 0 && (text[4] == '\0' || text[4] == '/'))
        return parse_auto(text + 4, out, err);
    const char *rest = samples_parse_range(text, &out->range);
    if (rest && *rest == '\0')
        return true;
    out->range = (struct sample_range){0};
    char *end;
    bool is_plain = text[strspn(text, "0123456789/")] == '\0' && strlen(text) <= 21;
    uint64_t index = is_plain ? strtoull(text, &end, 10) : 0;
    uint64_t count = is_plain && *end == '/' ? strtoull(end + 1, &end, 10) : 0;
    if (is_plain && *end == '\0' && index >= 1 && index <= count && count <= UINT32_MAX) {
        out->index = (uint32_t)index;
        out->count = (uint32_t)count;
        return true;
    }
    return err_set(err, ERR_USAGE,
                   "\"%s\" is no shard; expected I/N with I from 1 to N, FIRST:END with the first "
                   "sample (or row, with --shard-by tiles) and the one after the last, auto or "
                   "auto/N",
                   text);
}

// --- names ---------------------------------------------------------------------------------------

// The texts of I and N, or of FIRST and END. I has as many digits as N, so that the alphabetical
// order of names is that of the shards.
struct numbers {
    char i[24], n[24];
};

static struct numbers numbers_of(const struct job_shard *shard)
{
    struct numbers numbers;
    if (shard->count == 0) {
        snprintf(numbers.i, sizeof numbers.i, "%" PRIu64, shard->range.first);
        snprintf(numbers.n, sizeof numbers.n, "%" PRIu64, shard->range.end);
        return numbers;
    }
    int digits = snprintf(numbers.n, sizeof numbers.n, "%u", shard->count);
    snprintf(numbers.i, sizeof numbers.i, "%0*u", digits, shard->index);
    return numbers;
}

// Replaces %i and %n in a name. Returns NULL when out of memory.
static const char *fill_in(struct arena *arena, const char *name, const struct numbers *numbers)
{
    size_t size = 1;
    for (const char *c = name; *c; c++)
        size += *c == '%' ? sizeof numbers->i : 1;
    char *out = ARENA_NEW(arena, char, size), *end = out;
    for (; out && *name; name++) {
        const char *number = name[0] != '%'   ? NULL
                             : name[1] == 'i' ? numbers->i
                             : name[1] == 'n' ? numbers->n
                                              : NULL;
        if (!number) {
            *end++ = *name;
            continue;
        }
        end += snprintf(end, sizeof numbers->i, "%s", number);
        name++;
    }
    return out;
}

const char *shard_default_part(const struct options *options, const struct job_shard *shard,
                               struct arena *arena)
{
    const struct numbers numbers = numbers_of(shard);
    const char *scene = path_name(options->arguments[0]), *extension = path_extension(scene);
    size_t length = strlen(scene) - strlen(extension);
    return arena_printf(arena, "%s%.*s%s%s%s%s.part", options_folder_of(scene), (int)length, scene,
                        *extension ? "" : ".", numbers.i, shard->count ? "-of-" : "-", numbers.n);
}

bool shard_settle(struct options *options, struct err *err)
{
    struct render_options *render = &options->render;
    if (!options_given(options, OPTION_SHARD) || options->argument_count == 0)
        return true;
    if (!shard_parse(render->shard_text, &render->shard, err))
        return err_prepend(err, "--shard");
    render->shard.by_tiles = render->shard_by == SHARD_BY_TILES;
    const struct numbers numbers = numbers_of(&render->shard);
    const bool is_named = options_given(options, OPTION_CHECKPOINT);
    if (is_named && render->shard.count > 1 && !strstr(render->checkpoint, "%i") &&
        strncmp(render->shard_text, "auto", 4) == 0)
        return err_set(err, ERR_USAGE,
                       "--checkpoint %s: every shard would write this file; expected %%i in its "
                       "name, which stands for the shard's number",
                       render->checkpoint);
    render->checkpoint = is_named ? fill_in(&options->arena, render->checkpoint, &numbers)
                                  : shard_default_part(options, &render->shard, &options->arena);
    bool ok = render->checkpoint != NULL;
    for (uint32_t i = 0; i < render->output_count; i++) {
        render->outputs[i] = fill_in(&options->arena, render->outputs[i], &numbers);
        ok = ok && render->outputs[i];
    }
    option_mark(&option_table[OPTION_CHECKPOINT], options);
    return ok || err_memory(err, "names of outputs", 64);
}
