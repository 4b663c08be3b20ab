// Tests that an edited scene, written to a file, is read with the same bits.
#include "mesh_files.h"

#include "json/json_node.h"
#include "scene/core/environment.h"
#include "scene/core/light.h"
#include "scene/json/load_json.h"
#include "scene/json/scene_write.h"
#include "scene/sky/surroundings.h"
#include "scene_edit_fixture.h"

#include <dirent.h>
#include <sys/stat.h>

#define ONE_TRIANGLE "v 1 1 1\nv 3 1 1\nv 1 2 1\nf 1 2 3\n"

// A scene, with a copy of its state after loading.
struct edited {
    struct scene_load_params load;
    struct scene scene, before;
    struct arena arena;
};

static bool load_edited(struct edited *e, struct scene_load_params load)
{
    struct err err = {0};
    *e = (struct edited){.load = load};
    bool ok = scene_load(&load, &e->scene, &err) &&
              scene_snapshot(&e->arena, &e->scene, &e->before, &err);
    CHECK(ok, "%s", err.msg);
    return ok;
}

static void finish_edited(struct edited *e)
{
    scene_finish(&e->scene);
    arena_finish(&e->arena);
}

static bool write_edited(const struct edited *e, const char *path, bool *is_outside,
                         struct err *err)
{
    const struct scene_write_params params = {
        .path = path,
        .load = &e->load,
        .before = &e->before,
        .scene = &e->scene,
        .is_outside = is_outside,
    };
    return scene_write(&params, err);
}

// Writes the scene, loads the file and compares.
static void check_round_trip(struct edited *e, const char *path, const char *what)
{
    struct err err = {0};
    struct scene again = {0};
    bool is_outside = false;
    REQUIRE(write_edited(e, path, &is_outside, &err), "%s: %s", what, err.msg);
    const struct scene_load_params load = {.path = path, .allow_outside_paths = is_outside};
    REQUIRE(scene_load(&load, &again, &err), "%s: %s", what, err.msg);
    check_same_scene(&e->scene, &again, what);
    CHECK(strcmp(again.path, path) == 0 && again.base, "%s: path %s", what, again.path);
    scene_finish(&again);
}

static char *read_text(const char *path)
{
    static char text[1 << 16];
    FILE *file = fopen(path, "rb");
    size_t size = file ? fread(text, 1, sizeof text - 1, file) : 0;
    text[size] = '\0';
    if (file)
        fclose(file);
    return text;
}

// --- every scene there is ------------------------------------------------------------------------

// Edits, writes and loads the scene; then edits it again and writes it over the first file.
static void check_scene_twice(struct scene_load_params load, uint64_t seed, const char *what)
{
    struct random random = {seed};
    struct edited first, second;
    char path[sizeof path_buffer];
    snprintf(path, sizeof path, "%s", in_folder("edited.json"));
    remove(path);
    if (!load_edited(&first, load))
        return;
    check_round_trip(&first, path, what); // nothing is edited yet
    edit_at_random(&first.scene, &random);
    check_round_trip(&first, path, what);
    finish_edited(&first);
    const struct scene_load_params again = {.path = path, .allow_outside_paths = true};
    if (!load_edited(&second, again))
        return;
    edit_at_random(&second.scene, &random);
    check_round_trip(&second, path, what);
    finish_edited(&second);
}

TEST(scenes_of_the_tree)
{
    const char *root = getenv("LAMPYRIS_SOURCE_ROOT");
    char scenes[256], path[600], mesh[sizeof path_buffer];
    snprintf(scenes, sizeof scenes, "%s/scenes", root ? root : ".");
    snprintf(mesh, sizeof mesh, "%s", write_text("mesh.obj", ONE_TRIANGLE));
    const struct scene_override override = {"mesh", mesh};
    DIR *list = opendir(scenes);
    REQUIRE(list, "%s", scenes);
    uint64_t count = 0;
    for (struct dirent *entry; (entry = readdir(list));) {
        const char *dot = strrchr(entry->d_name, '.');
        if (!dot || strcmp(dot, ".json") != 0)
            continue;
        snprintf(path, sizeof path, "%s/%s", scenes, entry->d_name);
        bool needs_mesh = strcmp(entry->d_name, "mesh_room.json") == 0;
        const struct scene_load_params load = {
            .path = path, .overrides = &override, .override_count = needs_mesh};
        check_scene_twice(load, ++count, entry->d_name);
    }
    closedir(list);
    CHECK(count >= 40, "%llu scenes", (unsigned long long)count);
}

