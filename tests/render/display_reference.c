#include "display_reference.h"

#include "image/image.h"
#include "metrics/error_map.h"
#include <float.h>

// --- values --------------------------------------------------------------------------------------

struct values values_new(uint32_t width, uint32_t height, struct arena *arena)
{
    return (struct values){width, height, ARENA_NEW(arena, struct value, (size_t)width * height)};
}

// Returns the fraction of [at, at + 1], in units of `to` pixels, that pixel `from` of `size`
// covers, or its weight in the interpolation.
static double share_of(uint32_t at, uint32_t to, uint32_t from, uint32_t size, bool nearest)
{
    double scale = (double)size / to;
    if (size > to) {
        double low = fmax(at * scale, from), high = fmin((at + 1) * scale, from + 1.0);
        return fmax(high - low, 0) / scale;
    }
    if (nearest)
        return (2 * at + 1) * size / (2 * to) == from ? 1 : 0;
    double centre = fmin(fmax((at + 0.5) * scale - 0.5, 0), size - 1.0);
    return fmax(1 - fabs(centre - from), 0);
}

static struct value scaled_pixel(const struct values *from, uint32_t x, uint32_t y, uint32_t width,
                                 uint32_t height, bool nearest)
{
    struct value sum = {0};
    for (uint32_t j = 0; j < from->height; j++) {
        double share_y = share_of(y, height, j, from->height, nearest);
        for (uint32_t i = 0; share_y > 0 && i < from->width; i++) {
            double share = share_y * share_of(x, width, i, from->width, nearest);
            const struct value *v = &from->pixels[(size_t)j * from->width + i];
            if (!(share > 0))
                continue;
            for (int c = 0; c < 3; c++)
                sum.rgb[c] += share * v->rgb[c];
            sum.weight += share * v->weight;
        }
    }
    return sum;
}

struct values values_scaled(const struct values *from, uint32_t width, uint32_t height,
                            bool nearest, struct arena *arena)
{
    struct values out = values_new(width, height, arena);
    for (uint32_t i = 0; i < width * height; i++)
        out.pixels[i] = scaled_pixel(from, i % width, i / width, width, height, nearest);
    return out;
}

static void color_of_number(uint32_t number, double out[3])
{
    uint32_t hash = number * 2654435769u, mixed = (hash ^ hash >> 15) * 2246822519u;
    double hue = (hash >> 8) * 0x1p-24 * 6, value = 0.6 + 0.4 * (mixed >> 24) / 255;
    double saturation = 0.45 + 0.4 * (mixed >> 16 & 255) / 255;
    static const double shifts[3] = {0, 4, 2};
    for (int c = 0; c < 3; c++) {
        double pure = fmin(fmax(fabs(fmod(hue + shifts[c], 6) - 3) - 1, 0), 1);
        out[c] = number ? value * (1 + saturation * (pure - 1)) : 0;
    }
}

void set_value(struct value *v, const float rgb[3])
{
    for (int c = 0; c < 3; c++)
        v->rgb[c] = (double)rgb[c];
}

static struct value value_of(const struct film_image *film, uint32_t shown, uint32_t i)
{
    const struct film_aovs *aovs = &film->aovs;
    struct value v = {.weight = film->samples[i] > 0};
    if (film->samples[i] == 0)
        return v;
    switch (shown) {
    case SHOWN_RADIANCE:
        set_value(&v, film->mean[i]);
        break;
    case SHOWN_ALBEDO:
        set_value(&v, aovs->albedo[i]);
        break;
    case SHOWN_NORMAL:
        for (int c = 0; c < 3; c++)
            v.rgb[c] = 0.5 * ((double)aovs->normal[i][c] + (double)aovs->alpha[i]);
        break;
    case SHOWN_DEPTH:
        v.rgb[1] = (double)aovs->alpha[i];
        v.rgb[0] = v.rgb[1] > 0 ? (double)aovs->depth[i] * v.rgb[1] : 0;
        break;
    case SHOWN_OBJECTS:
    case SHOWN_MATERIALS:
        color_of_number(aovs->ids[i][shown == SHOWN_OBJECTS ? 0 : 1], v.rgb);
        break;
    case SHOWN_SAMPLES:
        v.rgb[0] = film->samples[i];
        v.rgb[1] = 1;
        break;
    case SHOWN_STEPS:
        v.rgb[0] = (double)aovs->steps[i];
        v.rgb[1] = 1;
        break;
    case SHOWN_VARIANCE:
        for (int c = 0; c < 3 && isfinite(aovs->variance[i][c]); c++) {
            v.rgb[0] += (double)aovs->variance[i][c] / 3;
            v.rgb[1] = 1;
        }
        break;
    case SHOWN_EMISSION:
        set_value(&v, aovs->emission[i]);
        break;
    case SHOWN_DIRECT:
        set_value(&v, aovs->direct[i]);
        break;
    case SHOWN_INDIRECT:
        set_value(&v, aovs->indirect[i]);
        break;
    }
    return v;
}

