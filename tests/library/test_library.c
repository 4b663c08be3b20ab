// Tests the library only through its public header.
#define _GNU_SOURCE // newlocale
#include "library_fixture.h"

#include <locale.h>
#include <pthread.h>
#include <stdint.h>

// --- bits ----------------------------------------------------------------------------------------

struct bits_case {
    const char *scene, *settings, *arguments;
};

static void check_bits(struct lampyris_context *context, const struct bits_case *wanted)
{
    char arguments[1024];
    struct lampyris_scene *scene;
    struct lampyris_render *render;
    snprintf(arguments, sizeof arguments, "%s %s", path_of(wanted->scene), wanted->arguments);
    OK(context, lampyris_scene_load(context, path_of(wanted->scene), NULL, &scene));
    OK(context, lampyris_render_begin(scene, wanted->settings, NULL, &render));
    OK(context, lampyris_render_step(render, NULL, NULL));
    uint64_t hash = state_of(render).hash, expected = hash_of_program(arguments);
    CHECK(hash == expected, "%s %s: %016llx, by the program %016llx", wanted->scene,
          wanted->settings, (unsigned long long)hash, (unsigned long long)expected);
    // The command that the library returns renders the same picture.
    const char *repeat;
    OK(context, lampyris_render_repeat(render, &repeat));
    if (*repeat) {
        REQUIRE(strncmp(repeat, "lampyris render ", 16) == 0, "%s", repeat);
        CHECK(hash_of_program(repeat + 16) == hash, "%s", repeat);
    }
    lampyris_render_release(render);
    lampyris_scene_release(scene);
}

TEST(pictures_have_the_bits_of_the_program)
{
    static const struct bits_case cases[] = {
        {"scenes/cornell.json", SMALL, "--size 32x24 --spp 8"},
        {"scenes/glass.json", "{\"width\": 16, \"height\": 16, \"spp\": 5, \"seed\": 7}",
         "--size 16x16 --spp 5 --seed 7"},
        {"scenes/cornell.json",
         "{\"width\": 16, \"height\": 16, \"sampler\": \"blue-noise\", \"spp\": 4, \"mis\": "
         "\"none\"}",
         "--size 16x16 --sampler blue-noise --spp 4 --mis none"},
        {"scenes/cornell.json", "{\"width\": 24, \"height\": 24, \"error\": 0.05}",
         "--size 24x24 --error 0.05"},
        {"scenes/cornell.json", "{\"width\": 48, \"height\": 48, \"spp\": 64, \"adaptive\": true}",
         "--size 48x48 --spp 64 --adaptive on"},
        {"scenes/models/vase.glb",
         "{\"width\": 16, \"height\": 24, \"spp\": 2, \"aov\": [\"depth\"]}",
         "--size 16x24 --spp 2 --aov depth"},
    };
    struct lampyris_context *context = open_context();
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        check_bits(context, &cases[i]);
    lampyris_context_release(context);
}

TEST(steps_renders_and_checkpoints_change_no_bit)
{
    struct lampyris_context *context = open_context();
    struct lampyris_scene *scene;
    struct lampyris_render *whole, *parts, *resumed;
    OK(context, lampyris_scene_load(context, path_of("scenes/cornell.json"), NULL, &scene));
    OK(context, lampyris_render_begin(scene, SMALL, NULL, &whole));
    OK(context, lampyris_render_begin(scene, SMALL, NULL, &parts));
    struct lampyris_goal goal = {.size = sizeof goal, .samples = 3};
    OK(context, lampyris_render_step(parts, &goal, NULL));
    CHECK(state_of(parts).samples == 3 && strcmp(state_of(parts).ended_by, "spp") == 0);
    OK(context, lampyris_render_step(whole, NULL, NULL));
    OK(context, lampyris_render_checkpoint(parts, "library.ck"));
    goal.samples = 5;
    OK(context, lampyris_render_step(parts, &goal, NULL));
    OK(context, lampyris_render_step(parts, NULL, NULL));
    OK(context,
       lampyris_render_begin(
           scene, "{\"width\": 32, \"height\": 24, \"spp\": 8, \"resume\": \"library.ck\"}", NULL,
           &resumed));
    CHECK(state_of(resumed).samples == 3);
    OK(context, lampyris_render_step(resumed, NULL, NULL));
    uint64_t hash = state_of(whole).hash;
    CHECK(state_of(parts).hash == hash && state_of(resumed).hash == hash);
    CHECK(state_of(parts).samples == 8 && state_of(parts).samples_total == 8 * 32 * 24);
    remove("library.ck");
    lampyris_scene_release(scene); // a scene that is being rendered stays alive
    goal.samples = 10;
    OK(context, lampyris_render_step(whole, &goal, NULL));
    CHECK(state_of(whole).hash != hash && state_of(whole).samples == 10);
    lampyris_context_release(context);
    lampyris_render_release(whole);
    lampyris_render_release(parts);
    lampyris_render_release(resumed);
}

