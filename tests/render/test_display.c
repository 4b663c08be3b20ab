// Compares the display of a viewer, pixel by pixel, with a computation on the host.
#include "base/clock.h"
#include "display_reference.h"
#include "render/show/denoise.h"
#include <float.h>

#define ALL_AOVS (AOV_END - 1u)

struct test_random {
    uint64_t state;
};

// Knuth's generator (The Art of Computer Programming, volume 2, table 3.3.4-1, line 26).
static uint32_t random_below(struct test_random *random, uint32_t end)
{
    random->state = random->state * 6364136223846793005u + 1442695040888963407u;
    return (uint32_t)((random->state >> 33) % end);
}

static int by_size(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

// --- sizes and curves ----------------------------------------------------------------------------

TEST(every_curve)
{
    struct stage s = {0};
    struct err err = {0};
    OPEN_GPU(&s.gpu, .validation = true);
    REQUIRE_OK(stage_open(&s, "scenes/cornell.json", "{\"width\": 61, \"height\": 47}", 0, &err));
    REQUIRE_OK(stage_render(&s, 5, &err));
    const struct expected expected = {.sides = {values_of(&s.film, SHOWN_RADIANCE, &s.arena)}};
    for (int tone = TONE_NONE; tone <= TONE_AGX; tone++)
        for (int stops = -3; stops <= 6; stops += 3) {
            struct display_call call = call_of_film(&s, SHOWN_RADIANCE);
            call.tone = (enum tone_curve)tone;
            call.exposure_stops = (float)stops;
            check_picture(tone_names[tone], &s.display, &call, &expected, &s.arena);
        }
    stage_close(&s);
}

// Shows the film unscaled, smaller, larger, and smaller along one axis and larger along the other;
// within a larger picture; and with pixels as squares.
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
        struct display_call call = call_of_film(&s, SHOWN_RADIANCE);
        call.width = sizes[i].width;
        call.height = sizes[i].height;
        call.nearest = sizes[i].nearest;
        memcpy(call.picture, sizes[i].picture, sizeof call.picture);
        const struct expected expected = {
            .sides = {
                values_scaled(&film, call.picture[2], call.picture[3], call.nearest, &s.arena)}};
        snprintf(name, sizeof name, "size %zu", i);
        check_picture(name, &s.display, &call, &expected, &s.arena);
    }
    stage_close(&s);
}

// --- what is shown -------------------------------------------------------------------------------

// A range found from the picture must be that of the quantiles of its values, within bins of a
// sixteenth of an octave.
static void check_range(const struct display *display, uint32_t shown, const struct values *values)
{
    // The fractions of all values below the range, and below its end.
    static const double shares[SHOWN_COUNT][2] = {
        [SHOWN_DEPTH] = {0.01, 0.95},
        [SHOWN_SAMPLES] = {0, 1},
        [SHOWN_VARIANCE] = {0.01, 0.99},
        [SHOWN_STEPS] = {0, 0.995},
    };
    uint32_t count = values->width * values->height, known = 0;
    double *sorted = malloc(count * sizeof *sorted);
    for (uint32_t i = 0; i < count; i++) {
        const double *v = values->pixels[i].rgb;
        if (v[1] > 0 && (v[0] > 0 || !shown_is_logarithmic(shown)))
            sorted[known++] = v[0] / v[1];
    }
    qsort(sorted, known, sizeof *sorted, by_size);
    bool from_zero = shown == SHOWN_SAMPLES || shown == SHOWN_STEPS;
    double low = from_zero ? 0 : sorted[(uint32_t)(shares[shown][0] * (known - 1))];
    double high = sorted[(uint32_t)(shares[shown][1] * (known - 1))];
    CHECK(fabs(display->range[0] - low) <= 0.07 * low &&
              fabs(display->range[1] - high) <= 0.07 * high,
          "%s: range %g to %g, expected %g to %g", shown_names[shown], display->range[0],
          display->range[1], low, high);
    free(sorted);
}

static void check_shown(struct stage *s, uint32_t shown)
{
    struct display_call call = call_of_film(s, shown);
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
    expected.sides[0] = values_scaled(&film, call.picture[2], call.picture[3], false, &s->arena);
    snprintf(name, sizeof name, "%s, smaller", shown_names[shown]);
    check_picture(name, &s->display, &call, &expected, &s->arena);
}