struct values values_of(const struct film_image *film, uint32_t shown, struct arena *arena)
{
    struct values out = values_new(film->width, film->height, arena);
    for (uint32_t i = 0; i < film->width * film->height; i++)
        out.pixels[i] = value_of(film, shown, i);
    return out;
}

// --- colours -------------------------------------------------------------------------------------

static void encode(const double rgb[3], double out[3])
{
    for (int c = 0; c < 3; c++)
        out[c] = (double)image_srgb_from_linear((float)fmin(fmax(rgb[c], 0), 1));
}

// `nudge` is added to the level, to test the limits of a colour.
static void false_color_of(const struct value *v, uint32_t shown, const double range[2],
                           double nudge, double out[3])
{
    static float palette[ERROR_MAP_COLORS][3]; // computing it takes time
    memset(out, 0, 3 * sizeof *out);
    if (!(v->rgb[1] > 0))
        return;
    if (palette[1][0] == 0)
        error_map_palette(palette);
    double mean = v->rgb[0] / v->rgb[1], low = range[0], high = range[1];
    if (shown_is_logarithmic(shown)) {
        mean = log2(fmax(mean, (double)FLT_MIN));
        low = log2(low);
        high = log2(high);
    }
    double level = fmin(fmax((mean - low) / (high - low) + nudge, 0), 1);
    for (int c = 0; c < 3; c++)
        out[c] = fmin(v->rgb[1] / v->weight, 1) *
                 (double)palette[(int)(level * (ERROR_MAP_COLORS - 1) + 0.5)][c];
}

// Computes display values.
static void color_of(const struct value *v, const struct display_call *call, const double range[2],
                     double nudge, double out[3])
{
    float mean[3], mapped[3];
    memset(out, 0, 3 * sizeof *out);
    if (!(v->weight > 0))
        return;
    if (shown_has_range(call->shown)) {
        false_color_of(v, call->shown, range, nudge, out);
        return;
    }
    for (int c = 0; c < 3; c++) {
        out[c] = v->rgb[c] / v->weight;
        mean[c] = (float)out[c];
    }
    if (SHOWN_TONED & SHOWN_BIT(call->shown)) {
        image_tone_map((enum tone_curve)call->tone, call->exposure_stops, mean, mapped);
        for (int c = 0; c < 3; c++)
            out[c] = (double)mapped[c];
    } else if (call->shown == SHOWN_ALBEDO) {
        encode(out, out);
    }
}

// --- comparing -----------------------------------------------------------------------------------

static bool is_close(const uint8_t pixel[4], const double wanted[3])
{
    bool ok = pixel[3] == 255;
    for (int c = 0; c < 3; c++)
        ok = ok && fabs(pixel[c] - floor(wanted[c] * 255 + 0.5)) <= 1;
    return ok;
}

// Both columns of the line are visible, in either order.
static bool is_line(const struct display_call *call, uint32_t x, double wanted[3])
{
    uint32_t split = (uint32_t)floor(call->split * call->picture[2] + 0.5);
    bool is_first = x + 1 == split;
    if (call->side_count < 2 || (!is_first && x != split))
        return false;
    for (int c = 0; c < 3; c++)
        wanted[c] = is_first ? 0 : 1;
    return true;
}