TEST(models_of_others)
{
    static const char *const files[] = {"gltf/shader_ball/shader_ball.gltf",
                                        "gltf/balloon/scene.gltf"};
    char path[512];
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        const char *file = data_file(files[i]);
        if (!file)
            SKIP("%s: missing", files[i]);
        snprintf(path, sizeof path, "%s", file);
        check_scene_twice((struct scene_load_params){.path = path}, 100 + i, files[i]);
    }
}

// A moving triangle in the second of two scenes, with a light and a camera.
static const char gltf[] =
    "{\"asset\": {\"version\": \"2.0\"}, \"extensionsUsed\": [\"KHR_lights_punctual\"],"
    "\"extensions\": {\"KHR_lights_punctual\": {\"lights\": [{\"type\": \"spot\", \"name\": \"s\","
    "\"spot\": {}}, {\"type\": \"point\"}]}},"
    "\"buffers\": [{\"byteLength\": 68, \"uri\": \"data:application/octet-stream;base64,"
    "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/"
    "AACAPwAAAEA=\"}],"
    "\"bufferViews\": [{\"buffer\": 0, \"byteLength\": 36}, {\"buffer\": 0, \"byteOffset\": 36,"
    "\"byteLength\": 8}, {\"buffer\": 0, \"byteOffset\": 44, \"byteLength\": 24}],"
    "\"accessors\": [{\"bufferView\": 0, \"componentType\": 5126, \"count\": 3, \"type\": \"VEC3\","
    "\"min\": [0, 0, 0], \"max\": [1, 1, 0]},"
    "{\"bufferView\": 1, \"componentType\": 5126, \"count\": 2, \"type\": \"SCALAR\","
    "\"min\": [0], \"max\": [1]},"
    "{\"bufferView\": 2, \"componentType\": 5126, \"count\": 2, \"type\": \"VEC3\"}],"
    "\"meshes\": [{\"primitives\": [{\"attributes\": {\"POSITION\": 0}, \"material\": 0}]}],"
    "\"materials\": [{\"name\": \"a ${b}\", \"pbrMetallicRoughness\": {\"roughnessFactor\": 0.3}},"
    "{\"name\": \"a ${b}\"}],"
    "\"cameras\": [{\"type\": \"perspective\", \"perspective\": {\"yfov\": 0.7, \"znear\": 0.1}}],"
    "\"nodes\": [{\"mesh\": 0}, {\"camera\": 0, \"name\": \"eye\","
    "\"rotation\": [0.18257418583505536, 0.3651483716701107, 0.5477225575051661,"
    "0.7302967433402214]}, {\"rotation\": [0.5, 0.5, 0.5, 0.5],"
    "\"extensions\": {\"KHR_lights_punctual\": {\"light\": 0}}},"
    "{\"extensions\": {\"KHR_lights_punctual\": {\"light\": 1}}}],"
    "\"scenes\": [{\"nodes\": [3]}, {\"name\": \"second\", \"nodes\": [0, 1, 2, 3]}],"
    "\"animations\": [{\"name\": \"move\", \"samplers\": [{\"input\": 1, \"output\": 2}],"
    "\"channels\": [{\"sampler\": 0, \"target\": {\"node\": 0, \"path\": \"translation\"}}]}]}";

TEST(choices_within_gltf_files)
{
    char path[sizeof path_buffer];
    snprintf(path, sizeof path, "%s", write_text("model.gltf", gltf));
    const double seconds = 0.3;
    const struct scene_load_params load = {
        .path = path, .at_seconds = &seconds, .animation = "move", .scene_name = "second"};
    for (uint64_t seed = 0; seed < 20; seed++)
        check_scene_twice(load, seed, "model.gltf");
    struct scene scene;
    struct err err = {0};
    const struct scene_load_params again = {.path = in_folder("edited.json")};
    REQUIRE(scene_load(&again, &scene, &err), "%s", err.msg);
    CHECK(scene.instances[0].transform[0][3] > 0.2, "at %g", scene.instances[0].transform[0][3]);
    scene_finish(&scene);
}

