#include "cli/render/render_devices.h"

#include "base/thread.h"
#include "gpu/gpu.h"
#include <string.h>

// A device with its thread. The mutex of struct device_crew guards all members except gpu and job.
struct device_worker {
    struct device_crew *all;
    struct gpu gpu;
    struct job job;
    struct thread thread;
    uint32_t index;
    struct sample_range blocks[CREW_BLOCKS];
    uint32_t block_count;
    bool is_to_give, has_given; // the worker must copy its film; the worker has copied its film
    bool is_to_end, has_failed;
    struct arena film_arena;
    struct crew_film film;
    struct err err;
};

// Data that the threads share.
struct device_crew {
    struct render_devices *devices;
    struct mutex mutex;
    struct condition of_workers, of_job;
    struct crew_done *done; // finished blocks that the job has not yet polled
    uint32_t done_count;
};

// --- the list of devices -------------------------------------------------------------------------

uint32_t render_devices_count(const char *text)
{
    uint32_t count = 1;
    if (!text || text[strspn(text, "0123456789,")] != '\0')
        return 1;
    for (const char *c = text; *c; c++) {
        // A comma must be between two indices.
        if (*c == ',' && (c == text || c[-1] == ',' || c[1] == '\0'))
            return 1;
        count += *c == ',';
    }
    return count;
}

const char *render_devices_name(const char *text, uint32_t i, struct arena *arena)
{
    for (; i > 0; i--)
        text += strcspn(text, ",") + 1;
    return arena_printf(arena, "%.*s", (int)strcspn(text, ","), text);
}

// --- a worker ------------------------------------------------------------------------------------

static void fail(struct device_worker *worker, const struct err *err)
{
    struct device_crew *all = worker->all;
    mutex_lock(&all->mutex);
    worker->err = *err;
    worker->has_failed = true;
    condition_wake_all(&all->of_job);
    mutex_unlock(&all->mutex);
}

static bool render_block(struct device_worker *worker, struct err *err)
{
    struct device_crew *all = worker->all;
    const struct sample_range block = worker->blocks[0];
    struct crew_done done = {.worker = worker->index};
    worker->block_count--;
    memmove(&worker->blocks[0], &worker->blocks[1], worker->block_count * sizeof block);
    mutex_unlock(&all->mutex);
    bool ok = crew_render(&worker->job, &block, &done.seconds, err);
    mutex_lock(&all->mutex);
    if (!ok)
        return false;
    all->done[all->done_count++] = done;
    condition_wake_all(&all->of_job);
    return true;
}

static bool give_film(struct device_worker *worker, struct err *err)
{
    struct device_crew *all = worker->all;
    mutex_unlock(&all->mutex);
    bool ok = crew_take(&worker->job, &worker->film_arena, &worker->film, err);
    mutex_lock(&all->mutex);
    worker->is_to_give = false;
    worker->has_given = ok;
    condition_wake_all(&all->of_job);
    return ok;
}

static bool work(struct device_worker *worker, struct err *err)
{
    struct device_crew *all = worker->all;
    bool ok = job_create(&worker->job, err);
    mutex_lock(&all->mutex);
    while (ok && !worker->is_to_end) {
        if (worker->block_count > 0)
            ok = render_block(worker, err);
        else if (worker->is_to_give)
            ok = give_film(worker, err);
        else
            condition_wait(&all->of_workers, &all->mutex);
    }
    mutex_unlock(&all->mutex);
    return ok;
}

static void run_worker(void *context)
{
    struct device_worker *worker = context;
    struct err err = {0};
    if (!work(worker, &err))
        fail(worker, &err);
}

// --- functions of struct crew --------------------------------------------------------------------

// Returns false, with *err set unless it is NULL, if the worker has failed. The mutex must be
// locked.
static bool check(const struct device_worker *worker, struct err *err)
{
    if (!worker->has_failed)
        return true;
    if (err)
        *err = worker->err;
    return err_prepend(err, "device %u (%s)", worker->index + 1, worker->gpu.info.name);
}

static bool check_all(const struct render_devices *devices, struct err *err)
{
    for (uint32_t i = 0; i < devices->crew.count; i++)
        if (!check(&devices->workers[i], err))
            return false;
    return true;
}

static bool give(void *context, uint32_t index, const struct sample_range *block, struct err *err)
{
    struct device_crew *all = context;
    struct device_worker *worker = &all->devices->workers[index];
    mutex_lock(&all->mutex);
    bool ok = check(worker, err);
    if (ok)
        worker->blocks[worker->block_count++] = *block;
    condition_wake_all(&all->of_workers);
    mutex_unlock(&all->mutex);
    return ok;
}

static bool poll(void *context, bool waits, struct crew_done *out, bool *is_there, struct err *err)
{
    struct device_crew *all = context;
    mutex_lock(&all->mutex);
    while (waits && all->done_count == 0 && check_all(all->devices, NULL))
        condition_wait(&all->of_job, &all->mutex);
    bool ok = check_all(all->devices, err);
    *is_there = ok && all->done_count > 0;
    if (*is_there) {
        *out = all->done[0];
        all->done_count--;
        memmove(&all->done[0], &all->done[1], all->done_count * sizeof *out);
    }
    mutex_unlock(&all->mutex);
    return ok;
}

// Adds the workers' films to `to` one after the other, so that at most two films are in memory.
static bool gather(void *context, uint32_t aovs, uint64_t bytes, struct crew_film *to,
                   struct err *err)
{
    struct device_crew *all = context;
    bool ok = true;
    for (uint32_t i = 0; ok && i < all->devices->crew.count; i++) {
        struct device_worker *worker = &all->devices->workers[i];
        mutex_lock(&all->mutex);
        worker->is_to_give = true;
        condition_wake_all(&all->of_workers);
        while (!worker->has_given && !worker->has_failed)
            condition_wait(&all->of_job, &all->mutex);
        worker->has_given = false;
        ok = check(worker, err);
        mutex_unlock(&all->mutex);
        if (ok)
            crew_add(aovs, bytes, &worker->film, to);
        arena_finish(&worker->film_arena);
    }
    return ok;
}

