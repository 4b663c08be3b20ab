// Drawing has three steps: display_read turns a film into a linear image of the same size,
// display_scale scales that to its size on the screen, and display_show converts it to colours. A
// step that would change nothing is left out. If a film has several buffers, they are read and
// scaled one after the other.
#include "render/show/denoise.h"
#include "render/show/display_internal.h"

#include "base/false_color.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const struct {
    uint32_t aovs;
    const char *unit;
} kinds[SHOWN_COUNT] = {
    [SHOWN_ALBEDO] = {AOV_ALBEDO, NULL},
    [SHOWN_NORMAL] = {AOV_NORMAL | AOV_ALPHA, NULL},
    [SHOWN_DEPTH] = {AOV_DEPTH, "m"},
    [SHOWN_OBJECTS] = {AOV_IDS, NULL},
    [SHOWN_MATERIALS] = {AOV_IDS, NULL},
    [SHOWN_SAMPLES] = {AOV_SAMPLES, "samples"},
    [SHOWN_VARIANCE] = {AOV_VARIANCE, "(W/(sr m^2))^2"},
    [SHOWN_STEPS] = {AOV_STEPS, "steps"},
    [SHOWN_EMISSION] = {AOV_EMISSION, NULL},
    [SHOWN_DIRECT] = {AOV_DIRECT, NULL},
    [SHOWN_INDIRECT] = {AOV_INDIRECT, NULL},
};

const char *const shown_names[SHOWN_COUNT + 1] = {
    "radiance", "albedo", "normal",   "depth",  "objects",  "materials", "samples",
    "variance", "steps",  "emission", "direct", "indirect", NULL,
};

uint32_t display_aovs(uint32_t shown)
{
    return kinds[shown].aovs;
}

bool shown_has_range(uint32_t shown)
{
    return SHOWN_FALSE & SHOWN_BIT(shown);
}

bool shown_is_logarithmic(uint32_t shown)
{
    return SHOWN_LOGARITHMIC & SHOWN_BIT(shown);
}

const char *shown_unit(uint32_t shown)
{
    return kinds[shown].unit ? kinds[shown].unit : "";
}

// --- creation ------------------------------------------------------------------------------------

enum { PALETTE_COLORS = 257 };

static bool create_palette(struct display *d, struct err *err)
{
    float palette[PALETTE_COLORS][4] = {0};
    for (int i = 0; i < PALETTE_COLORS; i++) {
        double rgb[3];
        false_color(i / (double)(PALETTE_COLORS - 1), rgb);
        for (int c = 0; c < 3; c++)
            palette[i][c] = (float)rgb[c];
    }
    return display_reserve_bytes(d, "display palette", sizeof palette, true, &d->own->palette,
                                 err) &&
           gpu_upload(d->gpu, &d->own->palette, 0, palette, sizeof palette, err);
}

bool display_create(struct gpu *gpu, struct display *d, struct err *err)
{
    *d = (struct display){.gpu = gpu, .own = calloc(1, sizeof *d->own)};
    if (!d->own)
        return err_memory(err, "display", sizeof *d->own);
    if (paced_create(gpu, &d->own->paced, err) && create_palette(d, err))
        return true;
    display_finish(d);
    return false;
}

void display_finish(struct display *d)
{
    if (!d || !d->own)
        return;
    display_work_finish(d);
    for (int i = 0; i < 2; i++) {
        struct display_pictures *side = &d->own->sides[i];
        struct gpu_buffer *const buffers[] = {
            &side->film.buffer,          &side->kept.buffer, &side->kept_next.buffer,
            &side->sized.picture.buffer, &side->sized.taps,  &side->kept_sized.picture.buffer,
            &side->kept_sized.taps,      &side->sources,
        };
        for (size_t b = 0; b < sizeof buffers / sizeof buffers[0]; b++)
            gpu_buffer_finish(d->gpu, buffers[b]);
    }
    gpu_buffer_finish(d->gpu, &d->own->palette);
    gpu_buffer_finish(d->gpu, &d->own->range);
    gpu_buffer_finish(d->gpu, &d->pixels);
    free(d->own);
    *d = (struct display){0};
}