TEST(goals_of_error_and_time_end_a_step)
{
    struct lampyris_context *context = open_context();
    struct lampyris_scene *scene;
    struct lampyris_render *render;
    OK(context, lampyris_scene_load(context, path_of("scenes/cornell.json"), NULL, &scene));
    OK(context, lampyris_render_begin(scene, SMALL, NULL, &render));
    const struct lampyris_goal error = {.size = sizeof error, .error = 0.05};
    OK(context, lampyris_render_step(render, &error, NULL));
    struct lampyris_state state = state_of(render);
    CHECK(strcmp(state.ended_by, "error") == 0, "%s", state.ended_by);
    CHECK(state.error < 0.05 && state.error_low < state.error && state.error < state.error_high);
    CHECK(state.error_at_most < 0.05 && !*state.error_why, "%s", state.error_why);
    const struct lampyris_goal time = {.size = sizeof time, .seconds = state.seconds_render + 0.05};
    OK(context, lampyris_render_step(render, &time, NULL));
    CHECK(strcmp(state_of(render).ended_by, "time") == 0, "%s", state_of(render).ended_by);
    CHECK(state_of(render).samples > state.samples);
    CHECK(state_of(render).rays_closest > state.rays_closest && state.rays_shadow > 0);
    const struct lampyris_goal bad = {.size = sizeof bad, .error = -1};
    CHECK(lampyris_render_step(render, &bad, NULL) == LAMPYRIS_INPUT);
    CHECK(strstr(error_of(context).message, "the error -1"), "%s", error_of(context).message);
    lampyris_render_release(render);
    lampyris_scene_release(scene);
    lampyris_context_release(context);
}

TEST(what_is_not_known_is_said)
{
    struct lampyris_context *context = open_context();
    struct lampyris_scene *scene;
    struct lampyris_render *render;
    OK(context, lampyris_scene_load(context, path_of("scenes/cornell.json"), NULL, &scene));
    OK(context, lampyris_render_begin(scene, SMALL, NULL, &render));
    struct lampyris_state state = state_of(render); // before the first sample
    CHECK(state.samples == 0 && state.pixels_without_samples == 32 * 24 && !*state.ended_by);
    CHECK(isnan(state.error) && *state.error_why);
    const struct lampyris_goal one = {.size = sizeof one, .samples = 1};
    OK(context, lampyris_render_step(render, &one, NULL));
    state = state_of(render);
    CHECK(state.samples == 1 && isnan(state.error) && *state.error_why, "%s", state.error_why);
    CHECK(state.width == 32 && state.height == 24 && state.seconds_render > 0);
    lampyris_render_release(render);
    lampyris_scene_release(scene);
    lampyris_context_release(context);
}

