// The library as its callers see it: through the public header alone.
#define _GNU_SOURCE // newlocale
#include "test.h"

#include <lampyris/lampyris.h>
#include <locale.h>
#include <pthread.h>
#include <stdint.h>

#define SMALL "{\"width\": 32, \"height\": 24, \"spp\": 8}"

// --- what the tests share ------------------------------------------------------------------------

struct told {
    int count;
    char last[400];
};

static void tell(void *user, enum lampyris_log_level level, const char *message)
{
    struct told *told = user;
    (void)level;
    told->count++;
    snprintf(told->last, sizeof told->last, "%s", message);
}

static const char *path_of(const char *name)
{
    static char paths[4][1024];
    static int next;
    char *path = paths[next++ % 4];
    const char *root = getenv("LAMPYRIS_SOURCE_ROOT");
    snprintf(path, sizeof paths[0], "%s/%s", root ? root : ".", name);
    return path;
}

// Messages of the validation layers fail the test, others are shown.
static void watch_validation(void *user, enum lampyris_log_level level, const char *message)
{
    (void)user, (void)level;
    fprintf(stderr, "%s\n", message);
    CHECK(!strstr(message, "Vulkan validation"), "%s", message);
}

static struct lampyris_context *open_context(void)
{
    const struct lampyris_context_params params = {.size = sizeof params,
                                                   .log = watch_validation,
                                                   .log_level = LAMPYRIS_LOG_WARNING,
                                                   .validation = true};
    struct lampyris_context *context;
    CHECK(lampyris_context_create(&params, &context) == LAMPYRIS_OK);
    return context;
}

static struct lampyris_error error_of(const struct lampyris_context *context)
{
    struct lampyris_error error = {.size = sizeof error};
    lampyris_context_error(context, &error);
    return error;
}

#define OK(context, call)                                                                          \
    do {                                                                                           \
        enum lampyris_status ok_status = (call);                                                   \
        if (ok_status == LAMPYRIS_NO_VULKAN)                                                       \
            SKIP("%s", error_of(context).message);                                                 \
        REQUIRE(ok_status == LAMPYRIS_OK, "%s", error_of(context).message);                        \
    } while (0)

static struct lampyris_state state_of(struct lampyris_render *render)
{
    struct lampyris_state state = {.size = sizeof state};
    CHECK(lampyris_render_state(render, &state) == LAMPYRIS_OK);
    return state;
}

// The hash that the program says. 0: it failed.
static uint64_t hash_of_program(const char *arguments)
{
    char command[2048], line[512];
    unsigned long long hash = 0;
    const char *program = getenv("LAMPYRIS_PROGRAM");
    snprintf(command, sizeof command, "%s render %s --json -o library_program.exr",
             program ? program : "lampyris", arguments);
    FILE *out = popen(command, "r");
    while (out && fgets(line, sizeof line, out)) {
        const char *found = strstr(line, "\"image_hash\": \"");
        if (found)
            hash = strtoull(found + strlen("\"image_hash\": \""), NULL, 16);
    }
    if (!out || pclose(out) != 0)
        hash = 0;
    remove("library_program.exr");
    return hash;
}

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
    // The command that it says makes the same again.
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
    lampyris_scene_release(scene); // what is being rendered lives on
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
    // It goes on, to the bits of one step; the pass that was stopped is ended in any case.
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

// The caller's locale is theirs again after each call.
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
    CHECK(lampyris_scene_check(scene, NULL) == LAMPYRIS_INPUT); // it is empty
    CHECK(uselocale((locale_t)0) == locale, "another locale is in use");
    lampyris_text_release(json);
    lampyris_scene_release(scene);
    lampyris_context_release(context);
    uselocale(former);
    freelocale(locale);
}

// --- documents -----------------------------------------------------------------------------------

static void check_get(struct lampyris_context *context, struct lampyris_scene *scene,
                      const char *pointer, const char *expected)
{
    char *json;
    OK(context, lampyris_scene_get(scene, pointer, &json));
    CHECK(strcmp(json, expected) == 0, "%s: %s", pointer, json);
    lampyris_text_release(json);
}

static uint64_t render_hash(struct lampyris_context *context, struct lampyris_scene *scene)
{
    struct lampyris_render *render;
    struct lampyris_state state = {.size = sizeof state};
    if (lampyris_render_begin(scene, SMALL, NULL, &render) ||
        lampyris_render_step(render, NULL, NULL) || lampyris_render_state(render, &state))
        fprintf(stderr, "%s\n", error_of(context).message);
    lampyris_render_release(render);
    return state.hash;
}

