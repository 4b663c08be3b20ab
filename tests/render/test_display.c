// What a viewer shows, pixel by pixel against a computation on the host.
#include "clock.h"
#include "denoise.h"
#include "display.h"
#include "error_map.h"
#include "image.h"
#include "render_fixture.h"
#include <float.h>

#define ALL_AOVS (AOV_END - 1u)

// --- the same on the host ------------------------------------------------------------------------

// Of a pixel, as in shared/display.h: a value times its weight, and the weight.
struct value {
    double rgb[3], weight;
};

struct values {
    uint32_t width, height;
    struct value *pixels;
};

static struct values values_new(uint32_t width, uint32_t height, struct arena *arena)
{
    return (struct values){width, height, ARENA_NEW(arena, struct value, (size_t)width * height)};
}

// A share of [at, at + 1] in units of `to` pixels that pixel `from` of `size` covers; or how much
// interpolation takes of it.
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

static struct values scale(const struct values *from, uint32_t width, uint32_t height, bool nearest,
                           struct arena *arena)
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

static void set_value(struct value *v, const float rgb[3])
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

static struct values values_of(const struct film_image *film, uint32_t shown, struct arena *arena)
{
    struct values out = values_new(film->width, film->height, arena);
    for (uint32_t i = 0; i < film->width * film->height; i++)
        out.pixels[i] = value_of(film, shown, i);
    return out;
}

static void encode(const double rgb[3], double out[3])
{
    for (int c = 0; c < 3; c++)
        out[c] = (double)image_srgb_from_linear((float)fmin(fmax(rgb[c], 0), 1));
}

// `nudge`: of the level, where a colour begins.
static void false_color_of(const struct value *v, uint32_t shown, const double range[2],
                           double nudge, double out[3])
{
    float palette[ERROR_MAP_COLORS][3];
    memset(out, 0, 3 * sizeof *out);
    if (!(v->rgb[1] > 0))
        return;
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

// Display values.
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
        image_tone_map((enum image_tone)call->tone, call->exposure_stops, mean, mapped);
        for (int c = 0; c < 3; c++)
            out[c] = (double)mapped[c];
    } else if (call->shown == SHOWN_ALBEDO) {
        encode(out, out);
    }
}

// --- comparing -----------------------------------------------------------------------------------

// What is to be seen of each side: values of the size that is shown.
struct expected {
    struct values sides[2];
};

static bool is_close(const uint8_t pixel[4], const double wanted[3])
{
    bool ok = pixel[3] == 255;
    for (int c = 0; c < 3; c++)
        ok = ok && fabs(pixel[c] - floor(wanted[c] * 255 + 0.5)) <= 1;
    return ok;
}

// Both columns of the line are seen, in whatever order.
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

static uint8_t (*pixels_of(struct display *display, const struct display_call *call,
                           struct arena *arena))[4]
{
    struct err err = {0};
    uint64_t bytes = (uint64_t)call->width * call->height * 4;
    uint8_t(*pixels)[4] = arena_alloc(arena, call->width * call->height, 4);
    CHECK(gpu_download(display->gpu, &display->pixels, 0, pixels, bytes, &err), "%s", err.msg);
    return pixels;
}

// With LAMPYRIS_PICTURES in the environment: pictures in that folder, to look at.
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

static void check_picture(const char *name, struct display *display,
                          const struct display_call *call, const struct expected *expected,
                          struct arena *arena)
{
    struct err err = {0};
    REQUIRE_OK(display_draw(display, call, &err));
    uint8_t(*pixels)[4] = pixels_of(display, call, arena);
    uint32_t wrong = 0;
    save(name, call, pixels, arena);
    for (uint32_t i = 0; i < call->width * call->height && wrong < 4; i++)
        wrong += !pixel_agrees(call, expected, display->range, i % call->width, i / call->width,
                               pixels[i]);
    CHECK(wrong == 0, "%s: %u pixels differ", name, wrong);
}

