#include "render/frame.h"

#include "render/projection.h"
#include "render/shape_sections.h"
#include "render/tables/emitter_power.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

// Sets the members for the lens. start: the result of far_camera_start().
static void set_lens(struct gpu_frame *frame, const struct camera *camera, double scale,
                     double start)
{
    bool has_lens = camera->lens_radius > 0.0;
    double focus_distance = camera->focus_distance * scale;
    frame->lens_radius = (float)(camera->lens_radius * scale);
    // A kernel that has lens code divides by the focus distance even if the camera has no lens.
    frame->focus_distance = has_lens ? (float)focus_distance : 1.0f;
    frame->lens_at_start = has_lens ? (float)(1.0 - start / focus_distance) : 1.0f;
    frame->lens_rotation = (float)camera->lens_rotation;
    frame->lens_blades = camera->lens_blades;
}

// Sets the members for the camera. They are computed in double precision, because with a narrow
// field of view few digits would be left in single precision.
static void set_camera(struct gpu_frame *frame, const struct camera *camera,
                       const struct flat_scene *flat)
{
    struct projection p;
    projection_make(camera, flat, frame->picture_width, frame->picture_height, &p);
    frame->camera_start = (float)p.start;
    set_lens(frame, camera, flat->scale, p.start);
    for (int i = 0; i < 3; i++) {
        frame->camera_position[i] = (float)(p.position[i] + p.start * p.forward[i]);
        frame->camera_forward[i] = (float)p.forward[i];
        frame->camera_right[i] = (float)p.right[i];
        frame->camera_up[i] = (float)p.up[i];
    }
}

// Sets the grid by which rays are sorted. It spans the scene's bounds, in which rays begin, except
// those from infinite planes.
static void set_cells(struct gpu_frame *frame, const struct flat_scene *flat)
{
    for (int c = 0; c < 3; c++) {
        double extent = (double)flat->bounds_max[c] - (double)flat->bounds_min[c];
        double cells = extent > 0.0 ? (1u << SORT_CELL_BITS) / extent : 0.0;
        frame->cells_begin[c] = extent > 0.0 ? flat->bounds_min[c] : 0.0f;
        frame->cells_a_length[c] = cells < (double)FLT_MAX ? (float)cells : 0.0f;
    }
}

// Sets the sphere at which light paths of infinitely far emitters are aimed. Only infinite planes
// extend beyond these bounds.
static void set_bounding_sphere(struct gpu_frame *frame, const struct flat_scene *flat)
{
    bool is_empty = flat->bounds_min[0] > flat->bounds_max[0];
    for (int c = 0; c < 3 && !is_empty; c++)
        frame->scene_center[c] =
            (float)(0.5 * ((double)flat->bounds_min[c] + (double)flat->bounds_max[c]));
    frame->scene_radius = (float)bounding_radius(flat);
}

static void set_environment(struct gpu_frame *frame, const struct environment *environment)
{
    frame->environment_size = environment->width | environment->height << 16;
    if (environment->width == 0)
        frame->environment_size = 1u | 1u << 16; // the white texel that upload.c puts there
    if (environment->present)
        memcpy(frame->environment, environment->radiance, sizeof frame->environment);
    frame->environment_cos = (float)cos(environment->rotation);
    frame->environment_sin = (float)sin(environment->rotation);
}

// Returns the length of ambient-occlusion rays, in the flat scene's unit: `asked`, in metres, but
// at most twice the diagonal of the bounds, because a longer ray from within the bounds meets
// nothing more.
static float ao_distance(const struct flat_scene *flat, float asked)
{
    return (float)fmin((double)asked * flat->scale, 4.0 * bounding_radius(flat));
}

// Ambient occlusion is the radiance that surfaces receive from a white environment.
static void set_ambient_occlusion(struct renderer *r)
{
    r->frame.max_bounces = 1;
    r->frame.ao_distance = ao_distance(&r->flat, r->scene->settings.ao_distance);
    for (int c = 0; c < 3; c++)
        r->frame.environment[c] = 1.0f;
}

// Returns the maximum number of bounces: ROULETTE_FRAME never continues beyond its own limit.
static uint32_t max_bounces(const struct settings *settings)
{
    uint32_t most = settings->integrator == INTEGRATOR_DIRECT ? 1u : settings->max_bounces;
    bool capped = settings->roulette == ROULETTE_FRAME && settings->roulette_max_bounces < most;
    return capped ? settings->roulette_max_bounces : most;
}

