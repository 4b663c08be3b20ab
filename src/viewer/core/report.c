// Reports the viewer's speed: of the last frames in the panel, and of all frames at the end.
#include "viewer/core/report.h"

#include "base/clock.h"
#include "cli/error_sources_out.h"
#include "cli/exit_code.h"
#include "cli/options.h"
#include "job/film_error.h"
#include "report/json_out.h"
#include "report/text_out.h"
#include "viewer/core/frame.h"
#include "viewer/core/messages.h"
#include "viewer/core/viewer.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define RATE_SECONDS 0.5     // interval over which rates are averaged
#define NEWEST 0.1           // weight of the newest frame in the running means per kernel
#define TIMES_MAX (1u << 20) // more than an hour of frames; times of later frames are not kept

// --- frame times ---------------------------------------------------------------------------------

// Adds the time of a frame. When out of memory, the frame is left out.
void frame_times_add(struct frame_times *times, double ms)
{
    if (times->count == times->capacity && times->count < TIMES_MAX) {
        uint32_t capacity = times->capacity ? 2 * times->capacity : 256;
        float *larger = realloc(times->ms, capacity * sizeof *larger);
        if (!larger)
            return;
        times->ms = larger;
        times->capacity = capacity;
    }
    if (times->count < times->capacity)
        times->ms[times->count++] = (float)ms;
}

void frame_times_finish(struct frame_times *times)
{
    free(times->ms);
    *times = (struct frame_times){0};
}