// --- from a film to a linear image ---------------------------------------------------------------

// Uploads the tables by which kernels find the object of a primitive: see flat_triangle_source().
static bool upload_sources(struct display *d, const struct flat_scene *flat, struct gpu_buffer *out,
                           struct err *err)
{
    uint64_t runs = (uint64_t)flat->instance_count + flat->mesh_count;
    uint64_t words = flat->dropped_degenerate + runs + flat->placed_count;
    uint32_t *sources = malloc((words ? words : 1) * sizeof *sources);
    if (!sources)
        return err_memory(err, "objects", words * sizeof *sources);
    uint32_t *to = sources;
    for (uint32_t i = 0; i < flat->dropped_degenerate; i++)
        *to++ = flat->dropped_before[i];
    for (uint64_t i = 0; i < runs; i++)
        *to++ = flat->instance_first[i];
    for (uint32_t i = 0; i < flat->placed_count; i++)
        *to++ = flat->instances[i].source;
    bool ok =
        display_reserve_bytes(d, "display sources", words * sizeof *sources, false, out, err) &&
        gpu_upload(d->gpu, out, 0, sources, words * sizeof *sources, err);
    free(sources);
    return ok;
}

// The state of one side of the window while it is drawn.
struct side {
    const struct display_side *call;
    struct display_pictures *pictures;
    const struct display_call *draw;
    const struct linear *picture, *kept; // both have the size on the screen; kept: NULL if there is
                                         // none
};

static uint32_t wanted_width(const struct side *side)
{
    return side->draw->picture[2];
}

static uint32_t wanted_height(const struct side *side)
{
    return side->draw->picture[3];
}

static bool is_wanted(const struct side *side, const struct linear *picture)
{
    return picture->width == wanted_width(side) && picture->height == wanted_height(side);
}

static bool read_part(struct display *d, const struct side *side, const struct display_part *part,
                      struct err *err)
{
    const struct renderer *r = side->call->renderer;
    const struct denoiser *denoiser = side->call->denoiser;
    uint32_t shown = side->draw->shown;
    bool is_denoised = denoiser && shown == SHOWN_RADIANCE;
    const struct display_work work = {
        .code = DISPLAY_READ,
        .constants =
            {
                [DISPLAY_CONSTANT_SHOWN] = shown,
                [DISPLAY_CONSTANT_FLAGS] = is_denoised ? DISPLAY_DENOISED : 0,
                [DISPLAY_CONSTANT_AOVS] = is_denoised ? 0 : r->specialization.aovs,
                [DISPLAY_CONSTANT_HALVES] = shown == SHOWN_VARIANCE ? r->specialization.halves : 0,
            },
        .push =
            {
                .items = part->count,
                .first_pixel = part->first,
                .planned_samples = r->frame.samples,
                .dropped = r->flat.dropped_degenerate,
                .instances = r->flat.instance_count,
                .meshes = r->flat.mesh_count,
            },
        .buffers = {[DISPLAY_BINDING_FILM] = is_denoised ? NULL : &r->film[part->chunk],
                    [DISPLAY_BINDING_DENOISED] = is_denoised ? &denoiser->picture : NULL,
                    [DISPLAY_BINDING_SOURCES] =
                        shown == SHOWN_OBJECTS ? &side->pictures->sources : NULL,
                    [DISPLAY_BINDING_TO] = &side->pictures->film.buffer},
        .threads = part->count,
    };
    return display_dispatch(d, &work, err);
}