TEST(values_are_read_and_set_by_pointers)
{
    struct lampyris_context *context = open_context();
    struct lampyris_scene *scene;
    OK(context, lampyris_scene_parse(context,
                                     "{\"lampyris\": 1, \"materials\": {\"a/b~c\": {}, \"red\": "
                                     "{\"base_color\": [0.1, 0.25, 0.5]}}}",
                                     NULL, NULL, &scene));
    check_get(context, scene, "/materials/red/base_color/1", "0.25");
    check_get(context, scene, "/materials/a~1b~0c", "{}");
    OK(context, lampyris_scene_set(scene, "/materials/red/base_color/1", "1"));
    OK(context, lampyris_scene_set(scene, "/film/width", "16"));
    OK(context, lampyris_scene_set(scene, "/shapes", "[]"));
    OK(context, lampyris_scene_set(scene, "/shapes/-", "{\"type\": \"torus\"}"));
    check_get(context, scene, "/film", "{\"width\": 16}");
    check_get(context, scene, "/shapes/0/type", "\"torus\"");
    OK(context, lampyris_scene_remove(scene, "/shapes/0"));
    check_get(context, scene, "/shapes", "[]");
    check_get(context, scene, "/materials/red/base_color", "[0.10000000000000001, 1, 0.5]");
    static const char *const bad[][2] = {
        {"/materials/rod",
         "/materials/rod: there is no \"rod\" in the document; did you mean red?"},
        {"materials", "does not begin with \"/\""},
        {"/shapes/1", "\"1\" is no element of an array of 0"},
        {"/film/width/x", "there is no \"x\" inside 16"},
        {"/film~2", "expected \"~0\""},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        char *json;
        CHECK(lampyris_scene_get(scene, bad[i][0], &json) == LAMPYRIS_INPUT && !json);
        CHECK(strstr(error_of(context).message, bad[i][1]), "%s", error_of(context).message);
        CHECK(strcmp(error_of(context).place, bad[i][0]) == 0, "%s", error_of(context).place);
    }
    CHECK(lampyris_scene_set(scene, "/film/width", "{") == LAMPYRIS_INPUT);
    lampyris_scene_release(scene);
    lampyris_context_release(context);
}

TEST(edits_change_the_next_render)
{
    struct lampyris_context *context = open_context();
    struct lampyris_scene *scene;
    struct lampyris_render *render;
    char *json;
    OK(context, lampyris_scene_load(context, path_of("scenes/cornell.json"), NULL, &scene));
    uint64_t first = render_hash(context, scene);
    OK(context, lampyris_render_begin(scene, SMALL, NULL, &render));
    OK(context, lampyris_scene_get(scene, "/materials/red", &json));
    OK(context, lampyris_scene_set(scene, "/materials/red/base_color", "[0.1, 0.2, 0.9]"));
    uint64_t blue = render_hash(context, scene);
    char arguments[1200];
    snprintf(arguments, sizeof arguments,
             "%s -D 'materials.red.base_color=[0.1, 0.2, 0.9]' --size 32x24 --spp 8",
             path_of("scenes/cornell.json"));
    CHECK(blue != first && blue == hash_of_program(arguments));
    OK(context, lampyris_render_step(render, NULL, NULL));
    CHECK(state_of(render).hash == first, "a render keeps the scene that it began with");
    OK(context, lampyris_scene_set(scene, "/materials/red", json));
    CHECK(render_hash(context, scene) == first);
    lampyris_text_release(json);
    lampyris_render_release(render);
    lampyris_scene_release(scene);
    // Text, and a model as the base of a document.
    OK(context, lampyris_scene_load(context, path_of("scenes/models/vase.glb"), NULL, &scene));
    first = render_hash(context, scene);
    OK(context, lampyris_scene_set(scene, "/settings/max_bounces", "0"));
    CHECK(render_hash(context, scene) != first);
    OK(context, lampyris_scene_remove(scene, "/settings"));
    CHECK(render_hash(context, scene) == first);
    lampyris_scene_release(scene);
    lampyris_context_release(context);
}

