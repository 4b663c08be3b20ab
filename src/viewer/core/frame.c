// Uses the device for one frame: renders samples and displays them.
#include "viewer/core/frame.h"

#include "base/clock.h"
#include "base/signals.h"
#include "viewer/core/changes.h"
#include "viewer/core/messages.h"
#include "viewer/core/viewer.h"
#include <math.h>
#include <string.h>

// --- the place of the image in the window --------------------------------------------------------

void viewer_picture_size(const struct viewer *viewer, uint32_t *width, uint32_t *height)
{
    *width = viewer->shell.window.width;
    *height = viewer->shell.window.height;
}

void viewer_picture_place(const struct viewer *viewer, uint32_t place[4])
{
    uint32_t width = viewer->shell.window.width, height = viewer->shell.window.height, left = 0;
    if (viewer->shell.is_panel_shown)
        left = (uint32_t)gui_panel_width(&viewer->shell.gui, width);
    place[0] = left;
    place[2] = width - left;
    place[3] = (uint32_t)fmax(round((double)height * place[2] / width), 1.0);
    place[1] = (height - place[3]) / 2;
}

double viewer_split_x(const struct viewer *viewer)
{
    uint32_t place[4];
    viewer_picture_place(viewer, place);
    return place[0] + viewer->stage.shown.split_at * place[2];
}

// If an image must be shown completely, a frame may take this many times its target time, because a
// slow frame is better than one in which two cameras are visible.
#define PATIENCE 8.0
// At rest, denoising pauses for this multiple of its own time, so that it takes a quarter of the
// time.
#define DENOISING_PAUSE 3.0
// If there was no event for this many seconds, the user counts as idle.
#define CALM_SECONDS 0.3

// --- rendering -----------------------------------------------------------------------------------

bool viewer_frame_is_over(void *context)
{
    const struct viewer *viewer = context;
    return clock_ns() >= viewer->stage.render_until_ns || signals_received() != 0;
}

// Returns the time, in milliseconds, for which a frame renders.
static double frame_render_ms(const struct viewer *viewer)
{
    bool is_calm = !viewer->view.is_moving && !viewer->shell.gui.is_busy &&
                   viewer_holds_nothing(viewer) &&
                   viewer_seconds(viewer) - viewer->shell.input_seconds > CALM_SECONDS;
    return is_calm ? frame_budget_calm_render_ms(&viewer->view.pace)
                   : frame_budget_render_ms(&viewer->view.pace);
}

// Returns the total number of samples in the film, over all pixels.
static double work_done(const struct view *view)
{
    const struct renderer *r = &view->job.renderer;
    return (double)view_samples(view) * r->frame.width * r->frame.height +
           (double)(r->pass.position << r->pass.shift);
}

uint64_t viewer_samples_left(const struct viewer *viewer, const struct view *view)
{
    uint64_t limit = viewer->stage.shown.spp_limit, done = view_samples(view);
    if (view->method.fresh_frames) // each frame is an image of its own
        limit = view->method.samples_a_frame;
    if (limit == 0)
        limit = SETTINGS_SPP_MAX;
    if (viewer->stage.is_paused) // if the image changed, a paused viewer still shows it once
        limit = 1;
    return limit > done ? limit - done : 0;
}

// Returns the number of samples per pixel in a pass. Each pass has a fixed cost, so fast devices
// take as many as fit into a frame. The display lags behind by one pass, which is limited to an
// eighth of the image's samples.
static uint64_t samples_at_once(const struct viewer *viewer, const struct view *view)
{
    const struct renderer *r = &view->job.renderer;
    uint64_t left = viewer_samples_left(viewer, view), most = 1 + view_samples(view) / 8;
    double pass_ms = viewer->view.pace.ms_per_sample * r->frame.width * r->frame.height;
    double fit = pass_ms > 0.0 ? floor(frame_render_ms(viewer) / pass_ms) : 1.0;
    uint64_t samples = fit > 1.0 ? (uint64_t)fmin(fit, 1u << USUAL_SAMPLE_SHIFT) : 1;
    samples = samples < most ? samples : most;
    return samples < left ? samples : left;
}

// Renders until the time of the frame is over, or until nothing is left to render.
static bool render_side(struct viewer *viewer, struct view *view, uint64_t samples, struct err *err)
{
    double before = work_done(view);
    uint64_t start = clock_ns();
    bool stopped = false;
    job_go_on(&view->job);
    while (!stopped && viewer_samples_left(viewer, view) > 0 && samples > 0) {
        const struct job_step step = {.samples = view->job.renderer.next_sample +
                                                 samples_at_once(viewer, view)};
        uint64_t done = view_samples(view);
        if (!job_advance(&view->job, &step, err))
            return false;
        done = view_samples(view) - done;
        samples = samples > done ? samples - done : 0;
        stopped |=
            view->job.stopped || viewer_frame_is_over(viewer) || view_wants_look(viewer, view);
    }
    double seconds = clock_seconds_since(start), work = work_done(view) - before;
    view->seconds += seconds;
    view->turn_seconds += seconds;
    viewer->stage.stats.render_ms += seconds * 1e3;
    viewer->stage.render_seconds += seconds;
    viewer->stage.frame_samples += work;
    if (view->is_preview || viewer->view.is_moving)
        frame_budget_measure_small(&viewer->view.pace, work, seconds * 1e3);
    else
        frame_budget_measure(&viewer->view.pace, work, seconds * 1e3,
                             viewer->view.pace.overhead_ms);
    return true;
}