// The simulated device is lost at its first dispatch, because each workgroup takes longer than the
// watchdog permits.
TEST(a_device_that_is_lost_is_an_error_and_opened_again)
{
    struct lampyris_context *context;
    struct lampyris_scene *scene;
    struct lampyris_render *render;
    struct lampyris_state state = {.size = sizeof state};
    REQUIRE(lampyris_context_create(NULL, &context) == LAMPYRIS_OK);
    OK(context, lampyris_scene_load(context, path_of("scenes/cornell.json"), NULL, &scene));
    setenv("LAMPYRIS_LIMITS", "group-ns=100000,watchdog-ms=1", 1);
    OK(context, lampyris_render_begin(scene, SMALL, NULL, &render));
    unsetenv("LAMPYRIS_LIMITS");
    CHECK(lampyris_render_step(render, NULL, NULL) == LAMPYRIS_DEVICE);
    CHECK(strstr(error_of(context).message, "device lost"), "%s", error_of(context).message);
    CHECK(lampyris_render_step(render, NULL, NULL) == LAMPYRIS_DEVICE);
    CHECK(strstr(error_of(context).message, "begin another render"), "%s",
          error_of(context).message);
    CHECK(lampyris_render_state(render, &state) == LAMPYRIS_DEVICE);
    CHECK(lampyris_render_checkpoint(render, "never.ck") == LAMPYRIS_DEVICE);
    lampyris_render_release(render);
    uint64_t again = render_hash(context, scene);
    lampyris_context_release(context);
    lampyris_scene_release(scene);
    context = open_context();
    OK(context, lampyris_scene_load(context, path_of("scenes/cornell.json"), NULL, &scene));
    CHECK(again != 0 && again == render_hash(context, scene));
    lampyris_scene_release(scene);
    lampyris_context_release(context);
}

// --- callbacks -----------------------------------------------------------------------------------

struct watcher {
    struct lampyris_context *context;
    int calls, stop_at;
    uint64_t samples;
    bool was_refused;
    char phases[400];
};

static bool watch(void *user, const struct lampyris_moment *moment)
{
    struct watcher *watcher = user;
    uint32_t count;
    watcher->calls++;
    watcher->samples = moment->samples;
    if (!strstr(watcher->phases, moment->phase) &&
        strlen(watcher->phases) + strlen(moment->phase) < sizeof watcher->phases)
        strcat(watcher->phases, moment->phase);
    watcher->was_refused |=
        lampyris_device_count(watcher->context, &count) == LAMPYRIS_INPUT && count == 0;
    return watcher->calls != watcher->stop_at;
}

TEST(callbacks_hear_of_it_and_stop_it)
{
    struct lampyris_context *context = open_context();
    struct lampyris_scene *scene;
    struct lampyris_render *render = NULL;
    struct watcher watcher = {.context = context};
    const struct lampyris_progress progress = {sizeof progress, watch, &watcher};
    static const char settings[] = "{\"width\": 64, \"height\": 64, \"spp\": 4096}";
    OK(context, lampyris_scene_load(context, path_of("scenes/cornell.json"), NULL, &scene));
    watcher.stop_at = 3;
    enum lampyris_status status = lampyris_render_begin(scene, settings, &progress, &render);
    CHECK(status == LAMPYRIS_STOPPED && !render, "%d: %s", status, error_of(context).message);
    watcher.stop_at = 0;
    OK(context, lampyris_render_begin(scene, settings, &progress, &render));
    CHECK(strstr(watcher.phases, "Loading") && strstr(watcher.phases, "Building BVH"), "%s",
          watcher.phases);
    watcher.calls = 0;
    watcher.stop_at = 3;
    status = lampyris_render_step(render, NULL, &progress);
    CHECK(status == LAMPYRIS_STOPPED && error_of(context).status == LAMPYRIS_STOPPED);
    CHECK(watcher.calls == 3, "%d calls after the one that stopped it", watcher.calls - 3);
    CHECK(watcher.was_refused, "a callback used its own context");
    struct lampyris_state state = state_of(render);
    CHECK(strcmp(state.ended_by, "signal") == 0 && state.samples_total > 0);
    CHECK(state.samples < 4096, "%llu", (unsigned long long)state.samples);
    // The render continues to the same bits as with a single step; the interrupted pass is
    // completed in any case.
    struct lampyris_render *whole;
    struct lampyris_goal goal = {.size = sizeof goal, .samples = state.samples + 7};
    OK(context, lampyris_render_step(render, &goal, NULL));
    state = state_of(render);
    CHECK(state.samples >= goal.samples && state.pixels_without_samples == 0);
    goal.samples = state.samples;
    OK(context, lampyris_render_begin(scene, settings, NULL, &whole));
    OK(context, lampyris_render_step(whole, &goal, NULL));
    CHECK(state_of(whole).samples == state.samples && state_of(whole).hash == state.hash);
    lampyris_render_release(whole);
    lampyris_render_release(render);
    lampyris_scene_release(scene);
    lampyris_context_release(context);
}