// Checks that film and denoiser have the same size, and that the renderer computes the AOV that is
// to be shown.
static bool check_side(const struct side *side, struct err *err)
{
    const struct renderer *r = side->call->renderer;
    const struct denoiser *denoiser = side->call->denoiser;
    uint32_t shown = side->draw->shown;
    uint32_t needed = film_aovs_of_device(display_aovs(shown));
    if ((r->specialization.aovs & needed) != needed)
        return err_set(err, ERR_BUG,
                       "%s cannot be shown: the renderer was made with AOVs 0x%x; "
                       "expected 0x%x among them",
                       shown_names[shown], r->specialization.aovs, needed);
    if (denoiser && shown == SHOWN_RADIANCE &&
        (denoiser->width != r->frame.width || denoiser->height != r->frame.height))
        return err_set(err, ERR_BUG,
                       "a denoised picture has %u x %u pixels; expected %u x %u, the size of "
                       "the film",
                       denoiser->width, denoiser->height, r->frame.width, r->frame.height);
    return true;
}

// Reads a film that has one buffer.
static bool read_whole(struct display *d, struct side *side, struct err *err)
{
    const struct renderer *r = side->call->renderer;
    struct display_pictures *own = side->pictures;
    const struct display_part all = {.count = r->frame.width * r->frame.height};
    if (!display_reserve(d, "display film", r->frame.width, r->frame.height, &own->film, err) ||
        !read_part(d, side, &all, err))
        return false;
    side->picture = &own->film;
    if (is_wanted(side, &own->film))
        return true;
    side->picture = &own->sized.picture;
    return display_reserve(d, "display sized", wanted_width(side), wanted_height(side),
                           &own->sized.picture, err) &&
           display_scale(d, &own->film, NULL, side->draw->nearest, &own->sized, err);
}

static bool read_in_parts(struct display *d, struct side *side, struct err *err)
{
    const struct renderer *r = side->call->renderer;
    struct display_pictures *own = side->pictures;
    uint64_t pixels = (uint64_t)r->frame.width * r->frame.height;
    uint64_t chunk_pixels = r->plan.film_chunk_pixels;
    struct linear *sized = &own->sized.picture;
    side->picture = sized;
    // The linear image of one chunk is stored as chunk_pixels rows of one pixel.
    if (!display_reserve(d, "display film", 1, (uint32_t)chunk_pixels, &own->film, err) ||
        !display_reserve(d, "display sized", wanted_width(side), wanted_height(side), sized, err))
        return false;
    const struct linear film = {own->film.buffer, r->frame.width, r->frame.height};
    gpu_fill(d->gpu, &d->own->paced.commands, &sized->buffer, 0, sized->buffer.bytes, 0);
    gpu_barrier(d->gpu, &d->own->paced.commands);
    struct display_part part = {0};
    for (uint64_t first = 0; first < pixels; first += chunk_pixels, part.chunk++) {
        uint64_t left = pixels - first;
        part.first = (uint32_t)first;
        part.count = (uint32_t)(left < chunk_pixels ? left : chunk_pixels);
        if (!read_part(d, side, &part, err) ||
            !display_scale(d, &film, &part, side->draw->nearest, &own->sized, err))
            return false;
    }
    return true;
}

// Finds the kept image if it shows the same quantity, and scales it to the size on the screen.
static bool find_kept(struct display *d, struct side *side, struct err *err)
{
    struct display_pictures *own = side->pictures;
    if (!side->draw->use_kept || !own->is_kept || own->kept_shown != side->draw->shown)
        return true;
    side->kept = &own->kept;
    if (is_wanted(side, &own->kept))
        return true;
    side->kept = &own->kept_sized.picture;
    return display_reserve(d, "display kept, sized", wanted_width(side), wanted_height(side),
                           &own->kept_sized.picture, err) &&
           display_scale(d, &own->kept, NULL, side->draw->nearest, &own->kept_sized, err);
}