static int compare(const void *a, const void *b)
{
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

double frame_times_quantile(struct frame_times *times, double part)
{
    if (times->count == 0)
        return NAN;
    qsort(times->ms, times->count, sizeof *times->ms, compare);
    uint32_t at = (uint32_t)(part * (times->count - 1) + 0.5);
    return (double)times->ms[at];
}

// --- the last frames -----------------------------------------------------------------------------

static void count_kernels(struct viewer *viewer, double *rays)
{
    double ms[KERNEL_COUNT] = {0};
    for (uint32_t side = 0; side < viewer->stage.side_count; side++) {
        struct view *view = &viewer->stage.sides[side];
        const struct render_stats *now = &view->job.renderer.stats, *seen = &view->seen;
        if (!view->is_ready)
            continue;
        for (int id = 0; id < KERNEL_COUNT; id++)
            ms[id] += now->kernels[id].ms - seen->kernels[id].ms;
        *rays += render_stats_rays(now) - render_stats_rays(seen);
        view->seen = *now;
    }
    for (int id = 0; id < KERNEL_COUNT; id++)
        viewer->stage.stats.kernel_ms[id] += NEWEST * (ms[id] - viewer->stage.stats.kernel_ms[id]);
}

static void count_rates(struct viewer *viewer, double rays)
{
    struct frame_rate *rate = &viewer->stage.rate;
    struct frame_stats *stats = &viewer->stage.stats;
    double now = viewer_seconds(viewer), seconds = now - rate->since;
    rate->frames++;
    rate->rays += rays;
    rate->samples += viewer->stage.frame_samples;
    if (seconds < RATE_SECONDS)
        return;
    stats->fps = rate->frames / seconds;
    stats->frame_ms = 1e3 * seconds / rate->frames;
    stats->rays_per_second = rate->rays / seconds;
    stats->samples_per_second = rate->samples / seconds;
    *rate = (struct frame_rate){.since = now};
}

static bool is_resting(const struct viewer *viewer)
{
    bool is_done = !viewer->view.is_moving;
    for (uint32_t side = 0; side < viewer->stage.side_count && viewer->document.has_scene; side++) {
        const struct view *view = &viewer->stage.sides[side];
        bool goes_on = view->method.fresh_frames && !viewer->stage.is_paused;
        is_done &= view->is_ready && !goes_on && viewer_samples_left(viewer, view) == 0;
        is_done &= view_is_denoised(viewer, view);
    }
    return is_done && worker_is_idle(viewer->shell.worker) && viewer_holds_nothing(viewer) &&
           !(viewer->view.rig.revolves && viewer->view.rig.mode == CAMERA_RIG_ORBIT);
}

void viewer_header(const struct viewer *viewer, char out[VIEWER_HEADER_MAX])
{
    const double *p = viewer->view.camera.position;
    unsigned long long frames = (unsigned long long)viewer->stage.stats.frames;
    double seconds = viewer->stage.sides[viewer->stage.edited_side].seconds;
    snprintf(out, VIEWER_HEADER_MAX, "frame %llu, %.1f s, camera %.4g, %.4g, %.4g", frames, seconds,
             p[0], p[1], p[2]);
}

void viewer_count_frame(struct viewer *viewer)
{
    struct frame_stats *stats = &viewer->stage.stats;
    double rays = 0.0, ms = clock_seconds_since(viewer->shell.frame_ns) * 1e3;
    // With vsync, the time of presentation includes waiting for the display.
    double waiting = viewer->stage.swapchain.vsync ? stats->present_ms : 0.0;
    stats->frames++;
    frame_budget_measure(&viewer->view.pace, 0.0, 0.0,
                         fmax(ms - stats->render_ms - stats->denoise_ms - waiting, 0.0));
    if (viewer->document.has_scene)
        count_kernels(viewer, &rays);
    count_rates(viewer, rays);
    viewer->stage.is_resting = is_resting(viewer);
    if (viewer->document.has_scene && !viewer->stage.is_paused && !viewer->stage.is_resting)
        frame_times_add(viewer->view.is_moving ? &viewer->stage.moving_times
                                               : &viewer->stage.resting_times,
                        ms);
}

// --- the summary at the end ----------------------------------------------------------------------

static json_t *times_json(struct frame_times *times)
{
    return json_pack("{s:i, s:o, s:o}", "frames", (int)times->count, "median",
                     json_number(frame_times_quantile(times, 0.5)), "p95",
                     json_number(frame_times_quantile(times, 0.95)));
}

static json_t *side_json(const struct view *view)
{
    const struct job_look look = view_newest_look(view);
    const struct half_error *error = &look.error;
    return json_pack("{s:I, s:f, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "samples",
                     (json_int_t)view_samples(view), "render_seconds", view->seconds,
                     "local_relmse", json_number(error->local_relmse), "ci_low",
                     json_number(error->ci_low), "ci_high", json_number(error->ci_high), "at_most",
                     json_number(error->at_most), "relmse_at_most",
                     json_number(error->relmse_at_most), "error_samples",
                     json_number(view->look_count > 0 ? look.samples : NAN), "reason",
                     error->reason ? json_string(error->reason) : json_null(), "error_by",
                     error_sources_json(&view->sources, NULL));
}

static void print_json(struct viewer *viewer)
{
    json_t *sides = json_array();
    for (uint32_t side = 0; side < viewer->stage.side_count && viewer->document.has_scene; side++)
        json_array_append_new(sides, side_json(&viewer->stage.sides[side]));
    const struct frame_stats *stats = &viewer->stage.stats;
    double seconds = viewer_seconds(viewer);
    command_print(json_pack(
        "{s:o, s:o, s:{s:i, s:i}, s:I, s:f, s:f, s:o, s:{s:o, s:o}, s:i, s:o, s:i}", "scene",
        viewer->document.has_scene ? json_words(viewer->document.scene_path) : json_null(),
        "device", json_words(viewer->stage.gpu.info.name), "size", "width",
        (int)viewer->shell.window.width, "height", (int)viewer->shell.window.height, "frames",
        (json_int_t)stats->frames, "seconds", seconds, "render_seconds",
        viewer->stage.render_seconds, "fps", json_number((double)stats->frames / seconds),
        "frame_ms", "moving", times_json(&viewer->stage.moving_times), "resting",
        times_json(&viewer->stage.resting_times), "shrink", (int)viewer->view.pace.shrink, "sides",
        sides, "recoveries", (int)viewer->stage.recoveries));
}

static void print_times(const char *label, struct frame_times *times)
{
    double median = frame_times_quantile(times, 0.5);
    if (times->count > 0)
        printf("%s  %u frames, median %.1f ms (%.0f fps), 95 %% within %.1f ms\n", label,
               times->count, median, 1e3 / median, frame_times_quantile(times, 0.95));
}

static void print_side(const struct viewer *viewer, uint32_t index)
{
    const struct view *view = &viewer->stage.sides[index];
    const struct job_look look = view_newest_look(view);
    const struct half_error *error = &look.error;
    char words[FILM_ERROR_WORDS];
    const char *label = viewer->stage.side_count == 1 ? "picture "
                        : index == 0                  ? "left    "
                                                      : "right   ";
    printf("%s  %llu spp in %.3f s of rendering", label, (unsigned long long)view_samples(view),
           view->seconds);
    film_error_words(error, words);
    if (error->known || error->bounded || film_error_is_plain(error))
        printf("; at %.0f spp %s%s%s\n", look.samples, words,
               error->known ? " (bias not included)" : ": ", error->known ? "" : error->reason);
    else
        printf("; the error is not known: %s\n", error->reason);
    bool splits = view->job.renderer.specialization.split_lobes > 0;
    error_sources_print(&view->sources, splits ? NULL : "lampyris render SAVED.json");
}

static void print_text(struct viewer *viewer)
{
    print_line("device    ", viewer->stage.gpu.info.name);
    if (viewer->document.has_scene)
        print_line("scene     ", viewer->document.scene_path);
    printf("frames    %llu of %u x %u in %.1f s, of which %.1f s were rendering\n",
           (unsigned long long)viewer->stage.stats.frames, viewer->shell.window.width,
           viewer->shell.window.height, viewer_seconds(viewer), viewer->stage.render_seconds);
    print_times("moving  ", &viewer->stage.moving_times);
    print_times("resting ", &viewer->stage.resting_times);
    for (uint32_t side = 0; side < viewer->stage.side_count && viewer->document.has_scene; side++)
        print_side(viewer, side);
}

// Estimates the error at the end. If the device is lost, the last known values are reported.
static void judge(struct viewer *viewer)
{
    struct err err = {0};
    for (uint32_t side = 0; side < viewer->stage.side_count && viewer->document.has_scene; side++)
        if (viewer->stage.gpu.lost || !view_look_now(viewer, side, &err))
            return;
}

void viewer_report(struct viewer *viewer)
{
    judge(viewer);
    if (viewer->shell.options->json)
        print_json(viewer);
    else if (!viewer->shell.options->quiet)
        print_text(viewer);
}
