// Functions by which the caller changes a render in progress.
#include "job/job_internal.h"

#include "base/clock.h"
#include "render/probe/kernel_recording.h"
#include "render/probe/ray_probe.h"
#include "render/probe/replay.h"
#include <string.h>

bool job_set_camera(struct job *job, const struct camera *camera, uint32_t width, uint32_t height,
                    bool *fits, struct err *err)
{
    return renderer_set_camera(&job->renderer, camera, width, height, fits, err);
}

bool job_begin_view(struct job *job, const struct camera *camera, bool *fits, struct err *err)
{
    const struct gpu_frame *frame = &job->renderer.frame;
    if (!renderer_set_camera(&job->renderer, camera, frame->width, frame->height, fits, err))
        return false;
    if (!*fits)
        return true;
    job->renderer.stats = (struct render_stats){0};
    job->seconds = (struct job_seconds){0};
    job->begun_seconds = job->looks_error = 0.0;
    job->ended_by = ENDED_BY_SAMPLES;
    job->is_rendering = job->stopped = false;
    job->identity = NULL;
    job->next_look = 0;
    job->look_count = job->frame_count = job->trace.count = 0;
    return true;
}

bool job_set_wave(struct job *job, uint32_t paths, struct err *err)
{
    return renderer_resize(&job->renderer, paths, job->renderer.specialization.workgroup, err);
}

bool job_clear(struct job *job, struct err *err)
{
    return renderer_clear(&job->renderer, err);
}

void job_set_progress(struct job *job, const struct progress *progress)
{
    job->params.progress = progress;
}

void job_set_listener(struct job *job, const struct job_listener *listener)
{
    job->params.listener = listener ? *listener : (struct job_listener){0};
}

bool job_count_steps(struct job *job, bool on, struct err *err)
{
    return wave_count_steps(&job->renderer, on, err);
}

void job_resume_trace(struct job *job, const struct trace_row *rows, uint32_t count)
{
    memcpy(job->trace.rows, rows, count * sizeof *rows);
    job->trace.count = count;
}

void job_add_time(struct job *job, enum job_work work, uint64_t start_ns)
{
    double *const seconds[] = {
        [JOB_LOADING] = &job->seconds.load,  [JOB_BUILDING] = &job->seconds.bvh,
        [JOB_JUDGING] = &job->seconds.judge, [JOB_WRITING] = &job->seconds.write,
        [JOB_TOTAL] = &job->seconds.total,
    };
    *seconds[work] += clock_seconds_since(start_ns);
}

bool job_copy_film(struct job *job, struct arena *arena, struct film_image *out, struct err *err)
{
    return renderer_read(&job->renderer, arena, out, err);
}

bool job_replay(struct job *job, uint32_t x, uint32_t y, uint64_t sample, struct arena *arena,
                struct replay *out, struct err *err)
{
    return renderer_replay(&job->renderer, x, y, sample, arena, out, err);
}

bool job_record_kernel(struct job *job, const struct kernel_recording_params *params,
                       struct kernel_recording *out, struct err *err)
{
    return kernel_recording_create(&job->renderer, params, out, err);
}

bool job_trace_rays(struct job *job, const struct probe_ray *rays, uint32_t count,
                    struct probe_hit *hits, bool *complete, struct err *err)
{
    double ms;
    return ray_probe_trace(&job->renderer, KERNEL_intersect_closest, rays, count, hits, &ms,
                           complete, err);
}