static bool read_side(struct display *d, const struct display_call *call, uint32_t index,
                      struct side *side, struct err *err)
{
    *side = (struct side){
        .call = &call->sides[index],
        .pictures = &d->own->sides[index],
        .draw = call,
    };
    const struct renderer *r = side->call->renderer;
    if (!check_side(side, err) || (call->shown == SHOWN_OBJECTS &&
                                   !upload_sources(d, &r->flat, &side->pictures->sources, err)))
        return false;
    bool is_whole = (uint64_t)r->frame.width * r->frame.height <= r->plan.film_chunk_pixels;
    return (is_whole ? read_whole : read_in_parts)(d, side, err) && find_kept(d, side, err);
}

// --- from linear images to colours ---------------------------------------------------------------

static void set_range(const struct display_call *call, const double range[2],
                      struct gpu_display_push *push)
{
    double low = range[0], high = range[1];
    if (shown_is_logarithmic(call->shown)) {
        low = log2(fmax(low, (double)FLT_MIN));
        high = log2(fmax(high, (double)FLT_MIN));
    }
    push->range_low = (float)low;
    push->range_scale = high > low ? (float)(1 / (high - low)) : 0.0f;
}

static struct display_work work_of_show(const struct display *d, const struct display_call *call,
                                        const struct side *sides, uint32_t count)
{
    bool is_kept = false;
    for (uint32_t i = 0; i < count; i++)
        is_kept = is_kept || sides[i].kept;
    struct display_work work = {
        .code = DISPLAY_SHOW,
        .constants =
            {
                [DISPLAY_CONSTANT_SHOWN] = call->shown,
                [DISPLAY_CONSTANT_FLAGS] =
                    (count > 1 ? DISPLAY_TWO : 0) | (is_kept ? DISPLAY_KEPT : 0),
                [DISPLAY_CONSTANT_TONE] =
                    SHOWN_TONED & SHOWN_BIT(call->shown) ? (uint32_t)call->tone : 0,
            },
        .buffers = {[DISPLAY_BINDING_PALETTE] = &d->own->palette},
    };
    for (uint32_t i = 0; i < count; i++) {
        work.buffers[DISPLAY_BINDING_LEFT + i] = &sides[i].picture->buffer;
        // A side without a kept image is blended with itself, with weight 0.
        const struct linear *kept = sides[i].kept ? sides[i].kept : sides[i].picture;
        work.buffers[DISPLAY_BINDING_KEPT_LEFT + i] = is_kept ? &kept->buffer : NULL;
    }
    return work;
}

static bool show(struct display *d, const struct display_call *call, const struct side *sides,
                 const double range[2], struct err *err)
{
    struct display_work work = work_of_show(d, call, sides, call->side_count);
    uint32_t pixels = call->width * call->height;
    double split = floor(fmin(fmax(call->split, 0), 1) * call->picture[2] + 0.5);
    work.push = (struct gpu_display_push){
        .items = pixels,
        .width = call->width,
        .height = call->height,
        .left = call->picture[0],
        .top = call->picture[1],
        .picture_width = call->picture[2],
        .picture_height = call->picture[3],
        .split = call->side_count > 1 ? (uint32_t)split : call->picture[2],
        .gain = exp2f(call->exposure_stops),
    };
    set_range(call, range, &work.push);
    work.buffers[DISPLAY_BINDING_PIXELS] = &d->pixels;
    work.threads = pixels;
    return display_dispatch(d, &work, err);
}