static int by_size(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

// --- pictures ------------------------------------------------------------------------------------

struct stage {
    struct gpu gpu;
    struct scene scene;
    struct renderer renderer;
    struct display display;
    struct arena arena;
    struct film_image film;
};

static bool stage_open(struct stage *s, const char *path, const char *film, uint32_t aovs,
                       struct err *err)
{
    const struct scene_override overrides[] = {{"film", film}, {0}};
    return load_scene(path, overrides, &s->scene, err) &&
           renderer_create(
               &(struct renderer_params){
                   .gpu = &s->gpu, .scene = &s->scene, .aovs = aovs, .open_ended = true},
               &s->renderer, err) &&
           display_create(&s->gpu, &s->display, err);
}

static bool stage_render(struct stage *s, uint64_t samples, struct err *err)
{
    const struct render_call call = {.samples = samples};
    return renderer_render(&s->renderer, &call, err) &&
           renderer_read(&s->renderer, &s->arena, &s->film, err);
}

static void stage_close(struct stage *s)
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

// Of the whole film, one pixel for one.
static struct display_call whole(const struct stage *s, uint32_t shown)
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

TEST(every_curve)
{
    struct stage s = {0};
    struct err err = {0};
    OPEN_GPU(&s.gpu, .validation = true);
    REQUIRE_OK(stage_open(&s, "scenes/cornell.json", "{\"width\": 61, \"height\": 47}", 0, &err));
    REQUIRE_OK(stage_render(&s, 5, &err));
    const struct expected expected = {.sides = {values_of(&s.film, SHOWN_RADIANCE, &s.arena)}};
    for (int tone = TONE_NONE; tone <= TONE_AGX; tone++)
        for (float stops = -3; stops <= 6; stops += 3) {
            struct display_call call = whole(&s, SHOWN_RADIANCE);
            call.tone = (enum tone_curve)tone;
            call.exposure_stops = stops;
            check_picture(tone_names[tone], &s.display, &call, &expected, &s.arena);
        }
    stage_close(&s);
}

// The film as it is, smaller, larger, smaller in one way and larger in the other; inside of a
// larger picture, and with squares for pixels.
TEST(every_size)
{
    static const struct {
        uint32_t width, height, picture[4];
        bool nearest;
    } sizes[] = {
        {64, 50, {1, 2, 61, 47}, false},     {30, 23, {0, 0, 30, 23}, false},
        {100, 90, {7, 3, 61, 80}, false},    {150, 120, {10, 0, 140, 110}, false},
        {150, 120, {10, 0, 140, 110}, true}, {40, 100, {0, 0, 40, 100}, false},
        {20, 20, {5, 5, 1, 1}, true},        {100, 10, {0, 0, 100, 10}, true},
    };
    struct stage s = {0};
    struct err err = {0};
    OPEN_GPU(&s.gpu, .validation = true);
    REQUIRE_OK(stage_open(&s, "scenes/cornell.json", "{\"width\": 61, \"height\": 47}", 0, &err));
    REQUIRE_OK(stage_render(&s, 3, &err));
    const struct values film = values_of(&s.film, SHOWN_RADIANCE, &s.arena);
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        char name[32];
        struct display_call call = whole(&s, SHOWN_RADIANCE);
        call.width = sizes[i].width;
        call.height = sizes[i].height;
        call.nearest = sizes[i].nearest;
        memcpy(call.picture, sizes[i].picture, sizeof call.picture);
        const struct expected expected = {
            .sides = {scale(&film, call.picture[2], call.picture[3], call.nearest, &s.arena)}};
        snprintf(name, sizeof name, "size %zu", i);
        check_picture(name, &s.display, &call, &expected, &s.arena);
    }
    stage_close(&s);
}

// --- what is shown -------------------------------------------------------------------------------

// Where a range is found from the picture, it is that of the values' quantiles, but for what bins
// of a sixteenth of an octave leave open.
static void check_range(const struct display *display, uint32_t shown, const struct values *values)
{
    uint32_t count = values->width * values->height, known = 0;
    double *sorted = malloc(count * sizeof *sorted);
    for (uint32_t i = 0; i < count; i++) {
        const double *v = values->pixels[i].rgb;
        if (v[1] > 0 && (v[0] > 0 || !shown_is_logarithmic(shown)))
            sorted[known++] = v[0] / v[1];
    }
    qsort(sorted, known, sizeof *sorted, by_size);
    bool from_zero = shown == SHOWN_SAMPLES || shown == SHOWN_STEPS;
    double low = from_zero ? 0 : sorted[(uint32_t)(0.01 * (known - 1))];
    double high =
        sorted[(uint32_t)((from_zero ? shown == SHOWN_SAMPLES ? 1 : 0.995 : 0.99) * (known - 1))];
    CHECK(fabs(display->range[0] - low) <= 0.07 * low &&
              fabs(display->range[1] - high) <= 0.07 * high,
          "%s: range %g to %g, expected %g to %g", shown_names[shown], display->range[0],
          display->range[1], low, high);
    free(sorted);
}