// Sets the mean radiance of the environment over all directions.
static void set_ambient(struct gpu_frame *frame, const struct environment *environment)
{
    double sum[3] = {0.0, 0.0, 0.0};
    for (uint32_t y = 0; y < environment->height; y++) {
        double top = cos(M_PI * y / environment->height);
        double weight = (top - cos(M_PI * (y + 1) / environment->height)) / 2.0;
        for (uint32_t x = 0; x < environment->width; x++)
            for (int c = 0; c < 3; c++)
                sum[c] += weight / environment->width *
                          (double)environment->texels[(size_t)y * environment->width + x][c];
    }
    for (int c = 0; c < 3; c++)
        frame->ambient[c] =
            (float)((environment->width ? sum[c] : 1.0) * (double)frame->environment[c]);
}

void frame_look(struct renderer *r, uint32_t width, uint32_t height)
{
    const struct render_window *window = &r->window;
    const struct settings *settings = &r->scene->settings;
    bool has_window = window->width > 0;
    r->frame.width = width;
    r->frame.height = height;
    r->frame.picture_width = has_window ? settings->width : width;
    r->frame.picture_height = has_window ? settings->height : height;
    r->frame.window_first = window->y * r->frame.picture_width + window->x;
    r->rows = (struct film_rows){0, height};
    set_camera(&r->frame, &r->camera, &r->flat);
    in_view_finish(&r->in_view);
}

void in_view_finish(struct in_view *in_view)
{
    free(in_view->lights);
    free(in_view->mask);
    *in_view = (struct in_view){0};
}

void frame_fill(struct renderer *r)
{
    const struct settings *settings = &r->scene->settings;
    const struct shape_sections sections = shape_sections(r->scene, &r->flat);
    r->frame = (struct gpu_frame){
        .seed = settings->seed,
        .max_bounces = max_bounces(settings),
        .emitter_count = r->tables.emitters.count,
        .environment_pick = r->tables.emitters.environment_pick,
        .environment_reach = r->tables.emitters.reach,
        .environment_floor = r->tables.emitters.environment_floor,
        .wave_slots = r->plan.wave_slots,
        .samples = (uint32_t)settings->spp,
        .nee_depth = settings->nee_depth,
        .mis_exponent = settings->mis_exponent,
        .min_density = settings->min_density,
        .split_lobes = r->specialization.split_lobes,
        .clamp_limit = settings->clamp_limit > 0.0f ? settings->clamp_limit : FLT_MAX,
        .roulette_min_bounces = settings->roulette_min_bounces,
        .roulette_max_bounces = settings->roulette_max_bounces,
        .roulette_survival = settings->roulette_survival,
        .direction_exponent = settings->direction_exponent,
        .filter_radius = settings_filter_radius(settings),
        .pixel_strata = settings->pixel_strata,
        .pending_rays = r->specialization.pending_rays,
        .instances = sections.instances,
        .sdfs = sections.sdfs,
        .sdf_code = sections.sdf_code,
        .small_triangles = sections.small_triangles,
        .metre = (float)(1.0 / r->flat.scale),
    };
    set_environment(&r->frame, &r->scene->environment);
    set_cells(&r->frame, &r->flat);
    if (r->specialization.integrator == INTEGRATOR_BIDIR)
        set_bounding_sphere(&r->frame, &r->flat);
    if (settings->integrator == INTEGRATOR_AO)
        set_ambient_occlusion(r);
    if (settings->integrator == INTEGRATOR_WHITTED)
        set_ambient(&r->frame, &r->scene->environment);
    bool has_window = r->window.width > 0;
    frame_look(r, has_window ? r->window.width : settings->width,
               has_window ? r->window.height : settings->height);
}

bool frame_create(struct renderer *r, struct err *err)
{
    return gpu_buffer_create(r->gpu, "frame", sizeof r->frame, GPU_DEVICE, false, &r->frame_buffer,
                             err);
}

bool frame_upload(struct renderer *r, struct err *err)
{
    return gpu_upload(r->gpu, &r->frame_buffer, 0, &r->frame, sizeof r->frame, err);
}