// --- environments --------------------------------------------------------------------------------

static const char *write_environment(void)
{
    static char path[sizeof path_buffer];
    static const char image[] = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n"
                                "\x80\x40\x20\x81\x10\x20\x30\x82";
    snprintf(path, sizeof path, "%s", write_bytes("sky.hdr", image, sizeof image - 1));
    return path;
}

// The lights of a scene; it may also have a sky with a sun.
#define LIGHTS                                                                                     \
    "\"lights\": [{\"type\": \"point\", \"position\": [0, 1, 0], \"intensity\": [1, 2, 3]}],"      \
    "\"shapes\": [{\"type\": \"mesh\", \"file\": \"one.obj\"}]}"
static const char *const documents[] = {
    "{\"lampyris\": 1, " LIGHTS,
    "{\"lampyris\": 1, \"environment\": {\"radiance\": [1, 2, 3], \"strength\": 0.3}, " LIGHTS,
    "{\"lampyris\": 1, \"environment\": {\"type\": \"sky\", \"rotation_degrees\": 33,"
    "\"strength\": 0.01}, " LIGHTS,
};
#define DOCUMENT_COUNT (sizeof documents / sizeof *documents)

static bool replace(struct scene *scene, uint32_t kind)
{
    struct sky sky = sky_default();
    const struct environment_gradient gradient = {{0.1f, 0.2f, 0.3f}, {1, 1, 1}, {0, 0, 0.7f}};
    sky_place_sun(&sky, 31.7, 12.3);
    sky.sun_diameter *= 1.7;
    sky.turbidity = 2.3;
    const struct environment_source sources[] = {
        {.radiance = {0.1f, 0.2f, 0.3f}},
        {.file = write_environment(), .radiance = {0.1f, 0.2f, 0.3f}},
        {.gradient = &gradient},
        {.sky = &sky},
    };
    struct err err = {0};
    if (kind == 4) { // no lights
        const struct environment former = scene->environment;
        scene->environment = (struct environment){0};
        scene_remove_sun(scene, &former);
        return true;
    }
    bool ok = scene_replace_environment(scene, &sources[kind], &err);
    CHECK(ok, "%s", err.msg);
    return ok;
}

TEST(environments_that_were_replaced)
{
    struct random random = {1};
    char path[sizeof path_buffer], saved[sizeof path_buffer], what[64];
    write_text("one.obj", ONE_TRIANGLE);
    snprintf(saved, sizeof saved, "%s", in_folder("saved.json"));
    for (uint32_t from = 0; from < DOCUMENT_COUNT; from++)
        for (uint32_t to = 0; to < 5; to++) {
            struct edited e;
            struct err err = {0};
            snprintf(what, sizeof what, "from %u to %u", from, to);
            snprintf(path, sizeof path, "%s", write_text("original.json", documents[from]));
            remove(saved);
            if (!load_edited(&e, (struct scene_load_params){.path = path}) ||
                !replace(&e.scene, to))
                return;
            if (e.scene.environment.present)
                CHECK(scene_adjust_environment(&e.scene, 0.7, 0.3, &err), "%s", err.msg);
            check_round_trip(&e, saved, what);
            edit_at_random(&e.scene, &random);
            check_round_trip(&e, saved, what);
            finish_edited(&e);
            // Edits the saved scene again, with the environment of another one.
            if (!load_edited(&e, (struct scene_load_params){.path = saved}))
                return;
            check_round_trip(&e, saved, what);
            edit_at_random(&e.scene, &random);
            check_round_trip(&e, saved, what);
            if (replace(&e.scene, (to + 1) % 5))
                check_round_trip(&e, saved, what);
            finish_edited(&e);
        }
}