TEST(everything_shown)
{
    static const char *const scenes[] = {"tests/render/scenes/aovs.json", "scenes/cornell.json",
                                         "scenes/teapots.json"};
    for (int i = 0; i < 3; i++) {
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

// If the first samples are one half and the last the other one, the size of each half depends on
// the planned number.
TEST(variance_of_contiguous_halves)
{
    static const struct scene_override overrides[] = {{"film", "{\"width\": 40, \"height\": 30}"},
                                                      {"settings.halves", "\"contiguous\""},
                                                      {"settings.spp", "8"},
                                                      {0}};
    struct stage s = {0};
    struct err err = {0};
    OPEN_GPU(&s.gpu, .validation = true);
    REQUIRE_OK(load_scene("scenes/cornell.json", overrides, &s.scene, &err));
    const struct renderer_params params = {.gpu = &s.gpu, .scene = &s.scene, .aovs = AOV_VARIANCE};
    REQUIRE_OK(renderer_create(&params, &s.renderer, &err));
    REQUIRE_OK(display_create(&s.gpu, &s.display, &err));
    for (int i = 0; i < 2; i++) {
        REQUIRE_OK(stage_render(&s, 3, &err));
        struct display_call call = call_of_film(&s, SHOWN_VARIANCE);
        call.range[0] = 1e-6;
        call.range[1] = 1;
        const struct expected expected = {.sides = {values_of(&s.film, call.shown, &s.arena)}};
        check_picture(i ? "six of eight" : "three of eight", &s.display, &call, &expected,
                      &s.arena);
    }
    stage_close(&s);
}

// --- sides, what was kept, parts -----------------------------------------------------------------

// Two films of different sizes are side by side, with the dividing line at several places,
// including its ends.
TEST(split)
{
    static const double splits[] = {0.5, 0, 1, 0.313, 1.0 / 61};
    static const struct scene_override small[] = {
        {"film", "{\"width\": 30, \"height\": 20}"}, {"settings.max_bounces", "1"}, {0}};
    struct stage s = {0};
    struct scene other;
    struct renderer right;
    struct film_image film;
    struct err err = {0};
    const struct render_call once = {.samples = 1};
    OPEN_GPU(&s.gpu, .validation = true);
    REQUIRE_OK(stage_open(&s, "scenes/cornell.json", "{\"width\": 61, \"height\": 47}",
                          AOV_IDS | AOV_DEPTH | AOV_ALPHA, &err));
    REQUIRE_OK(stage_render(&s, 3, &err));
    REQUIRE_OK(load_scene("scenes/shapes.json", small, &other, &err));
    const struct renderer_params params = {
        .gpu = &s.gpu, .scene = &other, .aovs = AOV_IDS | AOV_DEPTH | AOV_ALPHA};
    REQUIRE_OK(renderer_create(&params, &right, &err));
    REQUIRE_OK(renderer_render(&right, &once, &err));
    REQUIRE_OK(renderer_read(&right, &s.arena, &film, &err));
    static const uint32_t shown[] = {SHOWN_RADIANCE, SHOWN_OBJECTS, SHOWN_DEPTH};
    for (int i = 0; i < 3; i++) {
        const struct values left_values = values_of(&s.film, shown[i], &s.arena);
        const struct values right_values = values_of(&film, shown[i], &s.arena);
        const struct expected expected = {
            .sides = {left_values, values_scaled(&right_values, 61, 47, false, &s.arena)}};
        for (size_t k = 0; k < sizeof splits / sizeof splits[0]; k++) {
            char name[64];
            struct display_call call = call_of_film(&s, shown[i]);
            call.sides[1].renderer = &right;
            call.side_count = 2;
            call.split = splits[k];
            call.width += 9;
            call.picture[0] = 4;
            snprintf(name, sizeof name, "split %s %g", shown_names[shown[i]], splits[k]);
            check_picture(name, &s.display, &call, &expected, &s.arena);
        }
    }
    renderer_finish(&right);
    scene_finish(&other);
    stage_close(&s);
}

// Combines the film with the kept image, as the kernels do: the latter is visible as far as the
// film has no samples.
static struct values over(const struct values *film, const struct values *kept, struct arena *arena)
{
    struct values out = values_new(film->width, film->height, arena);
    for (uint32_t i = 0; i < film->width * film->height; i++) {
        const struct value *v = &film->pixels[i], *k = &kept->pixels[i];
        for (int c = 0; c < 3; c++)
            out.pixels[i].rgb[c] = v->rgb[c] + (1 - v->weight) * k->rgb[c];
        out.pixels[i].weight = v->weight + (1 - v->weight) * k->weight;
    }
    return out;
}

static bool stop_at_once(void *context)
{
    (void)context;
    return true;
}

// Renders samples of some pixels only.
static bool render_some(struct stage *s, struct err *err)
{
    static const struct progress stops = {.should_stop = stop_at_once};
    bool stopped = false;
    const struct render_call call = {.samples = 1, .stopped = &stopped};
    s->renderer.progress = &stops;
    bool ok = renderer_render(&s->renderer, &call, err) &&
              renderer_read(&s->renderer, &s->arena, &s->film, err);
    s->renderer.progress = NULL;
    CHECK(stopped && s->film.least_samples == 0 && s->film.most_samples == 1, "half of the film");
    return ok;
}

TEST(kept)
{
    struct stage s = {0};
    struct err err = {0};
    OPEN_GPU(&s.gpu, .validation = true);
    REQUIRE_OK(stage_open(&s, "scenes/cornell.json", "{\"width\": 64, \"height\": 48}", 0, &err));
    REQUIRE_OK(renderer_resize(&s.renderer, 1024, 64, &err));
    struct display_call call = call_of_film(&s, SHOWN_RADIANCE);
    call.use_kept = true;

    // First without a film, then with one.
    REQUIRE_OK(stage_render(&s, 2, &err));
    const struct values first = values_of(&s.film, SHOWN_RADIANCE, &s.arena);
    struct expected expected = {.sides = {first}};
    check_picture("nothing kept", &s.display, &call, &expected, &s.arena);
    REQUIRE_OK(display_keep(&s.display, &call, &err));

    // An empty film, with and without a kept image.
    REQUIRE_OK(renderer_restart(&s.renderer, 1, &err));
    check_picture("kept", &s.display, &call, &expected, &s.arena);
    call.use_kept = false;
    const struct values nothing = values_new(64, 48, &s.arena);
    expected.sides[0] = nothing;
    check_picture("not used", &s.display, &call, &expected, &s.arena);
    call.use_kept = true;

    // A film with samples in half of its pixels.
    REQUIRE_OK(render_some(&s, &err));
    const struct values half = values_of(&s.film, SHOWN_RADIANCE, &s.arena);
    expected.sides[0] = over(&half, &first, &s.arena);
    check_picture("half kept", &s.display, &call, &expected, &s.arena);

    // Changes the size, keeps the picture at that size, and shows it at the first size.
    call.width = call.picture[2] = 100;
    call.height = call.picture[3] = 30;
    const struct values half_sized = values_scaled(&half, 100, 30, false, &s.arena);
    const struct values first_sized = values_scaled(&first, 100, 30, false, &s.arena);
    const struct values both = over(&half_sized, &first_sized, &s.arena);
    expected.sides[0] = both;
    check_picture("half kept, another size", &s.display, &call, &expected, &s.arena);
    REQUIRE_OK(display_keep(&s.display, &call, &err));
    REQUIRE_OK(renderer_restart(&s.renderer, 2, &err));
    check_picture("kept twice", &s.display, &call, &expected, &s.arena);
    call = call_of_film(&s, SHOWN_RADIANCE);
    call.use_kept = true;
    expected.sides[0] = values_scaled(&both, 64, 48, false, &s.arena);
    check_picture("kept twice, the first size", &s.display, &call, &expected, &s.arena);

    // A kept picture is not shown for another AOV, nor after it was discarded.
    expected.sides[0] = nothing;
    call.shown = SHOWN_SAMPLES;
    check_picture("of something else", &s.display, &call, &expected, &s.arena);
    call.shown = SHOWN_RADIANCE;
    display_forget(&s.display);
    check_picture("forgotten", &s.display, &call, &expected, &s.arena);
    stage_close(&s);
}

struct parts {
    struct gpu_limit_overrides limits;
    const char *film;
};

static void show_parts(const struct parts *parts)
{
    static const uint32_t sizes[][2] = {{64, 50}, {61, 47}, {20, 30}, {30, 90}, {63, 64}};
    struct stage s = {0};
    struct err err = {0};
    OPEN_GPU(&s.gpu, .validation = true, .limits = parts->limits);
    REQUIRE_OK(stage_open(&s, "scenes/cornell.json", parts->film, AOV_DEPTH | AOV_ALPHA, &err));
    REQUIRE_OK(stage_render(&s, 2, &err));
    CHECK((s.renderer.plan.film_chunks > 1) == (parts->limits.storage_range > 0), "%u buffers",
          s.renderer.plan.film_chunks);
    for (uint32_t shown = SHOWN_RADIANCE; shown <= SHOWN_DEPTH; shown += SHOWN_DEPTH) {
        const struct values film = values_of(&s.film, shown, &s.arena);
        for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
            struct display_call call = call_of_film(&s, shown);
            call.width = call.picture[2] = sizes[i][0];
            call.height = call.picture[3] = sizes[i][1];
            const struct expected expected = {
                .sides = {values_scaled(&film, sizes[i][0], sizes[i][1], false, &s.arena)}};
            check_picture("parts", &s.display, &call, &expected, &s.arena);
        }
    }
    stage_close(&s);
}

// Films in several buffers, drawing in several submissions, and linear pictures without texel
// buffers must all give the same pixels.
TEST(parts)
{
    static const struct parts parts[] = {
        {{.storage_range = 1u << 16}, "{\"width\": 61, \"height\": 47}"},
        {{.storage_range = 100000, .no_texel = true}, "{\"width\": 160, \"height\": 120}"},
        {{.texel_elements = 4096}, "{\"width\": 61, \"height\": 47}"},
        // A workgroup takes 3 ms, and the device is lost after 250 ms, so drawing takes several
        // submissions.
        {{.group_ns = 3000000, .watchdog_ms = 250}, "{\"width\": 160, \"height\": 120}"},
    };
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++)
        show_parts(&parts[i]);
}