static void check_shown(struct stage *s, uint32_t shown)
{
    struct display_call call = whole(s, shown);
    const struct values film = values_of(&s->film, shown, &s->arena);
    struct expected expected = {.sides = {film}};
    char name[64];
    call.tone = TONE_ACES;
    call.exposure_stops = 1;
    check_picture(shown_names[shown], &s->display, &call, &expected, &s->arena);
    if (shown_has_range(shown)) {
        check_range(&s->display, shown, &film);
        call.range[0] = 1e-4;
        call.range[1] = 5;
        snprintf(name, sizeof name, "%s, range given", shown_names[shown]);
        check_picture(name, &s->display, &call, &expected, &s->arena);
        CHECK(s->display.range[0] == 1e-4 && s->display.range[1] == 5, "the range is kept");
    }
    call.picture[2] -= 20;
    call.picture[3] -= 13;
    expected.sides[0] = scale(&film, call.picture[2], call.picture[3], false, &s->arena);
    snprintf(name, sizeof name, "%s, smaller", shown_names[shown]);
    check_picture(name, &s->display, &call, &expected, &s->arena);
}

TEST(everything_shown)
{
    static const char *const scenes[] = {"tests/render/scenes/aovs.json", "scenes/cornell.json"};
    for (int i = 0; i < 2; i++) {
        struct stage s = {0};
        struct err err = {0};
        OPEN_GPU(&s.gpu, .validation = true);
        REQUIRE_OK(stage_open(&s, scenes[i], "{\"width\": 80, \"height\": 60}", ALL_AOVS, &err));
        REQUIRE_OK(stage_render(&s, 4, &err));
        for (uint32_t shown = 0; shown < SHOWN_COUNT; shown++)
            check_shown(&s, shown);
        CHECK(!shown_names[SHOWN_COUNT], "as many names as pictures");
        stage_close(&s);
    }
}

// Prints what calls take on the device and in all; limits are for quiet machines.
static void print_cost(struct stage *s, const char *name, const struct display_call *call)
{
    struct err err = {0};
    double device[9], all[9];
    for (int i = -1; i < 9; i++) {
        uint64_t start = clock_ns();
        REQUIRE_OK(display_draw(&s->display, call, &err));
        if (i >= 0) {
            all[i] = 1e3 * clock_seconds_since(start);
            device[i] = s->display.ms;
        }
    }
    qsort(device, 9, sizeof *device, by_size);
    qsort(all, 9, sizeof *all, by_size);
    printf("  %-22s %5u x %4u: %6.2f ms on the device, %6.2f ms in all\n", name, call->width,
           call->height, device[4], all[4]);
}

TEST(cost)
{
    static const char *const films[] = {"{\"width\": 640, \"height\": 360}",
                                        "{\"width\": 1280, \"height\": 720}"};
    for (int f = 0; f < 2; f++) {
        struct stage s = {0};
        struct err err = {0};
        OPEN_GPU(&s.gpu, .validation = false);
        REQUIRE_OK(stage_open(&s, "scenes/cornell.json", films[f], AOV_DEPTH, &err));
        REQUIRE_OK(stage_render(&s, 1, &err));
        struct display_call call = whole(&s, SHOWN_RADIANCE);
        for (int tone = TONE_NONE; tone <= TONE_AGX; tone++) {
            call.tone = (enum tone_curve)tone;
            print_cost(&s, tone_names[tone], &call);
        }
        call.tone = TONE_NONE;
        call.split = 0.5;
        call.side_count = 2;
        print_cost(&s, "two sides", &call);
        call.side_count = 1;
        call.shown = SHOWN_DEPTH;
        print_cost(&s, "depth", &call);
        call.shown = SHOWN_RADIANCE;
        call.width = call.picture[2] = 1280;
        call.height = call.picture[3] = 720;
        call.nearest = true;
        print_cost(&s, "nearest", &call);
        call.nearest = false;
        call.width = call.picture[2] = 960;
        call.height = call.picture[3] = 540;
        print_cost(&s, "another size", &call);
        stage_close(&s);
    }
}

TEST_MAIN(TEST_CASE(every_curve), TEST_CASE(every_size), TEST_CASE(everything_shown),
          TEST_CASE(cost))