TEST(errors_have_status_file_place_and_what_was_expected)
{
    struct lampyris_context *context = open_context();
    struct lampyris_scene *scene;
    struct lampyris_render *render;
    CHECK(lampyris_scene_load(context, "none.json", NULL, &scene) == LAMPYRIS_INPUT && !scene);
    CHECK(strcmp(error_of(context).file, "none.json") == 0, "%s", error_of(context).file);
    CHECK(lampyris_scene_load(context, "none.glb", NULL, &scene) == LAMPYRIS_INPUT);
    CHECK(lampyris_scene_load(context, "none.fbx", NULL, &scene) == LAMPYRIS_INPUT);
    CHECK(strcmp(error_of(context).expected, "json, gltf, glb, obj or ply") == 0, "%s",
          error_of(context).expected);
    CHECK(lampyris_scene_parse(context, "{", "a", NULL, &scene) == LAMPYRIS_INPUT);
    CHECK(strstr(error_of(context).message, "a/document.json: line 1"), "%s",
          error_of(context).message);
    OK(context, lampyris_scene_parse(context,
                                     "{\"lampyris\": 1, \"materials\": {\"red\": {\"type\": "
                                     "\"principled\", \"roughness\": 1.7}}}",
                                     NULL, NULL, &scene));
    CHECK(lampyris_scene_check(scene, NULL) == LAMPYRIS_INPUT);
    const struct lampyris_error error = error_of(context);
    CHECK(error.status == LAMPYRIS_INPUT);
    CHECK(strcmp(error.file, "document.json") == 0, "%s", error.file);
    CHECK(strcmp(error.place, "/materials/red/roughness") == 0, "%s", error.place);
    CHECK(strcmp(error.expected, "[0, 1]") == 0, "%s", error.expected);
    CHECK(strstr(error.message, "materials.red.roughness: 1.7"), "%s", error.message);
    OK(context, lampyris_scene_set(scene, "/materials/red/roughness", "0.5"));
    CHECK(error_of(context).status == LAMPYRIS_OK && !*error_of(context).message);
    CHECK(lampyris_scene_check(scene, NULL) == LAMPYRIS_INPUT, "an empty scene");
    lampyris_scene_release(scene);

    OK(context, lampyris_scene_load(context, path_of("scenes/cornell.json"), NULL, &scene));
    static const char *const settings[][3] = {
        {"{\"spq\": 1}", "settings: spq: unknown key; did you mean spp?", "/spq"},
        {"{\"spp\": 0}", "settings: spp: 0 is outside", "/spp"},
        {"{\"aov\": [\"depths\"]}", "settings: aov[0]:", "/aov/0"},
        {"{\"camera\": \"back\"}", "there is no camera \"back\"", "/camera"},
        {"{\"error\": 0}", "settings: error: 0 is outside", "/error"},
        {"{\"resume\": \"none.ck\"}", "none.ck: there is no such checkpoint", ""},
        {"[]", "settings: expected an object", ""},
        {"{\"sampler\": \"grid\", \"error\": 1e-3}", "cannot be combined with --error", ""},
    };
    for (size_t i = 0; i < sizeof settings / sizeof *settings; i++) {
        enum lampyris_status status = lampyris_render_begin(scene, settings[i][0], NULL, &render);
        CHECK(status == LAMPYRIS_INPUT && !render, "%s: %d", settings[i][0], status);
        CHECK(strstr(error_of(context).message, settings[i][1]), "%s", error_of(context).message);
        CHECK(strcmp(error_of(context).place, settings[i][2]) == 0, "%s", error_of(context).place);
    }
    OK(context, lampyris_render_begin(scene, SMALL, NULL, &render));
    CHECK(lampyris_render_save(render, "nowhere/x.exr", NULL) == LAMPYRIS_OUTPUT);
    CHECK(strcmp(error_of(context).file, "nowhere/x.exr") == 0, "%s", error_of(context).file);
    CHECK(lampyris_render_save(render, "x.tiff", NULL) == LAMPYRIS_INPUT);
    CHECK(lampyris_render_checkpoint(render, "nowhere/x.ck") == LAMPYRIS_OUTPUT);
    lampyris_render_release(render);
    lampyris_scene_release(scene);
    lampyris_context_release(context);
    const struct lampyris_context_params none = {.size = sizeof none, .device = "no such device"};
    REQUIRE(lampyris_context_create(&none, &context) == LAMPYRIS_OK);
    OK(context, lampyris_scene_load(context, path_of("scenes/cornell.json"), NULL, &scene));
    CHECK(lampyris_render_begin(scene, SMALL, NULL, &render) == LAMPYRIS_INPUT && !render);
    CHECK(strstr(error_of(context).message, "no such device"), "%s", error_of(context).message);
    lampyris_scene_release(scene);
    lampyris_context_release(context);
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

// --- meshes --------------------------------------------------------------------------------------

#define ROOM                                                                                       \
    "{\"lampyris\": 1, \"environment\": {\"radiance\": [1, 1, 1]}, \"camera\": {\"position\": "    \
    "[0.3, 0.3, 3], \"target\": [0.3, 0.3, 0], \"fov_degrees\": 40}, "                             \
    "\"materials\": {\"red\": {\"base_color\": [0.8, 0.1, 0.1]}}"

TEST(meshes_from_arrays_are_those_of_files)
{
    // Two triangles, in records with other data around.
    static const struct record {
        float weight, position[3], normal[3];
    } vertices[] = {
        {9, {0, 0, 0}, {0, 0, 1}},
        {9, {1, 0, 0}, {0, 0.6f, 0.8f}},
        {9, {0, 1, 0}, {0, 0, 1}},
        {9, {1, 1, 0.5f}, {0.6f, 0, 0.8f}},
    };
    static const uint32_t indices[] = {0, 1, 2, 2, 1, 3};
    FILE *file = fopen("library_mesh.ply", "w");
    REQUIRE(file);
    fprintf(file, "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
                  "property float z\nproperty float nx\nproperty float ny\nproperty float nz\n"
                  "element face 2\nproperty list uchar int vertex_indices\nend_header\n");
    for (int i = 0; i < 4; i++) {
        const struct record *v = &vertices[i];
        fprintf(file, "%.9g %.9g %.9g %.9g %.9g %.9g\n", (double)v->position[0],
                (double)v->position[1], (double)v->position[2], (double)v->normal[0],
                (double)v->normal[1], (double)v->normal[2]);
    }
    fprintf(file, "3 0 1 2\n3 2 1 3\n");
    fclose(file);

    struct lampyris_context *context = open_context();
    struct lampyris_scene *from_file, *from_arrays;
    OK(context, lampyris_scene_parse(context,
                                     ROOM ", \"shapes\": [{\"type\": \"mesh\", \"file\": "
                                          "\"library_mesh.ply\", \"material\": \"red\"}]}",
                                     ".", NULL, &from_file));
    OK(context, lampyris_scene_parse(context, ROOM "}", NULL, NULL, &from_arrays));
    struct lampyris_mesh mesh = {
        .size = sizeof mesh,
        .vertex_count = 4,
        .triangle_count = 2,
        .positions = vertices[0].position,
        .position_stride = sizeof *vertices,
        .normals = vertices[0].normal,
        .normal_stride = sizeof *vertices,
        .indices = indices,
        .material = "red",
    };
    uint64_t expected = render_hash(context, from_file);
    for (int is_borrowed = 0; is_borrowed < 2; is_borrowed++) {
        mesh.is_borrowed = is_borrowed;
        OK(context, lampyris_scene_add_mesh(from_arrays, "pair", &mesh));
        CHECK(render_hash(context, from_arrays) == expected && expected != 0);
    }
    check_get(context, from_arrays, "/shapes",
              "[{\"type\": \"mesh\", \"array\": \"pair\", \"name\": \"pair\", \"material\": "
              "\"red\"}]");
    OK(context, lampyris_scene_set(from_arrays, "/shapes/0/transform", "{\"scale\": 0.5}"));
    CHECK(render_hash(context, from_arrays) != expected);
    static const uint32_t beyond[] = {0, 1, 2, 2, 1, 4};
    mesh.indices = beyond;
    OK(context, lampyris_scene_add_mesh(from_arrays, "pair", &mesh));
    CHECK(lampyris_scene_check(from_arrays, NULL) == LAMPYRIS_INPUT);
    CHECK(strstr(error_of(context).message, "indices[1][2]: 4; expected less than 4"), "%s",
          error_of(context).message);
    CHECK(strcmp(error_of(context).place, "/shapes/0/array") == 0, "%s", error_of(context).place);
    mesh.positions = NULL;
    CHECK(lampyris_scene_add_mesh(from_arrays, "none", &mesh) == LAMPYRIS_INPUT);
    lampyris_scene_release(from_file);
    lampyris_scene_release(from_arrays);
    remove("library_mesh.ply");
    OK(context, lampyris_scene_load(context, path_of("scenes/models/knot.ply"), NULL, &from_file));
    mesh.positions = vertices[0].position;
    CHECK(lampyris_scene_add_mesh(from_file, "pair", &mesh) == LAMPYRIS_INPUT);
    lampyris_scene_release(from_file);
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
    // A render that is lost keeps its film and its scene at least: more than two pages.
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
          TEST_CASE(callbacks_hear_of_it_and_stop_it),
          TEST_CASE(a_log_has_the_messages_of_its_context),
          TEST_CASE(callbacks_may_use_another_context),
          TEST_CASE(threads_with_contexts_of_their_own_do_not_meet),
          TEST_CASE(the_locale_of_the_caller_stays), TEST_CASE(values_are_read_and_set_by_pointers),
          TEST_CASE(edits_change_the_next_render),
          TEST_CASE(errors_have_status_file_place_and_what_was_expected),
          TEST_CASE(sizes_of_structs_are_respected),
          TEST_CASE(meshes_from_arrays_are_those_of_files),
          TEST_CASE(layers_are_read_with_strides_and_saved),
          TEST_CASE(parts_that_are_left_out_have_a_reason), TEST_CASE(devices_are_listed),
          TEST_CASE(nothing_is_released_safely), TEST_CASE(renders_leave_no_memory),
          TEST_CASE(ten_thousand_renders_long))