// Sets the time at which rendering should stop to half a wave before the end of the frame: the last
// wave then ends at most half a wave after the end.
static void set_time(struct viewer *viewer, const struct view *view, double factor)
{
    double wave_ms = viewer->view.pace.ms_per_sample * view->job.renderer.plan.wave_samples;
    double ms = fmax(factor * frame_render_ms(viewer) - 0.5 * wave_ms, 0.0);
    viewer->stage.render_until_ns = isfinite(ms) ? clock_ns() + (uint64_t)(ms * 1e6) : UINT64_MAX;
}

// Makes waves smaller if they take longer than a frame; this does not change the image. The
// measured times are only accurate to a factor of two.
static bool fit_wave(struct viewer *viewer, struct view *view, struct err *err)
{
    uint32_t now = view->job.renderer.plan.wave_slots;
    uint32_t fit = frame_budget_wave(&viewer->view.pace, frame_render_ms(viewer));
    if (fit > view->usual_wave)
        fit = view->usual_wave;
    bool is_close = fit <= 2 * now && now <= 2 * fit;
    if (view->method.wave || is_close)
        return true;
    if (job_set_wave(&view->job, fit, err))
        return true;
    if (viewer->stage.gpu.lost)
        return false;
    // The renderer has freed its buffers, so the side must be rebuilt.
    viewer_message(viewer, MESSAGE_WARNING, "%s", err->msg);
    *err = (struct err){0};
    view->is_ready = false;
    return true;
}

static bool clear_fresh(struct viewer *viewer, struct view *view, struct err *err)
{
    struct display_call call;
    uint32_t wanted = view->method.samples_a_frame;
    if (!view->method.fresh_frames || viewer->stage.is_paused ||
        view_samples(view) < (wanted ? wanted : 1))
        return true;
    viewer_display_call(viewer, &call);
    viewer->stage.has_kept = true;
    if (!display_keep(&viewer->stage.display, &call, err) || !job_clear(&view->job, err))
        return false;
    view->first_sample = view->job.renderer.next_sample;
    return true;
}

// Renders the sides that must be shown completely: those that have no sample and no older image to
// show, and those with a fixed number of samples per frame.
static bool render_whole(struct viewer *viewer, struct view *view, bool *done, struct err *err)
{
    uint32_t wanted = view->method.samples_a_frame;
    bool is_empty = view_samples(view) == 0 && !viewer->stage.has_kept;
    *done = is_empty || wanted > 0;
    if (!*done)
        return true;
    set_time(viewer, view, wanted > 0 ? INFINITY : PATIENCE);
    return render_side(viewer, view, wanted > 0 ? wanted : 1, err);
}

// Returns the side that has used less of the device's time.
static struct view *next_side(struct viewer *viewer, const bool *done)
{
    struct view *next = NULL;
    for (uint32_t side = 0; side < viewer->stage.side_count; side++) {
        struct view *view = &viewer->stage.sides[side];
        if (!done[side] && viewer_samples_left(viewer, view) > 0 &&
            (!next || view->turn_seconds < next->turn_seconds))
            next = view;
    }
    return next;
}

bool viewer_render(struct viewer *viewer, struct err *err)
{
    bool done[VIEWER_SIDES] = {false};
    viewer->stage.stats.render_ms = viewer->stage.frame_samples = 0.0;
    if (!viewer->document.has_scene)
        return true;
    for (uint32_t side = 0; side < viewer->stage.side_count; side++) {
        struct view *view = &viewer->stage.sides[side];
        if (!clear_fresh(viewer, view, err) || !render_whole(viewer, view, &done[side], err))
            return false;
    }
    double whole_ms = frame_render_ms(viewer), left_ms = whole_ms - viewer->stage.stats.render_ms;
    if (left_ms <= 0.0)
        return true;
    struct view *view = next_side(viewer, done);
    if (!view)
        return true;
    set_time(viewer, view, left_ms / whole_ms);
    if (!fit_wave(viewer, view, err))
        return false;
    return !view->is_ready || render_side(viewer, view, UINT64_MAX, err);
}

// --- display -------------------------------------------------------------------------------------

static bool denoises(const struct viewer *viewer, const struct view *view)
{
    return viewer->stage.shown.denoise && viewer->stage.shown.what == SHOWN_RADIANCE &&
           view->denoiser.gpu;
}

