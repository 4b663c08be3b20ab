// lampyris submit: lets Slurm render a scene in shards and merge their parts.
#include "cli/commands.h"

#include "base/file_system.h"
#include "base/process.h"
#include "cli/outputs.h"
#include "cli/render/render_devices.h"
#include "cli/render/render_run.h"
#include "cli/scene_options.h"
#include "cli/shard.h"
#include "cli/submit/batch_files.h"
#include "job/expected.h"
#include "report/json_out.h"
#include "report/text_out.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Greatest size of a job's number as sbatch prints it. If there are several clusters, the name of
// the job's cluster follows the number, as in "12;north".
#define JOB_BYTES 128

struct submission {
    struct batch_files files;
    char shards[JOB_BYTES], merge[JOB_BYTES]; // numbers of the jobs; empty if nothing was submitted
};

// --- checks --------------------------------------------------------------------------------------

// Refuses files that have the names of the parts but belong to another render. A shard would refuse
// to continue from them, and the merge would take them for its parts.
static bool check_parts(const struct options *options, struct job *job, struct err *err)
{
    struct job_shard shard = job->params.shard;
    bool ok = true;
    for (shard.index = 1; ok && shard.index <= shard.count; shard.index++) {
        struct arena arena = {0};
        const char *part = shard_default_part(options, &shard, &arena);
        ok = part ? expected_check_file(job, part, err)
                  : err_memory(err, "the name of a part", strlen(options->arguments[0]));
        arena_finish(&arena);
    }
    return ok;
}

// Refuses what a shard would refuse, before the job waits in a queue, and computes the hash of the
// render. Needs no device, so limits of the device are not checked.
static bool check_render(const struct options *options, char hash[EXPECTED_HASH_BYTES],
                         struct err *err)
{
    struct scene scene = {0};
    struct gpu gpu = {0};
    struct job job = {0};
    struct crew several = {0};
    uint32_t camera;
    if (!render_load_scene(options, &scene, &camera, err))
        return false;
    struct job_params params = {
        .renderer = options_renderer_params(&options->device, &gpu, &scene, camera),
        .scene = &scene,
        .goal = {.samples = options_given(options, OPTION_SPP) ? options->scene.settings.spp : 0,
                 .adaptive = options->render.adaptive},
        .shard = {.index = 1,
                  .count = options->submit.parts,
                  .by_tiles = options->render.shard_by == SHARD_BY_TILES},
        .crew = render_devices_count(options->device.gpu.device) > 1 ? &several : NULL,
        .chooses_integrator = true,
        .progress = options->progress,
    };
    params.renderer.aovs = options->render.aovs | options->error_by;
    bool ok = job_init(&params, &job, err) && job_check_renderer(&job, err) &&
              expected_hash(&job, hash, err) && check_parts(options, &job, err);
    job_finish(&job);
    scene_finish(&scene);
    return ok;
}

// Refuses pictures that the merge could not write, before hours of rendering.
static bool check_outputs(const struct options *options, struct err *err)
{
    const char *const *outputs = options->render.outputs;
    const uint32_t count = options->render.output_count;
    for (uint32_t i = 0; i < count; i++)
        if (!outputs_check_one(outputs[i], err))
            return false;
    return outputs_check_layers(outputs, count, options->render.aovs, err);
}

// --- sbatch --------------------------------------------------------------------------------------

static bool read_job(FILE *out, char job[JOB_BYTES], struct err *err)
{
    rewind(out);
    const char *line = fgets(job, JOB_BYTES, out);
    size_t length = line ? strcspn(line, "\n") : 0;
    job[length] = '\0';
    return (length > 0 && job[0] >= '0' && job[0] <= '9') ||
           err_set(err, ERR_SYSTEM,
                   "sbatch answered \"%s\"; expected the number of a job; \"squeue --me\" says "
                   "whether it was submitted",
                   job);
}