TEST(a_log_has_the_messages_of_its_context)
{
    struct told told[2] = {0};
    struct lampyris_context *contexts[2];
    struct lampyris_scene *scene;
    for (int i = 0; i < 2; i++) {
        const struct lampyris_context_params params = {
            .size = sizeof params, .log = tell, .user = &told[i], .log_level = LAMPYRIS_LOG_NOTE};
        REQUIRE(lampyris_context_create(&params, &contexts[i]) == LAMPYRIS_OK);
    }
    OK(contexts[0],
       lampyris_scene_load(contexts[0], path_of("scenes/models/knot.ply"), NULL, &scene));
    OK(contexts[0], lampyris_scene_check(scene, NULL));
    CHECK(told[0].count > 0 && told[1].count == 0, "%d and %d", told[0].count, told[1].count);
    CHECK(strchr(told[0].last, '\n') == NULL && *told[0].last);
    lampyris_scene_release(scene);
    lampyris_context_release(contexts[0]);
    lampyris_context_release(contexts[1]);
}

struct nested {
    struct lampyris_context *other;
    int count;
};

static void load_in_another(void *user, enum lampyris_log_level level, const char *message)
{
    struct nested *nested = user;
    struct lampyris_scene *scene;
    (void)level, (void)message;
    if (nested->count++ > 0)
        return;
    CHECK(lampyris_scene_load(nested->other, path_of("scenes/models/knot.ply"), NULL, &scene) ==
          LAMPYRIS_OK);
    CHECK(lampyris_scene_check(scene, NULL) == LAMPYRIS_OK);
    lampyris_scene_release(scene);
}

TEST(callbacks_may_use_another_context)
{
    struct told told = {0};
    struct nested nested = {0};
    struct lampyris_context *context;
    struct lampyris_scene *scene;
    const struct lampyris_context_params inner = {
        .size = sizeof inner, .log = tell, .user = &told, .log_level = LAMPYRIS_LOG_NOTE};
    const struct lampyris_context_params outer = {.size = sizeof outer,
                                                  .log = load_in_another,
                                                  .user = &nested,
                                                  .log_level = LAMPYRIS_LOG_NOTE};
    REQUIRE(lampyris_context_create(&inner, &nested.other) == LAMPYRIS_OK);
    REQUIRE(lampyris_context_create(&outer, &context) == LAMPYRIS_OK);
    OK(context, lampyris_scene_load(context, path_of("scenes/models/knot.ply"), NULL, &scene));
    OK(context, lampyris_scene_check(scene, NULL));
    CHECK(nested.count > 0 && told.count > 0, "%d and %d", nested.count, told.count);
    lampyris_scene_release(scene);
    lampyris_context_release(context);
    lampyris_context_release(nested.other);
}

// --- threads -------------------------------------------------------------------------------------

struct worker {
    pthread_t thread;
    struct told told;
    const char *path;
    uint64_t hashes[4];
    char failure[400];
};

static void *work(void *argument)
{
    struct worker *worker = argument;
    const struct lampyris_context_params params = {.size = sizeof params,
                                                   .log = tell,
                                                   .user = &worker->told,
                                                   .log_level = LAMPYRIS_LOG_WARNING,
                                                   .validation = true};
    for (int i = 0; i < 4; i++) {
        struct lampyris_context *context;
        struct lampyris_scene *scene = NULL;
        struct lampyris_render *render = NULL;
        struct lampyris_state state = {.size = sizeof state};
        if (lampyris_context_create(&params, &context) ||
            lampyris_scene_load(context, worker->path, NULL, &scene) ||
            lampyris_render_begin(scene, SMALL, NULL, &render) ||
            lampyris_render_step(render, NULL, NULL) || lampyris_render_state(render, &state))
            snprintf(worker->failure, sizeof worker->failure, "%s", error_of(context).message);
        worker->hashes[i] = state.hash;
        lampyris_render_release(render);
        lampyris_scene_release(scene);
        lampyris_context_release(context);
    }
    return NULL;
}