static bool pixel_agrees(const struct display_call *call, const struct expected *expected,
                         const double range[2], uint32_t x, uint32_t y, const uint8_t pixel[4])
{
    double wanted[3] = {0};
    uint32_t left = x - call->picture[0], top = y - call->picture[1];
    if (left >= call->picture[2] || top >= call->picture[3] || is_line(call, left, wanted))
        return is_close(pixel, wanted);
    bool second = call->side_count > 1 && left >= floor(call->split * call->picture[2] + 0.5);
    const struct values *values = &expected->sides[second];
    for (int n = -1; n <= 1; n++) {
        color_of(&values->pixels[top * values->width + left], call, range, n * 2e-4, wanted);
        if (is_close(pixel, wanted))
            return true;
    }
    fprintf(stderr, "  %u, %u: %u %u %u, expected %g %g %g\n", x, y, pixel[0], pixel[1], pixel[2],
            wanted[0] * 255, wanted[1] * 255, wanted[2] * 255);
    return false;
}

uint8_t (*display_pixels(struct display *display, const struct display_call *call,
                         struct arena *arena))[4]
{
    struct err err = {0};
    uint64_t bytes = (uint64_t)call->width * call->height * 4;
    uint8_t(*pixels)[4] = arena_alloc(arena, call->width * call->height, 4);
    CHECK(gpu_download(display->gpu, &display->pixels, 0, pixels, bytes, &err), "%s", err.msg);
    return pixels;
}

// With the environment variable LAMPYRIS_PICTURES, writes pictures to that folder for inspection.
static void save(const char *name, const struct display_call *call, uint8_t (*pixels)[4],
                 struct arena *arena)
{
    const char *folder = getenv("LAMPYRIS_PICTURES");
    if (!folder)
        return;
    uint32_t count = call->width * call->height;
    struct err err = {0};
    struct image image = {call->width, call->height, arena_alloc(arena, count, 12)};
    for (uint32_t i = 0; i < count; i++)
        for (int c = 0; c < 3; c++)
            image.pixels[i][c] = image_srgb_to_linear((float)pixels[i][c] / 255.0f);
    const struct image_write_params params = {
        .path = arena_printf(arena, "%s/%s.png", folder, name), .image = &image};
    CHECK(image_write(&params, &err), "%s", err.msg);
}

void check_picture(const char *name, struct display *display, const struct display_call *call,
                   const struct expected *expected, struct arena *arena)
{
    struct err err = {0};
    REQUIRE_OK(display_draw(display, call, &err));
    uint8_t(*pixels)[4] = display_pixels(display, call, arena);
    uint32_t wrong = 0;
    save(name, call, pixels, arena);
    for (uint32_t i = 0; i < call->width * call->height && wrong < 4; i++)
        wrong += !pixel_agrees(call, expected, display->range, i % call->width, i / call->width,
                               pixels[i]);
    CHECK(wrong == 0, "%s: %u pixels differ", name, wrong);
}

// --- pictures ------------------------------------------------------------------------------------

bool stage_open(struct stage *s, const char *path, const char *film, uint32_t aovs, struct err *err)
{
    const struct scene_override overrides[] = {{"film", film}, {0}};
    return load_scene(path, overrides, &s->scene, err) &&
           renderer_create(&(struct renderer_params){.gpu = &s->gpu,
                                                     .scene = &s->scene,
                                                     .aovs = aovs,
                                                     .open_ended = true,
                                                     .instancing = INSTANCING_ON},
                           &s->renderer, err) &&
           display_create(&s->gpu, &s->display, err);
}

bool stage_render(struct stage *s, uint64_t samples, struct err *err)
{
    const struct render_call call = {.samples = samples};
    return renderer_render(&s->renderer, &call, err) &&
           renderer_read(&s->renderer, &s->arena, &s->film, err);
}

void stage_close(struct stage *s)
{
    display_finish(&s->display);
    renderer_finish(&s->renderer);
    CHECK(s->gpu.allocated_bytes == 0, "%llu bytes are left",
          (unsigned long long)s->gpu.allocated_bytes);
    scene_finish(&s->scene);
    arena_finish(&s->arena);
    gpu_close(&s->gpu);
    CHECK(s->gpu.validation_messages == 0, "%u validation messages", s->gpu.validation_messages);
}

struct display_call call_of_film(const struct stage *s, uint32_t shown)
{
    uint32_t width = s->renderer.frame.width, height = s->renderer.frame.height;
    return (struct display_call){
        .sides = {{.renderer = &s->renderer}, {.renderer = &s->renderer}},
        .side_count = 1,
        .shown = shown,
        .width = width,
        .height = height,
        .picture = {0, 0, width, height},
    };
}