TEST(environments_of_the_command_line)
{
    char path[sizeof path_buffer], saved[sizeof path_buffer];
    struct sky sky = sky_default();
    const float radiance[3] = {0.1f, 0.2f, 0.7f};
    const double strength = 0.3;
    write_text("one.obj", ONE_TRIANGLE);
    snprintf(saved, sizeof saved, "%s", in_folder("saved.json"));
    for (uint32_t from = 0; from < DOCUMENT_COUNT; from++) {
        snprintf(path, sizeof path, "%s", write_text("original.json", documents[from]));
        const struct scene_load_params loads[] = {
            {.path = path, .environment_sky = &sky, .environment_rotation = 0.3},
            {.path = path, .environment_radiance = radiance, .environment_strength = &strength},
            {.path = path, .environment_file = write_environment(), .environment_rotation = -1},
            {.path = path, .environment_rotation = 0.3, .environment_strength = &strength},
        };
        for (size_t i = 0; i < sizeof loads / sizeof *loads; i++) {
            struct edited e, again;
            remove(saved);
            if (!load_edited(&e, loads[i]))
                return;
            check_round_trip(&e, saved, "command line");
            finish_edited(&e);
            // The same options are applied to the saved file.
            struct scene_load_params load = loads[i];
            char other[sizeof path_buffer];
            snprintf(other, sizeof other, "%s", in_folder("other.json"));
            load.path = saved;
            if (!load_edited(&again, load))
                return;
            uint32_t suns = again.scene.environment.sun.light > 0;
            CHECK(again.scene.light_count == 1 + suns, "%u lights", again.scene.light_count);
            check_round_trip(&again, other, "command line, twice");
            finish_edited(&again);
        }
    }
}

// --- files ---------------------------------------------------------------------------------------

static void check_not_written(const struct edited *e, const char *path, enum err_code code,
                              const char *message)
{
    struct err err = {0};
    CHECK(!write_edited(e, path, NULL, &err) && err.code == code, "code %d", err.code);
    CHECK(strstr(err.msg, message), "'%s' is not in '%s'", message, err.msg);
}

TEST(names_of_files)
{
    char path[sizeof path_buffer], saved[sizeof path_buffer], deeper[sizeof path_buffer];
    struct edited e;
    struct err err = {0};
    write_text("one.obj", ONE_TRIANGLE);
    snprintf(path, sizeof path, "%s", write_text("original.json", documents[0]));
    snprintf(deeper, sizeof deeper, "%s", in_folder("deeper"));
    CHECK(mkdir(deeper, 0700) == 0);
    REQUIRE(load_edited(&e, (struct scene_load_params){.path = path}));

    bool is_outside = true;
    snprintf(saved, sizeof saved, "%s", in_folder("beside.json"));
    REQUIRE(write_edited(&e, saved, &is_outside, &err), "%s", err.msg);
    CHECK(!is_outside && strstr(read_text(saved), "\"file\": \"original.json\""));
    CHECK(!strstr(read_text(saved), "comment"));

    snprintf(deeper, sizeof deeper, "%s", in_folder("deeper/out.json"));
    REQUIRE(write_edited(&e, deeper, &is_outside, &err), "%s", err.msg);
    CHECK(is_outside && strstr(read_text(deeper), "--allow-outside-paths"));
    struct scene scene;
    CHECK(!scene_load(&(struct scene_load_params){.path = deeper}, &scene, &err) &&
              strstr(err.msg, "base.file") && strstr(err.msg, "is absolute") &&
              strstr(err.msg, "--allow-outside-paths"),
          "%s", err.msg);

    check_not_written(&e, path, ERR_USAGE, "expected another name");
    check_not_written(&e, in_folder("a.txt"), ERR_USAGE, "ends in .json");
    check_not_written(&e, in_folder("none/a.json"), ERR_OUTPUT, "No such file");
    finish_edited(&e);

    // A file that was made from another one may be overwritten, but not the file from which it was
    // made.
    REQUIRE(load_edited(&e, (struct scene_load_params){.path = saved}));
    check_round_trip(&e, saved, "itself");
    check_not_written(&e, path, ERR_USAGE, "expected another name");
    CHECK(strstr(read_text(saved), "\"file\": \"original.json\""));
    finish_edited(&e);
}