TEST(threads_with_contexts_of_their_own_do_not_meet)
{
    struct worker workers[2] = {0};
    struct lampyris_context *context = open_context();
    uint32_t count;
    OK(context, lampyris_device_count(context, &count));
    lampyris_context_release(context);
    for (int i = 0; i < 2; i++) {
        workers[i].path = path_of("scenes/cornell.json");
        REQUIRE(pthread_create(&workers[i].thread, NULL, work, &workers[i]) == 0);
    }
    for (int i = 0; i < 2; i++)
        pthread_join(workers[i].thread, NULL);
    for (int i = 0; i < 2; i++) {
        CHECK(!*workers[i].failure, "%s", workers[i].failure);
        CHECK(workers[i].told.count == 0, "%s", workers[i].told.last);
        for (int k = 0; k < 4; k++)
            CHECK(workers[i].hashes[k] == workers[0].hashes[0] && workers[i].hashes[k] != 0);
    }
}

// Each call restores the caller's locale.
TEST(the_locale_of_the_caller_stays)
{
    static const char *const names[] = {"de_DE.UTF-8", "fr_FR.UTF-8", "C.UTF-8"};
    locale_t locale = (locale_t)0;
    for (size_t i = 0; !locale && i < sizeof names / sizeof *names; i++)
        locale = newlocale(LC_ALL_MASK, names[i], (locale_t)0);
    REQUIRE(locale, "there is no locale but C");
    struct lampyris_context *context = open_context();
    struct lampyris_scene *scene;
    char *json;
    locale_t former = uselocale(locale);
    OK(context, lampyris_scene_parse(context, "{\"lampyris\": 1, \"settings\": {\"clamp\": 0.5}}",
                                     NULL, NULL, &scene));
    OK(context, lampyris_scene_get(scene, "/settings/clamp", &json));
    CHECK(strcmp(json, "0.5") == 0, "%s", json);
    CHECK(lampyris_scene_check(scene, NULL) == LAMPYRIS_INPUT); // the scene is empty
    CHECK(uselocale((locale_t)0) == locale, "another locale is in use");
    lampyris_text_release(json);
    lampyris_scene_release(scene);
    lampyris_context_release(context);
    uselocale(former);
    freelocale(locale);
}

// Structs of callers that were compiled with an earlier or a later header.
TEST(sizes_of_structs_are_respected)
{
    struct lampyris_context *context;
    struct {
        struct lampyris_context_params known;
        char later[16];
    } params = {.known.size = sizeof params};
    REQUIRE(lampyris_context_create(&params.known, &context) == LAMPYRIS_OK);
    lampyris_context_release(context);
    params.later[3] = 1;
    CHECK(lampyris_context_create(&params.known, &context) == LAMPYRIS_INPUT && !context);
    params.known.size = 1;
    CHECK(lampyris_context_create(&params.known, &context) == LAMPYRIS_INPUT);
    context = open_context();
    struct lampyris_error error = {.size = offsetof(struct lampyris_error, file), .file = "mine"};
    CHECK(lampyris_scene_load(context, "none.json", NULL, &(struct lampyris_scene *){NULL}) ==
          LAMPYRIS_INPUT);
    lampyris_context_error(context, &error);
    CHECK(error.status == LAMPYRIS_INPUT && strcmp(error.file, "mine") == 0);
    CHECK(error.size == offsetof(struct lampyris_error, file));
    lampyris_context_release(context);
}

// --- what comes out ------------------------------------------------------------------------------