// Submits a batch file, and reads the number of its job from standard output. Messages of sbatch go
// to standard error.
static bool submit(const char *const *arguments, char job[JOB_BYTES], struct err *err)
{
    FILE *out = file_stream_temporary();
    struct process process;
    bool is_well = false;
    size_t last = 0;
    while (arguments[last + 1])
        last++;
    if (!out)
        return err_set(err, ERR_SYSTEM, "cannot create a temporary file for the output of sbatch");
    bool ok =
        process_start(&process, &(struct process_params){.arguments = arguments, .out = out}, err);
    if (ok) {
        process_wait(&process, &is_well);
        ok = is_well ? read_job(out, job, err)
                     : err_set(err, ERR_SYSTEM, "sbatch refused %s; its message above says why",
                               arguments[last]);
    }
    fclose(out);
    return ok;
}

// The merge begins when the last shard has ended, even if shards failed: it then reports the
// missing samples.
static bool submit_both(struct submission *s, struct err *err)
{
    char dependency[JOB_BYTES + 32];
    const char *shards[] = {"sbatch", "--parsable", s->files.shards, NULL};
    const char *merge[] = {"sbatch", "--parsable", dependency, s->files.merge, NULL};
    if (!program_is_installed("sbatch"))
        return err_set(err, ERR_SYSTEM,
                       "sbatch is not in PATH: %s was written but not submitted; expected a "
                       "machine that can submit jobs to Slurm, or --dry-run",
                       s->files.shards);
    if (!submit(shards, s->shards, err))
        return false;
    snprintf(dependency, sizeof dependency, "--dependency=afterany:%.*s",
             (int)strcspn(s->shards, ";"), s->shards);
    return submit(merge, s->merge, err) ||
           err_prepend(err, "the shards are job %s, and the merge was not submitted", s->shards);
}

// --- output --------------------------------------------------------------------------------------

// Prints a word for a shell.
static void print_quoted(const char *word)
{
    char *quoted = malloc(4 * strlen(word) + 3);
    if (quoted)
        options_quote(word, quoted);
    print_words(quoted ? quoted : word);
    free(quoted);
}

static void print_summary(const struct submission *s, const struct options *options)
{
    if (!*s->shards) {
        printf("wrote     ");
        print_words(s->files.shards);
        fputs(", ", stdout);
        print_words(s->files.merge);
        printf("\nsubmit    sbatch --dependency=afterany:$(sbatch --parsable ");
        print_quoted(s->files.shards);
        fputs(") ", stdout);
        print_quoted(s->files.merge);
        printf("\n");
    } else {
        printf("shards    job %s, %u of them: ", s->shards, options->submit.parts);
        print_words(s->files.parts);
        printf("\nmerge     job %s, when they have ended\n", s->merge);
        printf("queue     squeue --job %.*s,%.*s\n", (int)strcspn(s->shards, ";"), s->shards,
               (int)strcspn(s->merge, ";"), s->merge);
    }
    printf("status    lampyris merge --status ");
    print_words(s->files.parts);
    printf("\n");
}

static json_t *job_json(const char *job, const char *script)
{
    return json_pack("{s:o, s:o}", "job", *job ? json_words(job) : json_null(), "script",
                     json_words(script));
}

static int print(const struct submission *s, const struct options *options)
{
    if (options->json)
        return command_print(
            json_pack("{s:o, s:o, s:i, s:o}", "shards", job_json(s->shards, s->files.shards),
                      "merge", job_json(s->merge, s->files.merge), "count",
                      (int)options->submit.parts, "parts", json_words(s->files.parts)));
    if (!options->quiet)
        print_summary(s, options);
    return EXIT_CODE_OK;
}

int cmd_submit(const struct options *options)
{
    struct submission submission = {0};
    struct err err = {0};
    char hash[EXPECTED_HASH_BYTES];
    bool ok = options->submit.parts > 0 ||
              err_set(&err, ERR_USAGE, "submit needs --parts N, the number of shards");
    ok = ok && check_outputs(options, &err) && check_render(options, hash, &err) &&
         batch_files_write(options, hash, &submission.files, &err) &&
         (options->submit.dry_run || submit_both(&submission, &err));
    progress_end(options->progress);
    int code = ok ? print(&submission, options) : command_fail(&err);
    batch_files_finish(&submission.files);
    return code;
}