// Shows the denoiser's picture in place of the film's and, where it has none, the kept image.
TEST(denoised)
{
    struct stage s = {0};
    struct denoiser denoiser = {.width = 61, .height = 47};
    struct err err = {0};
    OPEN_GPU(&s.gpu, .validation = true);
    REQUIRE_OK(stage_open(&s, "scenes/cornell.json", "{\"width\": 61, \"height\": 47}", 0, &err));
    REQUIRE_OK(stage_render(&s, 1, &err));
    struct values picture = values_new(61, 47, &s.arena);
    float(*pixels)[4] = arena_alloc(&s.arena, 61 * 47, sizeof *pixels);
    for (uint32_t i = 0; i < 61 * 47; i++) {
        bool known = i % 61 > 20;
        pixels[i][0] = pixels[i][1] = pixels[i][2] = (float)(i % 97) / 97.0f;
        pixels[i][3] = known ? 1.0f : 0.0f;
        set_value(&picture.pixels[i], known ? pixels[i] : (const float[3]){0});
        picture.pixels[i].weight = known;
    }
    REQUIRE_OK(gpu_buffer_create(&s.gpu, "denoised", 61 * 47 * 16, GPU_DEVICE, false,
                                 &denoiser.picture, &err));
    REQUIRE_OK(gpu_upload(&s.gpu, &denoiser.picture, 0, pixels, 61 * 47 * 16, &err));
    struct display_call call = call_of_film(&s, SHOWN_RADIANCE);
    const struct values film = values_of(&s.film, SHOWN_RADIANCE, &s.arena);
    REQUIRE_OK(display_keep(&s.display, &call, &err));
    call.sides[0].denoiser = &denoiser;
    struct expected expected = {.sides = {picture}};
    check_picture("denoised", &s.display, &call, &expected, &s.arena);
    call.use_kept = true;
    expected.sides[0] = over(&picture, &film, &s.arena);
    check_picture("denoised and kept", &s.display, &call, &expected, &s.arena);
    call.side_count = 2;
    call.split = 0.7;
    expected.sides[1] = film;
    check_picture("denoised beside the film", &s.display, &call, &expected, &s.arena);
    denoiser.width--;
    CHECK(!display_draw(&s.display, &call, &err) && strstr(err.msg, "60 x 47"), "%s", err.msg);
    gpu_buffer_finish(&s.gpu, &denoiser.picture);
    stage_close(&s);
}

