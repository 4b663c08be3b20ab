#include "cli/render/render_ranks.h"

#include "base/hash.h"
#include "base/log.h"
#include "base/process.h"
#include "base/signals.h"
#include "cli/commands.h"
#include "cli/render/render_run.h"
#include "cli/sibling.h"
#include "render/kernels.h"
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PROGRAM "lampyris-mpi"

// --- number of ranks -----------------------------------------------------------------------------

static uint32_t number_of(const char *variable)
{
    const char *text = getenv(variable);
    return text ? (uint32_t)strtoul(text, NULL, 10) : 0;
}

// SLURM_NTASKS is used only if PMIX_RANK is set, because Slurm sets SLURM_NTASKS also for batch
// scripts.
uint32_t render_ranks_expected(void)
{
    uint32_t count = number_of("OMPI_COMM_WORLD_SIZE");
    if (count == 0)
        count = number_of("PMI_SIZE");
    if (count == 0 && getenv("PMIX_RANK"))
        count = number_of("SLURM_NTASKS");
    return count > 1 ? count : 1;
}

uint32_t render_ranks_launched_as(void)
{
    uint32_t index = number_of("OMPI_COMM_WORLD_RANK");
    if (index == 0)
        index = number_of("PMI_RANK");
    return index > 0 ? index : number_of("PMIX_RANK");
}

int render_ranks_become(const struct options *options)
{
    char program[PATH_MAX];
    struct err err;
    sibling_find(PROGRAM, PROGRAM, program, sizeof program);
    process_become(program, options->argv);
    err_set(&err, ERR_SYSTEM,
            "this is one of %u processes that share a picture, which needs " PROGRAM ", but %s "
            "cannot be run: %s; expected a build with MPI (Debian: libopenmpi-dev or "
            "libmpich-dev), or --shard auto",
            render_ranks_expected(), program, strerror(errno));
    return command_fail(&err);
}

// --- devices -------------------------------------------------------------------------------------

// Chooses the device of this rank. The ranks of a machine take its GPUs in turn, or the devices of
// --device if that lists several.
static bool choose_device(const struct options *options, const struct render_ranks *ranks,
                          struct arena *arena, struct gpu_params *out, struct err *err)
{
    const char *text = options->device.gpu.device;
    struct gpu_device_info devices[GPU_MAX_DEVICES];
    uint32_t count, gpus[GPU_MAX_DEVICES], gpu_count = 0;
    *out = options->device.gpu;
    if (render_devices_count(text) > 1)
        out->device =
            render_devices_name(text, ranks->local_rank % render_devices_count(text), arena);
    if (text)
        return out->device || err_memory(err, "the name of a device", strlen(text));
    if (!gpu_list_devices(devices, &count, err))
        return false;
    for (uint32_t i = 0; i < count; i++)
        if (!devices[i].is_cpu && !devices[i].unusable[0])
            gpus[gpu_count++] = devices[i].index;
    if (gpu_count < 2)
        return true;
    out->device = arena_printf(arena, "%u", gpus[ranks->local_rank % gpu_count]);
    return out->device || err_memory(err, "the name of a device", 16);
}

bool render_ranks_open_device(const struct options *options, struct render_ranks *ranks,
                              struct job *job, struct err *err)
{
    struct scene *scene = job->scene;
    struct gpu *gpu = job->gpu;
    struct arena arena = {0};
    struct gpu_params params;
    struct rank_card card = {0};
    uint32_t sharers;
    bool ok = choose_device(options, ranks, &arena, &params, err) && gpu_open(&params, gpu, err);
    // Rank 0 chooses the integrator for all ranks.
    if (ok && ranks->rank == 0)
        ok = job_choose_integrator(job, err);
    if (ok) {
        const uint64_t kernels = kernels_hash();
        card.hash = hash_bytes(HASH_INIT, options->command_line, strlen(options->command_line));
        card.hash = hash_bytes(card.hash, &scene->hash, sizeof scene->hash);
        card.hash = hash_bytes(card.hash, &kernels, sizeof kernels);
        snprintf(card.device, sizeof card.device, "%s", gpu->info.name);
        snprintf(card.driver, sizeof card.driver, "%s", gpu->info.driver);
        memcpy(card.memory_id, gpu->info.memory_id, sizeof card.memory_id);
        ok = ranks->meet(ranks->context, &card, &scene->settings.integrator, &sharers, err);
    }
    if (ok && sharers > 1) {
        gpu_share_memory(gpu, sharers);
        ranks->wait_for_local(ranks->context);
    }
    arena_finish(&arena);
    return ok;
}