TEST(layers_are_read_with_strides_and_saved)
{
    enum { WIDTH = 32, HEIGHT = 24 };
    static float radiance[HEIGHT][WIDTH][3], spread[HEIGHT][WIDTH + 1][4];
    static uint32_t ids[HEIGHT][WIDTH][3];
    struct lampyris_context *context = open_context();
    struct lampyris_scene *scene;
    struct lampyris_render *render;
    struct lampyris_picture *picture;
    OK(context, lampyris_scene_load(context, path_of("scenes/cornell.json"), NULL, &scene));
    OK(context, lampyris_render_begin(scene,
                                      "{\"width\": 32, \"height\": 24, \"spp\": 8, \"aov\": "
                                      "[\"ids\", \"depth\", \"halves\"]}",
                                      NULL, &render));
    OK(context, lampyris_render_step(render, NULL, NULL));
    char names[200] = "";
    struct lampyris_layer layer = {.size = sizeof layer};
    uint32_t count = 0;
    for (; lampyris_render_layer(render, count, &layer) == LAMPYRIS_OK; count++)
        snprintf(names + strlen(names), sizeof names - strlen(names), "%s:%s%s ", layer.name,
                 layer.channels, layer.is_integer ? ":integer" : "");
    CHECK(strcmp(names, "radiance:R,G,B depth:Z id:object,material,primitive:integer half_a:R,G,B "
                        "half_b:R,G,B ") == 0,
          "%s", names);
    OK(context, lampyris_render_read(render, "radiance", radiance, 0, 0));
    OK(context, lampyris_render_read(render, "id", ids, 0, 0));
    memset(spread, 0xff, sizeof spread);
    OK(context,
       lampyris_render_read(render, "radiance", spread, sizeof(float[4]), sizeof spread[0]));
    double sum = 0;
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            CHECK(memcmp(radiance[y][x], spread[y][x], sizeof(float[3])) == 0);
            CHECK(isnan(spread[y][x][3]) && isnan(spread[y][WIDTH][0]));
            sum += (double)radiance[y][x][1];
        }
    CHECK(sum > 0);
    CHECK(lampyris_render_read(render, "normal", radiance, 0, 0) == LAMPYRIS_INPUT);
    CHECK(strstr(error_of(context).message, "radiance, depth, id, half_a, half_b"), "%s",
          error_of(context).message);
    OK(context, lampyris_render_save(render, "library.exr", NULL));
    OK(context, lampyris_render_save(render, "library.png", NULL));
    OK(context, lampyris_picture_load(context, "library.exr", NULL, &picture));
    uint32_t width, height;
    const float *pixels = lampyris_picture_pixels(picture, &width, &height);
    REQUIRE(width == WIDTH && height == HEIGHT);
    CHECK(memcmp(pixels, radiance, sizeof radiance) == 0);

    struct lampyris_metrics same = {.size = sizeof same}, other = same;
    OK(context, lampyris_compare(context, &radiance[0][0][0], pixels, WIDTH, HEIGHT, &same));
    CHECK(same.mse.value == 0 && same.pixels_differing == 0 && same.flip == 0 && same.ssim == 1);
    radiance[3][5][1] += 1;
    OK(context, lampyris_compare(context, &radiance[0][0][0], pixels, WIDTH, HEIGHT, &other));
    CHECK(other.pixels_differing == 1 && fabs(other.max - 1) < 1e-6, "%.9g", other.max);
    CHECK(fabs(other.mse.value * WIDTH * HEIGHT * 3 - 1) < 1e-5, "%.9g", other.mse.value);
    CHECK(other.mse.low <= other.mse.value && other.mse.value <= other.mse.high && other.flip > 0);
    CHECK(lampyris_compare(context, pixels, pixels, 0, 3, &other) == LAMPYRIS_INPUT);
    lampyris_picture_release(picture);
    OK(context, lampyris_picture_load(context, "library.exr", "half_a", &picture));
    lampyris_picture_release(picture);
    CHECK(lampyris_picture_load(context, "none.exr", NULL, &picture) == LAMPYRIS_INPUT);
    remove("library.exr");
    remove("library.png");
    lampyris_render_release(render);
    lampyris_scene_release(scene);
    lampyris_context_release(context);
}