// A window and a PNG file show the same pixels. Codes may differ by one of 255 if a value is
// between two codes.
TEST(png)
{
    struct stage s = {0};
    struct err err = {0};
    OPEN_GPU(&s.gpu, .validation = false);
    REQUIRE_OK(stage_open(&s, "scenes/spheres.json", "{\"width\": 96, \"height\": 54}", 0, &err));
    REQUIRE_OK(stage_render(&s, 4, &err));
    for (int tone = TONE_NONE; tone <= TONE_AGX; tone++) {
        struct display_call call = call_of_film(&s, SHOWN_RADIANCE);
        const struct image picture = {96, 54, s.film.mean};
        struct image read;
        uint8_t *data;
        size_t size;
        const struct image_write_params write = {
            .path = "a.png",
            .image = &picture,
            .exposure_stops = call.exposure_stops = 0.7f,
            .tone = call.tone = (enum tone_curve)tone,
        };
        REQUIRE_OK(image_encode(&write, &s.arena, &data, &size, &err));
        const struct image_read_params as_it_is = {.path = "a.png", .is_linear = true};
        REQUIRE_OK(image_decode(data, size, &as_it_is, &s.arena, &read, &err));
        REQUIRE_OK(display_draw(&s.display, &call, &err));
        uint8_t(*pixels)[4] = display_pixels(&s.display, &call, &s.arena);
        uint32_t differing = 0, worst = 0;
        for (uint32_t i = 0; i < 96 * 54 * 3; i++) {
            int code = (int)lrintf(read.pixels[i / 3][i % 3] * 255);
            uint32_t apart = (uint32_t)abs(code - pixels[i / 3][i % 3]);
            differing += apart > 0;
            worst = apart > worst ? apart : worst;
        }
        printf("  %s: %u of %u codes differ\n", tone_names[tone], differing, 96 * 54 * 3);
        CHECK(worst <= 1 && differing < 96 * 54 * 3 / 100, "%s: %u differ, by up to %u",
              tone_names[tone], differing, worst);
    }
    stage_close(&s);
}