static bool check_call(const struct display *d, const struct display_call *call, struct err *err)
{
    const uint32_t *p = call->picture;
    uint64_t pixels = (uint64_t)call->width * call->height;
    if (call->shown >= SHOWN_COUNT || call->side_count > 2 || pixels == 0)
        return err_set(
            err, ERR_BUG,
            "quantity %u on %u sides of %u x %u pixels; expected a quantity below %u, at "
            "most 2 sides, and width and height above 0",
            call->shown, call->side_count, call->width, call->height, SHOWN_COUNT);
    if (pixels > d->gpu->max_storage_range / sizeof(uint32_t))
        return err_set(
            err, ERR_GPU,
            "an output of %u x %u pixels; expected at most %llu pixels, the device's limit",
            call->width, call->height,
            (unsigned long long)(d->gpu->max_storage_range / sizeof(uint32_t)));
    if (call->side_count == 0)
        return true;
    if (p[2] == 0 || p[3] == 0 || p[2] > DISPLAY_SIDE_MAX || p[3] > DISPLAY_SIDE_MAX)
        return err_set(err, ERR_BUG,
                       "a picture of %u x %u pixels; expected sides from 1 to %u pixels", p[2],
                       p[3], DISPLAY_SIDE_MAX);
    if ((uint64_t)p[0] + p[2] > call->width || (uint64_t)p[1] + p[3] > call->height)
        return err_set(err, ERR_BUG,
                       "a picture of %u x %u pixels at (%u, %u); expected one inside of %u x %u",
                       p[2], p[3], p[0], p[1], call->width, call->height);
    return true;
}

static bool show_nothing(struct display *d, struct err *err)
{
    const uint32_t black = 0xff000000;
    gpu_fill(d->gpu, &d->own->paced.commands, &d->pixels, 0, d->pixels.bytes, black);
    return display_end(d, err);
}

bool display_draw(struct display *d, const struct display_call *call, struct err *err)
{
    struct side sides[2] = {0};
    double range[2] = {call->range[0], call->range[1]};
    d->ms = 0;
    if (!check_call(d, call, err) ||
        !display_reserve_bytes(d, "display pixels",
                               (uint64_t)call->width * call->height * sizeof(uint32_t), false,
                               &d->pixels, err) ||
        !display_begin(d, err))
        return false;
    if (call->side_count == 0)
        return show_nothing(d, err);
    for (uint32_t i = 0; i < call->side_count; i++)
        if (!read_side(d, call, i, &sides[i], err))
            return false;
    if (shown_has_range(call->shown) && !(range[1] > range[0])) {
        const struct linear *const pictures[] = {sides[0].picture, sides[1].picture};
        if (!display_find_range(d, call->shown, pictures, call->side_count, range, err))
            return false;
    }
    memcpy(d->range, range, sizeof range);
    return show(d, call, sides, range, err) && display_end(d, err);
}

// --- kept images ---------------------------------------------------------------------------------

static bool keep_side(struct display *d, const struct display_call *call, uint32_t index,
                      struct err *err)
{
    struct side side;
    struct display_pictures *own = &d->own->sides[index];
    if (!read_side(d, call, index, &side, err) ||
        !display_reserve(d, "display kept", call->picture[2], call->picture[3], &own->kept_next,
                         err))
        return false;
    struct display_work work = work_of_show(d, call, &side, 1);
    work.constants[DISPLAY_CONSTANT_FLAGS] |= DISPLAY_KEEP;
    work.constants[DISPLAY_CONSTANT_SHOWN] = work.constants[DISPLAY_CONSTANT_TONE] = 0;
    work.push.items = call->picture[2] * call->picture[3];
    work.threads = work.push.items;
    work.buffers[DISPLAY_BINDING_TO] = &own->kept_next.buffer;
    return display_dispatch(d, &work, err);
}

bool display_keep(struct display *d, const struct display_call *call, struct err *err)
{
    if (call->side_count == 0)
        return true;
    if (!check_call(d, call, err) || !display_begin(d, err))
        return false;
    for (uint32_t i = 0; i < call->side_count; i++)
        if (!keep_side(d, call, i, err))
            return false;
    if (!display_end(d, err))
        return false;
    for (uint32_t i = 0; i < call->side_count; i++) {
        struct display_pictures *own = &d->own->sides[i];
        struct linear next = own->kept_next;
        own->kept_next = own->kept;
        own->kept = next;
        own->is_kept = true;
        own->kept_shown = call->shown;
    }
    return true;
}

void display_forget(struct display *d)
{
    for (int i = 0; i < 2; i++)
        d->own->sides[i].is_kept = false;
}