// --- blocks --------------------------------------------------------------------------------------

void render_ranks_save(struct render_ranks *ranks)
{
    struct err failure = {0};
    if (ranks->job && ranks->checkpoint && !crew_save(ranks->job, ranks->checkpoint, &failure))
        log_message(LOG_ERROR, "rank %u saved no blocks: %s", ranks->rank, failure.msg);
}

bool render_ranks_save_each(const struct options *options)
{
    return options_given(options, OPTION_CHECKPOINT_EVERY) &&
           options->render.checkpoint_seconds == 0.0;
}

// --- workers -------------------------------------------------------------------------------------

static bool give_film(struct job *job, struct render_ranks *ranks, struct err *err)
{
    const uint64_t bytes = film_copy_bytes(&job->renderer);
    struct arena arena = {0};
    struct crew_film film;
    bool ok =
        crew_take(job, &arena, &film, err) &&
        ranks->hand_over(ranks->context, job->renderer.specialization.aovs, bytes, &film, err);
    arena_finish(&arena);
    return ok;
}

// Saves the block before it is reported, because rank 0 counts a reported block as finished.
static bool render_block(struct job *job, struct render_ranks *ranks,
                         const struct sample_range *block, bool saves_each, struct err *err)
{
    double seconds;
    if (!crew_render(job, block, &seconds, err))
        return false;
    if (saves_each || signals_received_sigterm())
        render_ranks_save(ranks);
    return ranks->report(ranks->context, seconds, err);
}

static bool follow_orders(struct job *job, struct render_ranks *ranks, bool saves_each,
                          struct err *err)
{
    struct rank_order order;
    while (ranks->next(ranks->context, &order, err)) {
        bool ok = true;
        if (order.kind == RANK_ENDS)
            return true;
        if (order.kind == RANK_GIVES_FILM)
            ok = give_film(job, ranks, err);
        else
            ok = render_block(job, ranks, &order.block, saves_each, err);
        if (!ok)
            return false;
    }
    return false;
}

static bool work(struct render_run *run, struct err *err)
{
    const struct options *options = run->options;
    if (!options_load_scene(&options->scene, NULL, &run->scene, &run->camera, err) ||
        !render_find_window(options, &run->scene, &run->window, err))
        return false;
    struct job_params params = {
        .renderer = options_renderer_params(&options->device, &run->gpu, &run->scene, run->camera),
        .scene = &run->scene,
        .goal = render_goal(options),
        .command = options->render.shared_line,
    };
    run->ranks->job = &run->job;
    run->ranks->checkpoint = options->render.checkpoint;
    params.renderer.aovs = options->render.aovs | options->error_by;
    params.renderer.window = run->window;
    return job_init(&params, &run->job, err) &&
           render_ranks_open_device(options, run->ranks, &run->job, err) &&
           job_open(&run->job, err) && job_create(&run->job, err) &&
           follow_orders(&run->job, run->ranks, render_ranks_save_each(options), err);
}

// Prints no warnings, because rank 0 prints the same ones.
int render_ranks_work(const struct options *options, struct render_ranks *ranks)
{
    struct render_run run = {.options = options, .ranks = ranks};
    struct err err = {0};
    log_set_level(LOG_ERROR);
    bool ok = work(&run, &err);
    if (ok && run.gpu.validation_messages > 0)
        ok = err_set(&err, ERR_BUG, "the validation layers reported %u messages",
                     run.gpu.validation_messages);
    job_finish(&run.job);
    gpu_close(&run.gpu);
    scene_finish(&run.scene);
    arena_finish(&run.arena);
    if (ok)
        return EXIT_CODE_OK;
    err_prepend(&err, "rank %u", ranks->rank);
    return command_fail(&err);
}