TEST(paths_in_overrides)
{
    char path[sizeof path_buffer], saved[sizeof path_buffer], mesh[sizeof path_buffer];
    struct edited e;
    struct err err = {0};
    bool is_outside;
    snprintf(path, sizeof path, "%s",
             write_text("defines.json",
                        "{\"lampyris\": 1, \"define\": {\"mesh\": null, \"k\": 1}, \"shapes\":"
                        "[{\"type\": \"mesh\", \"file\": \"${mesh}\", \"transform\":"
                        "{\"scale\": \"${k}\"}}]}"));
    snprintf(mesh, sizeof mesh, "%s", write_text("a:b.obj", ONE_TRIANGLE));
    const struct scene_override overrides[] = {
        {"k", "0.1"}, {"mesh", mesh}, {"shapes.0.transform.scale", "${k}"}};
    REQUIRE(load_edited(&e, (struct scene_load_params){path, overrides, 3}));
    snprintf(saved, sizeof saved, "%s", in_folder("saved.json"));
    REQUIRE(write_edited(&e, saved, &is_outside, &err), "%s", err.msg);
    CHECK(!is_outside && strstr(read_text(saved), "{\"key\": \"mesh\", \"value\": \"./a:b.obj\"}"),
          "%s", read_text(saved));
    check_round_trip(&e, saved, "overrides");
    finish_edited(&e);
    REQUIRE(load_edited(&e, (struct scene_load_params){.path = saved}));
    check_round_trip(&e, saved, "overrides again");
    // Saves into another folder, and back.
    snprintf(path, sizeof path, "%s", in_folder("elsewhere"));
    CHECK(mkdir(path, 0700) == 0);
    snprintf(path, sizeof path, "%s", in_folder("elsewhere/saved.json"));
    check_round_trip(&e, path, "elsewhere");
    finish_edited(&e);
    REQUIRE(load_edited(&e, (struct scene_load_params){.path = path, .allow_outside_paths = true}));
    check_round_trip(&e, saved, "back");
    CHECK(strstr(read_text(saved), "\"./a:b.obj\""), "%s", read_text(saved));
    finish_edited(&e);
}

// --- lights with profiles ------------------------------------------------------------------------

TEST(profiles_go_along_with_their_lights)
{
    char path[512];
    const char *root = getenv("LAMPYRIS_SOURCE_ROOT");
    struct random random = {5};
    struct edited e;
    snprintf(path, sizeof path, "%s/scenes/profiles.json", root ? root : ".");
    REQUIRE(load_edited(&e, (struct scene_load_params){.path = path}));
    unsigned profiles = 0;
    for (int turn = 0; turn < 50; turn++) {
        for (uint32_t i = 0; i < e.scene.light_count; i++) {
            double to[3];
            for (int c = 0; c < 3; c++)
                to[c] = turn == 7 ? e.scene.lights[i].profile_x[c] : random_unit(&random) - 0.5;
            light_aim(&e.scene.lights[i], to);
            profiles += e.scene.lights[i].profile != NULL;
        }
        if (turn % 7 == 0)
            check_round_trip(&e, in_folder("aimed.json"), "aimed");
    }
    CHECK(profiles > 0);
    finish_edited(&e);
}

// --- what cannot be said -------------------------------------------------------------------------

TEST(values_that_are_refused)
{
    char path[sizeof path_buffer], saved[sizeof path_buffer];
    struct edited e;
    write_text("one.obj", ONE_TRIANGLE);
    snprintf(path, sizeof path, "%s", write_text("original.json", documents[1]));
    snprintf(saved, sizeof saved, "%s", in_folder("refused.json"));
    REQUIRE(load_edited(&e, (struct scene_load_params){.path = path}));
    e.scene.materials[0].ior = 1e-3f;
    check_not_written(&e, saved, ERR_INPUT, "edits.materials[0].ior: 0.001 is outside [0.01, 100]");
    e.scene.materials[0].ior = NAN;
    check_not_written(&e, saved, ERR_INPUT, "ior: nan cannot be stored in JSON");
    e.scene.materials[0].ior = 1.5f;
    e.scene.materials[0].model = 9;
    check_not_written(&e, saved, ERR_INPUT, "edits.materials[0].type: \"unknown\" is unknown");
    e.scene.materials[0].model = 0;
    e.scene.lights[0].direction[0] = 2;
    check_not_written(&e, saved, ERR_INPUT, "light 0");
    e.scene.lights[0].direction[0] = 0;
    e.scene.cameras[0].direction[0] = 2;
    check_not_written(&e, saved, ERR_INPUT, "camera: cannot be written exactly");
    e.scene.cameras[0] = e.before.cameras[0];
    e.scene.settings.filter_radius = 99;
    check_not_written(&e, saved, ERR_INPUT, "settings.filter_radius: 99 is outside [0, 16]");
    e.scene.settings = e.before.settings;
    e.scene.environment.radiance[0] = -1;
    check_not_written(&e, saved, ERR_INPUT, "edits.environment.radiance[0]: -1 is outside");
    e.scene.environment.radiance[0] = 1;
    e.scene.light_count = 0;
    check_not_written(&e, saved, ERR_INPUT, "were removed");
    e.scene.light_count = 1;
    CHECK(access(saved, F_OK) != 0, "%s was written", saved);
    check_round_trip(&e, saved, "at last");
    finish_edited(&e);
}