// Writes values into the film that films seldom have.
TEST(extreme_values)
{
    static const float values[] = {0,       -1,    1e-45f,  1e-38f,   1e-7f, 3e-4f,    0.0031308f,
                                   0.0032f, 0.18f, 1,       7.2f,     7.3f,  65536.0f, 1e19f,
                                   1e30f,   3e38f, FLT_MAX, INFINITY, NAN,   -INFINITY};
    enum { VALUES = sizeof values / sizeof values[0] };
    static const float stops[] = {0, 5, -20, 100, -100};
    struct stage s = {0};
    struct err err = {0};
    struct gpu_film_pixel pixels[VALUES * VALUES] = {0};
    OPEN_GPU(&s.gpu, .validation = false);
    REQUIRE_OK(stage_open(&s, "scenes/cornell.json", "{\"width\": 20, \"height\": 20}", 0, &err));
    const struct values expected = values_new(VALUES, VALUES, &s.arena);
    for (uint32_t i = 0; i < VALUES * VALUES; i++) {
        const float rgb[3] = {values[i % VALUES], values[i / VALUES], values[(i + 3) % VALUES]};
        pixels[i].samples = 1;
        pixels[i].digits_a = FILM_HAS_FLOATS;
        for (int c = 0; c < 3; c++)
            memcpy(&pixels[i].sums_a[4 * c], &rgb[c], sizeof rgb[c]);
        set_value(&expected.pixels[i], rgb);
        expected.pixels[i].weight = 1;
    }
    REQUIRE_OK(gpu_upload(&s.gpu, &s.renderer.film[0], 0, pixels, sizeof pixels, &err));
    const struct expected picture = {.sides = {expected}};
    for (int tone = TONE_NONE; tone <= TONE_AGX; tone++)
        for (size_t k = 0; k < sizeof stops / sizeof stops[0]; k++) {
            struct display_call call = call_of_film(&s, SHOWN_RADIANCE);
            call.tone = (enum tone_curve)tone;
            call.exposure_stops = stops[k];
            check_picture(tone_names[tone], &s.display, &call, &picture, &s.arena);
        }
    stage_close(&s);
}