TEST(parts_that_are_left_out_have_a_reason)
{
    struct lampyris_context *context = open_context();
    struct lampyris_scene *scene;
    struct lampyris_render *render;
    struct lampyris_part part = {.size = sizeof part};
    OK(context, lampyris_scene_load(context, path_of("scenes/cornell.json"), NULL, &scene));
    OK(context, lampyris_render_begin(scene, SMALL, NULL, &render));
    uint32_t count = 0, left_out = 0;
    for (; lampyris_render_part(render, count, &part) == LAMPYRIS_OK; count++) {
        left_out += part.is_left_out;
        CHECK(*part.kind && *part.name && part.is_left_out == (*part.reason != '\0'), "%s %s: %s",
              part.kind, part.name, part.reason);
    }
    CHECK(left_out > 20 && left_out < count, "%u of %u", left_out, count);
    lampyris_render_release(render);
    lampyris_scene_release(scene);
    lampyris_context_release(context);
}

TEST(devices_are_listed)
{
    struct lampyris_context *context = open_context();
    struct lampyris_device device = {.size = sizeof device};
    uint32_t count;
    OK(context, lampyris_device_count(context, &count));
    REQUIRE(count > 0);
    OK(context, lampyris_device_at(context, 0, &device));
    CHECK(*device.name && *device.driver && *device.kind && device.memory_bytes > 0);
    CHECK(lampyris_device_at(context, count, &device) == LAMPYRIS_INPUT);
    lampyris_context_release(context);
}

TEST(nothing_is_released_safely)
{
    lampyris_context_release(NULL);
    lampyris_scene_release(NULL);
    lampyris_render_release(NULL);
    lampyris_picture_release(NULL);
    lampyris_text_release(NULL);
    CHECK(*lampyris_version());
}

// --- many renders --------------------------------------------------------------------------------

static long resident_pages(void)
{
    long total = 0, resident = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    if (file && fscanf(file, "%ld %ld", &total, &resident) != 2)
        resident = 0;
    if (file)
        fclose(file);
    return resident;
}

static void render_often(int count)
{
    struct lampyris_context *context;
    REQUIRE(lampyris_context_create(NULL, &context) == LAMPYRIS_OK);
    long before = 0;
    for (int i = 0; i < count; i++) {
        struct lampyris_scene *scene;
        OK(context, lampyris_scene_load(context, path_of("scenes/cornell.json"), NULL, &scene));
        CHECK(render_hash(context, scene) != 0);
        lampyris_scene_release(scene);
        if (i == count / 4)
            before = resident_pages();
    }
    long grown = resident_pages() - before;
    // A leaked render would keep at least its film and its scene, which are more than two pages.
    CHECK(grown < 2L * (count - count / 4), "%ld pages more after %d renders", grown, count);
    fprintf(stderr, "%ld pages more after %d renders\n", grown, count);
    lampyris_context_release(context);
}

TEST(renders_leave_no_memory)
{
    render_often(200);
}

TEST(ten_thousand_renders_long)
{
    render_often(10000);
}

TEST_MAIN(TEST_CASE(pictures_have_the_bits_of_the_program),
          TEST_CASE(steps_renders_and_checkpoints_change_no_bit),
          TEST_CASE(goals_of_error_and_time_end_a_step), TEST_CASE(what_is_not_known_is_said),
          TEST_CASE(a_device_that_is_lost_is_an_error_and_opened_again),
          TEST_CASE(callbacks_hear_of_it_and_stop_it),
          TEST_CASE(a_log_has_the_messages_of_its_context),
          TEST_CASE(callbacks_may_use_another_context),
          TEST_CASE(threads_with_contexts_of_their_own_do_not_meet),
          TEST_CASE(the_locale_of_the_caller_stays), TEST_CASE(sizes_of_structs_are_respected),
          TEST_CASE(layers_are_read_with_strides_and_saved),
          TEST_CASE(parts_that_are_left_out_have_a_reason), TEST_CASE(devices_are_listed),
          TEST_CASE(nothing_is_released_safely), TEST_CASE(renders_leave_no_memory),
          TEST_CASE(ten_thousand_renders_long))