// If any allocation fails, there is a message and no file.
TEST(memory_that_runs_out)
{
    char path[sizeof path_buffer], saved[sizeof path_buffer];
    struct random random = {9};
    struct edited e;
    write_text("one.obj", ONE_TRIANGLE);
    snprintf(path, sizeof path, "%s", write_text("original.json", documents[2]));
    snprintf(saved, sizeof saved, "%s", in_folder("short.json"));
    const struct scene_override override = {"lights.0.intensity", "[3, 2, 1]"};
    REQUIRE(load_edited(&e, (struct scene_load_params){path, &override, 1}));
    if (!replace(&e.scene, 1))
        return;
    edit_at_random(&e.scene, &random);
    bool ok = false;
    unsigned failures = 0;
    for (uint64_t n = 1; !ok && n < 100; n++) {
        struct err err = {0};
        arena_fail_at(n);
        ok = write_edited(&e, saved, NULL, &err);
        arena_fail_at(0);
        CHECK(ok || err.code == ERR_SYSTEM, "allocation %u: %s", (unsigned)n, err.msg);
        CHECK(ok == (access(saved, F_OK) == 0), "allocation %u", (unsigned)n);
        failures += !ok;
    }
    CHECK(ok && failures > 5, "%u failures", failures);
    finish_edited(&e);
}

// If some characters of a written file are changed, the result is an error that names the file, or
// a scene.
TEST(damaged_files)
{
    char path[sizeof path_buffer];
    struct random random = {7};
    struct edited e;
    write_text("one.obj", ONE_TRIANGLE);
    snprintf(path, sizeof path, "%s", write_text("original.json", documents[1]));
    REQUIRE(load_edited(&e, (struct scene_load_params){.path = path}));
    edit_at_random(&e.scene, &random);
    check_round_trip(&e, in_folder("whole.json"), "whole");
    finish_edited(&e);
    char *text = read_text(in_folder("whole.json"));
    size_t length = strlen(text);
    unsigned loaded = 0;
    for (int i = 0; i < 3000; i++) {
        static const char junk[] = "-019ae.\"[]{},:\\$ ";
        struct scene scene;
        struct err err = {0};
        size_t at = random_below(&random, (uint32_t)length);
        char was = text[at];
        text[at] = junk[random_below(&random, sizeof junk - 1)];
        snprintf(path, sizeof path, "%s", write_text("damaged.json", text));
        bool ok = scene_load(&(struct scene_load_params){.path = path}, &scene, &err);
        CHECK(ok || (err.code == ERR_INPUT && strncmp(err.msg, path, strlen(path)) == 0), "%s",
              err.msg);
        loaded += ok;
        scene_finish(&scene);
        text[at] = was;
    }
    CHECK(loaded > 100 && loaded < 2900, "%u loaded", loaded);
}

// --- cameras -------------------------------------------------------------------------------------