void viewer_display_call(const struct viewer *viewer, struct display_call *out)
{
    const struct shown *shown = &viewer->stage.shown;
    uint32_t width = viewer->shell.window.width, height = viewer->shell.window.height;
    *out = (struct display_call){
        .split = shown->split_at,
        .shown = shown->what,
        .exposure_stops = shown->exposure,
        .tone = (enum tone_curve)shown->tone,
        .range = {shown->automatic ? 0.0 : shown->range[0],
                  shown->automatic ? 0.0 : shown->range[1]},
        .width = width,
        .height = height,
        .nearest = shown->nearest,
    };
    viewer_picture_place(viewer, out->picture);
    if (!viewer->document.has_scene)
        return;
    for (uint32_t side = 0; side < viewer->stage.side_count; side++) {
        const struct view *view = &viewer->stage.sides[side];
        if (!view->is_ready)
            return;
        out->sides[side] = (struct display_side){
            .renderer = &view->job.renderer,
            .denoiser =
                denoises(viewer, view) && view->denoised_samples > 0 ? &view->denoiser : NULL,
        };
        out->side_count = side + 1;
        out->use_kept |= viewer->stage.has_kept && view_samples(view) == 0;
    }
}

// Returns whether to denoise: the image is new, or it has more samples than the displayed one and
// the pause is over.
static bool is_denoising_due(const struct viewer *viewer, const struct view *view)
{
    double since = viewer_seconds(viewer) - view->denoised_seconds;
    if (view_is_denoised(viewer, view))
        return false;
    return view->denoised_samples == 0 || since >= DENOISING_PAUSE * view->denoising_seconds;
}

static bool denoise_side(struct viewer *viewer, struct view *view, struct err *err)
{
    const struct denoise_call call = view_denoise_call(viewer, view);
    const struct gpu_frame *frame = &view->job.renderer.frame;
    uint64_t start = clock_ns();
    if (!denoiser_run(&view->denoiser, &call, err))
        return viewer_stop_denoising(viewer, err);
    view->denoising_seconds = clock_seconds_since(start);
    view->denoised_seconds = viewer_seconds(viewer);
    view->denoised_samples = view_samples(view);
    view->denoised_by[0] = viewer->stage.shown.denoise_iterations;
    view->denoised_by[1] = viewer->stage.shown.denoise_temporal;
    viewer->stage.stats.denoise_ms += view->denoising_seconds * 1e3;
    frame_budget_measure_pixels(&viewer->view.pace, (double)frame->width * frame->height,
                                view->denoising_seconds * 1e3);
    return true;
}

static bool denoise(struct viewer *viewer, struct err *err)
{
    viewer->stage.stats.denoise_ms = 0.0;
    for (uint32_t side = 0; side < viewer->stage.side_count && viewer->document.has_scene; side++) {
        struct view *view = &viewer->stage.sides[side];
        if (is_denoising_due(viewer, view) && !denoise_side(viewer, view, err))
            return false;
    }
    if (!viewer->stage.shown.denoise)
        frame_budget_measure_pixels(&viewer->view.pace, 0.0, 0.0);
    return true;
}

// Returns whether to show the previous, denoised small image: until the full-size image is denoised
// for the first time, that is better than noisy first samples.
static bool shows_last(const struct viewer *viewer, const struct display_call *call)
{
    const struct gpu_screen *screen = &viewer->stage.screen;
    bool is_same_size =
        screen->width == viewer->shell.window.width &&
        screen->height == viewer->shell.window.height &&
        memcmp(call->picture, viewer->stage.last_call.picture, sizeof call->picture) == 0;
    bool waits = false;
    for (uint32_t side = 0; side < viewer->stage.side_count && viewer->document.has_scene; side++) {
        const struct view *view = &viewer->stage.sides[side];
        waits |= denoises(viewer, view) && view->denoised_samples == 0 && viewer->stage.has_kept;
    }
    return waits && is_same_size;
}

bool viewer_show(struct viewer *viewer, struct err *err)
{
    struct gpu *gpu = &viewer->stage.gpu;
    struct display_call call;
    if (viewer->shell.window.is_minimised) {
        viewer->stage.last_call.side_count = 0;
        return true;
    }
    if (!denoise(viewer, err))
        return false;
    viewer_display_call(viewer, &call);
    bool draws = !shows_last(viewer, &call);
    if (draws)
        viewer->stage.last_call = call;
    else
        viewer->stage.last_call.side_count = 0;
    if ((draws && !display_draw(&viewer->stage.display, &call, err)) ||
        !gpu_screen_resize(gpu, &viewer->stage.screen, call.width, call.height, err) ||
        !gpu_screen_draw(gpu, &viewer->stage.screen, &viewer->stage.display.pixels,
                         &viewer->shell.drawing, err))
        return false;
    viewer->stage.stats.display_ms = viewer->stage.display.ms;
    viewer->stage.stats.panel_ms = viewer->stage.screen.draw_ms;
    uint64_t start = clock_ns();
    bool ok = swapchain_show(gpu, &viewer->stage.swapchain, &viewer->shell.window,
                             &viewer->stage.screen, err);
    viewer->stage.stats.present_ms = clock_seconds_since(start) * 1e3;
    return ok;
}