// --- create and finish ---------------------------------------------------------------------------

bool render_devices_create(const char *text, struct job_params *params, struct render_devices *out,
                           struct err *err)
{
    const uint32_t count = render_devices_count(text) - 1;
    const struct geometry_params geometry = {
        .scene = params->scene,
        .bvh = params->renderer.bvh,
        .instancing = params->renderer.instancing,
        .bvh_cache = params->renderer.bvh_cache,
        .progress = params->progress,
        .camera = &params->scene->cameras[params->renderer.camera],
    };
    struct device_crew *all = ARENA_NEW(&out->arena, struct device_crew, 1);
    out->workers = ARENA_NEW(&out->arena, struct device_worker, count);
    struct crew_member *members = ARENA_NEW(&out->arena, struct crew_member, count + 1);
    struct crew_done *done = ARENA_NEW(&out->arena, struct crew_done, CREW_BLOCKS * count);
    if (!all || !out->workers || !members || !done)
        return err_memory(err, "several devices", count * sizeof *out->workers);
    *all = (struct device_crew){.devices = out, .done = done};
    mutex_init(&all->mutex);
    condition_init(&all->of_workers);
    condition_init(&all->of_job);
    out->crew = (struct crew){
        .count = count,
        .members = members,
        .word = "device",
        .give = give,
        .poll = poll,
        .gather = gather,
        .context = all,
    };
    if (!geometry_create(&geometry, &out->geometry, err))
        return false;
    params->renderer.geometry = &out->geometry;
    params->crew = &out->crew;
    return true;
}

static bool open_worker(struct render_devices *devices, uint32_t index,
                        const struct gpu_params *gpu, const char *text,
                        const struct job_params *params, struct err *err)
{
    struct device_worker *worker = &devices->workers[index];
    struct gpu_params own = *gpu;
    struct job_params of_job = {
        .renderer = params->renderer,
        .scene = params->scene,
        .goal = params->goal,
        .shard = params->shard,
    };
    worker->all = devices->crew.context;
    worker->index = index;
    own.device = render_devices_name(text, index + 1, &devices->arena);
    of_job.renderer.gpu = &worker->gpu;
    if (!own.device)
        return err_memory(err, "the name of a device", 16);
    if (!gpu_open(&own, &worker->gpu, err) || !job_init(&of_job, &worker->job, err) ||
        !job_open(&worker->job, err))
        return err_prepend(err, "--device %s", own.device);
    struct crew_member *member = &devices->crew.members[index + 1];
    member->device = worker->gpu.info.name;
    member->driver = worker->gpu.info.driver;
    return true;
}

static bool start_worker(struct render_devices *devices, struct err *err)
{
    struct device_worker *worker = &devices->workers[devices->started];
    int failure = thread_start(&worker->thread, run_worker, worker);
    if (failure)
        return err_set(err, ERR_SYSTEM, "cannot start a thread: %s", strerror(failure));
    devices->started++;
    return true;
}

// Returns device i of the list. Device 0 is the job's own.
static struct gpu *device_of(struct render_devices *devices, struct gpu *own, uint32_t i)
{
    return i == 0 ? own : &devices->workers[i - 1].gpu;
}

static void share_memory(struct render_devices *devices, struct gpu *own)
{
    const uint32_t count = devices->crew.count + 1;
    for (uint32_t i = 0; i < count; i++) {
        struct gpu *gpu = device_of(devices, own, i);
        uint32_t sharers = 0;
        for (uint32_t k = 0; k < count; k++)
            sharers += memcmp(device_of(devices, own, k)->info.memory_id, gpu->info.memory_id,
                              sizeof gpu->info.memory_id) == 0;
        if (sharers > 1)
            gpu_share_memory(gpu, sharers);
    }
}

bool render_devices_start(struct render_devices *devices, const struct gpu_params *gpu,
                          const char *text, const struct job_params *params, struct err *err)
{
    struct gpu *own = params->renderer.gpu;
    devices->crew.members[0].device = own->info.name;
    devices->crew.members[0].driver = own->info.driver;
    for (uint32_t i = 0; i < devices->crew.count; i++)
        if (!open_worker(devices, i, gpu, text, params, err))
            return false;
    share_memory(devices, own);
    while (devices->started < devices->crew.count)
        if (!start_worker(devices, err))
            return false;
    return true;
}

void render_devices_finish(struct render_devices *devices)
{
    if (!devices)
        return;
    struct device_crew *all = devices->crew.context;
    if (!all) {
        arena_finish(&devices->arena);
        return;
    }
    mutex_lock(&all->mutex);
    for (uint32_t i = 0; i < devices->crew.count; i++) {
        devices->workers[i].is_to_end = true;
        devices->workers[i].block_count = 0;
    }
    condition_wake_all(&all->of_workers);
    mutex_unlock(&all->mutex);
    for (uint32_t i = 0; i < devices->crew.count; i++) {
        struct device_worker *worker = &devices->workers[i];
        if (i < devices->started)
            thread_join(&worker->thread);
        job_finish(&worker->job);
        gpu_close(&worker->gpu);
        arena_finish(&worker->film_arena);
    }
    condition_finish(&all->of_job);
    condition_finish(&all->of_workers);
    mutex_finish(&all->mutex);
    geometry_finish(&devices->geometry);
    arena_finish(&devices->arena);
    *devices = (struct render_devices){0};
}