TEST(cameras_as_text)
{
    struct random random = {3};
    struct arena arena = {0};
    for (int i = 0; i < 2000; i++) {
        struct camera camera = {.direction = {0, 0, -1}, .up = {0, 1, 0}, .fov_y = 1};
        struct scene edited = {.cameras = &camera}, read = {0};
        struct err err = {0};
        edit_at_random(&edited, &random);
        const char *text = camera_to_json(&arena, &camera);
        REQUIRE(text);
        json_t *root = json_pack("{}"), *value = json_loads(text, 0, NULL);
        REQUIRE(root && value && json_object_set_new(root, "camera", value) == 0, "%s", text);
        const struct json_node document = node_root("text", root);
        const struct json_node node = node_member(&document, "camera");
        struct json_loader loader = {.scene = &read};
        REQUIRE(load_json_camera(&loader, &node, &err), "%s in %s", err.msg, text);
        check_same_scene(
            &edited, &(struct scene){.cameras = read.cameras, .settings = edited.settings}, text);
        json_decref(root);
        scene_finish(&read);
    }
    const struct camera plain = {
        .direction = {0, 0, -1}, .up = {0, 1, 0}, .fov_y = 40 * (M_PI / 180)};
    const char *text = camera_to_json(&arena, &plain);
    CHECK(text && strcmp(text, "{\n    \"position\": [0, 0, 0],\n    \"direction\": [0, 0, -1],\n"
                               "    \"up\": [0, 1, 0],\n    \"fov_degrees\": 40\n  }") == 0,
          "%s", text);
    const struct camera broken = {.direction = {0, 0, NAN}, .up = {0, 1, 0}, .fov_y = 1};
    CHECK(!camera_to_json(&arena, &broken));
    arena_finish(&arena);
}

// Finds a random value of a written file, and its end.
static char *find_value(char *text, struct random *random, char **end)
{
    char *edits = strstr(text, "\"edits\"");
    char *at = edits + random_below(random, (uint32_t)strlen(edits));
    while (*at && *at != ':' && *at != ',' && *at != '[')
        at++;
    at += strspn(at, ":,[ \n");
    *end = at + strcspn(at, ",]}");
    return at;
}

// Replaces values of the edits by values of other types and sizes.
TEST(odd_values)
{
    static const char *const odd[] = {
        "1e308",    "-1e308",
        "1e-320",   "1e999",
        "-1",       "0",
        "256",      "4294967296",
        "null",     "true",
        "\"x\"",    "\"\"",
        "[]",       "[1, 2, 3]",
        "{}",       "9223372036854775807",
        "-0.0",     "0.5",
        "\"${x}\"", "\"off\"",
        "\"spot\"", "\"directional\"",
    };
    static char damaged[1 << 16];
    char path[sizeof path_buffer];
    struct random random = {11};
    struct edited e;
    write_text("one.obj", ONE_TRIANGLE);
    snprintf(path, sizeof path, "%s", write_text("original.json", documents[1]));
    REQUIRE(load_edited(&e, (struct scene_load_params){.path = path}));
    edit_at_random(&e.scene, &random);
    check_round_trip(&e, in_folder("whole.json"), "whole");
    finish_edited(&e);
    char *text = read_text(in_folder("whole.json"));
    unsigned loaded = 0;
    for (int i = 0; i < 3000; i++) {
        struct scene scene;
        struct err err = {0};
        char *end, *at = find_value(text, &random, &end);
        const char *value = odd[random_below(&random, sizeof odd / sizeof *odd)];
        snprintf(damaged, sizeof damaged, "%.*s%s%s", (int)(at - text), text, value, end);
        snprintf(path, sizeof path, "%s", write_text("damaged.json", damaged));
        bool ok = scene_load(&(struct scene_load_params){.path = path}, &scene, &err);
        CHECK(ok || (err.code == ERR_INPUT && strncmp(err.msg, path, strlen(path)) == 0), "%s: %s",
              value, err.msg);
        loaded += ok;
        scene_finish(&scene);
    }
    CHECK(loaded > 100 && loaded < 2900, "%u loaded", loaded);
}

int main(int argc, char **argv)
{
    static const struct test_case cases[] = {
        TEST_CASE(scenes_of_the_tree),
        TEST_CASE(models_of_others),
        TEST_CASE(choices_within_gltf_files),
        TEST_CASE(environments_that_were_replaced),
        TEST_CASE(environments_of_the_command_line),
        TEST_CASE(names_of_files),
        TEST_CASE(paths_in_overrides),
        TEST_CASE(profiles_go_along_with_their_lights),
        TEST_CASE(values_that_are_refused),
        TEST_CASE(memory_that_runs_out),
        TEST_CASE(damaged_files),
        TEST_CASE(odd_values),
        TEST_CASE(cameras_as_text),
    };
    if (!begin_mesh_tests())
        return 1;
    return test_run(cases, sizeof cases / sizeof cases[0], argc, argv);
}