// The window's size changes often: the memory must not exceed that of the largest picture, and
// decrease again.
TEST(changing_sizes)
{
    struct stage s = {0};
    struct err err = {0};
    struct test_random random = {5};
    OPEN_GPU(&s.gpu, .validation = true);
    REQUIRE_OK(
        stage_open(&s, "scenes/cornell.json", "{\"width\": 64, \"height\": 48}", ALL_AOVS, &err));
    REQUIRE_OK(stage_render(&s, 1, &err));
    uint64_t before = s.gpu.allocated_bytes;
    for (uint32_t i = 0; i < 100; i++) {
        struct display_call call = call_of_film(&s, i % SHOWN_COUNT);
        call.picture[2] = 1 + random_below(&random, 200);
        call.picture[3] = 1 + random_below(&random, 150);
        call.picture[0] = random_below(&random, 9);
        call.width = call.picture[0] + call.picture[2] + random_below(&random, 9);
        call.height = call.picture[3];
        call.side_count = random_below(&random, 3);
        call.split = random_below(&random, 101) / 100.0;
        call.nearest = i & 1;
        call.use_kept = i & 2;
        REQUIRE_OK(display_draw(&s.display, &call, &err));
        if (i % 3 == 0)
            REQUIRE_OK(display_keep(&s.display, &call, &err));
    }
    // Each side has five linear pictures of 200 x 150, filter taps, and the pixels; a quarter is
    // added as a margin.
    uint64_t most = (2 * (5 * 200 * 150 * 16 + 4 * 350 * 16) + 4 * 218 * 150) / 4 * 5 + (1u << 16);
    CHECK(s.gpu.allocated_bytes - before < most, "%llu bytes",
          (unsigned long long)(s.gpu.allocated_bytes - before));
    stage_close(&s);
}

TEST(what_cannot_be_shown)
{
    struct stage s = {0};
    struct err err = {0};
    OPEN_GPU(&s.gpu, .validation = true);
    REQUIRE_OK(stage_open(&s, "scenes/cornell.json", "{\"width\": 16, \"height\": 16}", 0, &err));
    struct display_call call = call_of_film(&s, SHOWN_STEPS);
    CHECK(!display_draw(&s.display, &call, &err) && strstr(err.msg, "steps"), "%s", err.msg);
    call = call_of_film(&s, SHOWN_RADIANCE);
    call.picture[0] = 1;
    CHECK(!display_draw(&s.display, &call, &err) && strstr(err.msg, "inside"), "%s", err.msg);
    call = call_of_film(&s, SHOWN_COUNT);
    CHECK(!display_draw(&s.display, &call, &err) && strstr(err.msg, "12"), "%s", err.msg);
    call = call_of_film(&s, SHOWN_RADIANCE);
    call.width = 0;
    CHECK(!display_draw(&s.display, &call, &err) && strstr(err.msg, "0 x 16"), "%s", err.msg);
    // Drawing works afterwards, and shows nothing if there is no side.
    call = call_of_film(&s, SHOWN_RADIANCE);
    call.side_count = 0;
    REQUIRE_OK(display_draw(&s.display, &call, &err));
    const uint8_t *pixels = (const uint8_t *)display_pixels(&s.display, &call, &s.arena);
    for (int i = 0; i < 16 * 16 * 4; i++)
        CHECK(pixels[i] == (i % 4 == 3 ? 255 : 0), "byte %d: %u", i, pixels[i]);
    stage_close(&s);
}

// Prints the cost of calls on the device and in total. The limits are for machines without other
// load.
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
        struct display_call call = call_of_film(&s, SHOWN_RADIANCE);
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
          TEST_CASE(variance_of_contiguous_halves), TEST_CASE(split), TEST_CASE(kept),
          TEST_CASE(parts), TEST_CASE(denoised), TEST_CASE(png), TEST_CASE(extreme_values),
          TEST_CASE(changing_sizes), TEST_CASE(what_cannot_be_shown), TEST_CASE(cost))
