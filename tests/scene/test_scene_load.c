// Tests the camera, light and material that scene_load adds to a file, and environments.
#include "mesh_files.h"

#include "environment_texel.h"
#include "image/image.h"
#include "scene/core/affine.h"
#include "scene/core/bounds.h"

#define ONE_TRIANGLE "v 1 1 1\nv 3 1 1\nv 1 2 1\nf 1 2 3\n"

static struct scene load(const char *path)
{
    const struct scene_load_params params = {.path = path};
    struct scene scene;
    struct err err = {0};
    bool ok = scene_load(&params, &scene, &err);
    CHECK(ok, "%s", err.msg);
    return scene;
}

static void check_refused(const struct scene_load_params *params, enum err_code code,
                          const char *message)
{
    struct scene scene;
    struct err err = {0};
    CHECK(!scene_load(params, &scene, &err) && err.code == code, "code %d", err.code);
    CHECK(strstr(err.msg, message), "'%s' is not in '%s'", message, err.msg);
    CHECK(!scene.arena.blocks && scene.mesh_count == 0, "not finished");
    scene_finish(&scene);
}

TEST(a_mesh_alone_is_placed_framed_and_lit)
{
    struct scene scene = load(write_text("one.OBJ", ONE_TRIANGLE));
    REQUIRE(scene.instance_count == 1 && scene.camera_count == 1 && scene.material_count == 1);
    CHECK(scene.instances[0].transform[0][0] == 1 && scene.instances[0].material == SCENE_NONE);
    CHECK(scene.environment.present && scene.environment.radiance[1] == 1);
    CHECK(scene.camera_is_framed && !scene.has_studio && !scene.has_ground && !scene.is_empty);
    REQUIRE(scene.note_count == 2);
    CHECK(strstr(scene.notes[0], "view with y up (--up)"), "%s", scene.notes[0]);
    CHECK(strstr(scene.notes[1], "no light in the file"), "%s", scene.notes[1]);
    scene_finish(&scene);
}

TEST(unknown_files_are_refused)
{
    check_refused(&(struct scene_load_params){.path = "a.fbx"}, ERR_INPUT,
                  "a.fbx: extension \"fbx\" is unknown; expected json, gltf, glb, obj, ply or stl; "
                  "Blender can export it as glTF");
    check_refused(&(struct scene_load_params){.path = "json"}, ERR_INPUT,
                  "extension \"\" is unknown");
    check_refused(&(struct scene_load_params){.path = "none.json"}, ERR_INPUT,
                  "none.json: No such");
    const struct scene_override override = {"a", "b"};
    check_refused(&(struct scene_load_params){.path = "a.obj", &override, 1}, ERR_USAGE,
                  "-D a: only .json scenes");
    const double seconds = 0;
    check_refused(&(struct scene_load_params){.path = "a.json", .at_seconds = &seconds}, ERR_USAGE,
                  "a.json: --at is only for .gltf and .glb files");
    check_refused(&(struct scene_load_params){.path = "a.obj", .animation = "x"}, ERR_USAGE,
                  "a.obj: --animation is only for .gltf and .glb files");
    check_refused(&(struct scene_load_params){.path = "a.ply", .scene_name = "0"}, ERR_USAGE,
                  "a.ply: --scene is only for .gltf and .glb files");
    check_refused(&(struct scene_load_params){.path = "a.json", .variant = "red"}, ERR_USAGE,
                  "a.json: --variant is only for .gltf and .glb files");
}

TEST(an_emitter_in_use_is_light_enough)
{
    static const char text[] =
        "{\"lampyris\": 1, \"materials\": {\"lamp\": {\"emission\": [0, 1, 0]},"
        " \"wall\": {}}, \"shapes\": [{\"type\": \"%s\", \"material\": \"%s\","
        " %s}]}";
    static const struct {
        const char *type, *material, *geometry;
        bool is_lit;
    } cases[] = {
        {"sphere", "lamp", "\"radius\": 1", true},
        {"sphere", "wall", "\"radius\": 1", false},
        {"box", "lamp", "\"min\": [0, 0, 0], \"max\": [1, 1, 1]", true},
        {"box", "wall", "\"min\": [0, 0, 0], \"max\": [1, 1, 1]", false},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char document[512];
        snprintf(document, sizeof document, text, cases[i].type, cases[i].material,
                 cases[i].geometry);
        struct scene scene = load(write_text("scene.json", document));
        CHECK(scene.environment.present != cases[i].is_lit, "case %zu", i);
        scene_finish(&scene);
    }
    // Emission of a model without area is still meant as light.
    write_text("point.mtl", "newmtl lamp\nKe 1 1 1\n");
    struct scene point = load(write_text("point.obj", "mtllib point.mtl\nusemtl lamp\nv 2 1 0\n"
                                                      "v 2 1 0\nv 2 1 0\nf 1 2 3\n"));
    CHECK(!point.environment.present);
    scene_finish(&point);
    // Darkness that was requested remains.
    struct scene scene = load(
        write_text("scene.json", "{\"lampyris\": 1, \"environment\": {\"radiance\": [0, 0, 0]}}"));
    CHECK(scene.environment.present && scene.environment.radiance[0] == 0);
    scene_finish(&scene);
}

// Extends the bounding box of points in the picture, whose edges are at -1 and 1.
static void add_in_picture(const struct scene *scene, const double point[3], double low[2],
                           double high[2])
{
    const struct camera *camera = &scene->cameras[0];
    double right[3], up[3], to_point[3];
    vec3_cross(camera->direction, camera->up, right);
    CHECK(vec3_normalize(right));
    vec3_cross(right, camera->direction, up);
    vec3_subtract(point, camera->position, to_point);
    double depth = vec3_dot(to_point, camera->direction);
    double tangent = tan(camera->fov_y / 2);
    double aspect = (double)scene->settings.width / scene->settings.height;
    CHECK(depth > 0, "behind the camera");
    const double at[2] = {vec3_dot(to_point, right) / depth / tangent / aspect,
                          vec3_dot(to_point, up) / depth / tangent};
    for (int i = 0; i < 2; i++) {
        low[i] = fmin(low[i], at[i]);
        high[i] = fmax(high[i], at[i]);
    }
}

// Checks that the box reaches 0.8 from the middle on one pair of sides, and less on the other.
static void check_filled(const double low[2], const double high[2], double tolerance)
{
    int tight = high[0] - low[0] > high[1] - low[1] ? 0 : 1;
    CHECK(fabs(low[tight] + 0.8) < tolerance && fabs(high[tight] - 0.8) < tolerance, "%.15g %.15g",
          low[tight], high[tight]);
    CHECK(low[!tight] >= -0.8 - 1e-12 && high[!tight] <= 0.8 + 1e-12, "%g %g", low[!tight],
          high[!tight]);
    CHECK(fabs(low[!tight] + high[!tight]) < 0.01, "not in the middle: %g %g", low[!tight],
          high[!tight]);
}

static const uint32_t sizes[][2] = {{512, 512}, {1920, 1080}, {100, 300}, {16384, 1}};

TEST(what_is_framed_fills_the_picture)
{
    for (int up = SCENE_UP_Y; up <= SCENE_UP_Z; up++) {
        struct scene scene;
        struct err err = {0};
        const struct scene_load_params params = {.path = write_text("one.obj", ONE_TRIANGLE),
                                                 .up = (enum scene_up)up};
        REQUIRE(scene_load(&params, &scene, &err), "%s", err.msg);
        const struct mesh *mesh = &scene.meshes[0];
        for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
            double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
            scene.settings.width = sizes[i][0];
            scene.settings.height = sizes[i][1];
            scene_frame_camera(&scene);
            for (uint32_t v = 0; v < mesh->vertex_count; v++) {
                double point[3];
                mesh_vertex(mesh, v, point);
                add_in_picture(&scene, point, low, high);
            }
            check_filled(low, high, 1e-12);
        }
        // The camera is above the object and looks down by 20 degrees.
        const struct camera *camera = &scene.cameras[0];
        const double ups[3][3] = {{0, 1, 0}, {1, 0, 0}, {0, 0, 1}};
        CHECK(fabs(vec3_dot(camera->direction, ups[up]) + sin(M_PI / 9)) < 1e-12);
        CHECK(vec3_dot(camera->up, ups[up]) == 1);
        scene_finish(&scene);
    }
}

TEST(framed_shapes_fill_the_picture)
{
    struct scene scene = load(write_text(
        "scene.json", "{\"lampyris\": 1, \"materials\": {\"m\": {\"type\": \"diffuse\"}},"
                      " \"shapes\": [{\"type\": \"sphere\", \"center\": [5, 6, 7],"
                      " \"radius\": 2, \"material\": \"m\"}]}"));
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (int i = 0; i < 100000; i++) {
        // Points along a spiral from pole to pole.
        double z = -1 + 2 * (i + 0.5) / 100000, phi = i * 2.399963, s = sqrt(1 - z * z);
        const double point[3] = {5 + 2 * s * cos(phi), 6 + 2 * s * sin(phi), 7 + 2 * z};
        add_in_picture(&scene, point, low, high);
    }
    check_filled(low, high, 1e-3);
    scene_finish(&scene);
}

TEST(framing_leaves_the_files_camera_alone)
{
    struct scene scene = load(write_text(
        "scene.json", "{\"lampyris\": 1, \"camera\": {\"position\": [1, 2, 3], \"fov_degrees\": 7,"
                      " \"direction\": [1, 0, 0]}}"));
    scene_frame_camera(&scene);
    CHECK(scene.cameras[0].position[2] == 3);
    scene_finish(&scene);
}

TEST(an_empty_scene_is_framed)
{
    struct scene scene = load(write_text("scene.json", "{\"lampyris\": 1}"));
    REQUIRE(scene.camera_count == 1 && scene.is_empty);
    CHECK(isfinite(scene.cameras[0].position[2]) && scene.cameras[0].position[2] > 1);
    scene_finish(&scene);
}

// --- environments --------------------------------------------------------------------------------

static const char *write_image(const char *name, float (*pixels)[3], uint32_t width,
                               uint32_t height)
{
    static char path[512];
    struct err err = {0};
    const struct image image = {width, height, pixels};
    snprintf(path, sizeof path, "%s", in_folder(name));
    const struct image_write_params params = {.path = path, .image = &image};
    CHECK(image_write(&params, &err), "%s", err.msg);
    return path;
}

TEST(environment_images)
{
    float pixels[4][3] = {{1, 2, 3}, {-1, 5, 5}, {5, NAN, 5}, {7, 8, INFINITY}};
    const char *path = write_image("sky.exr", pixels, 2, 2);
    write_text("scene.json", "{\"lampyris\": 1, \"environment\": {\"file\": \"sky.exr\","
                             " \"radiance\": [2, 2, 2]}}");
    struct scene scene = load(in_folder("scene.json"));
    const struct environment *environment = &scene.environment;
    REQUIRE(environment->width == 2 && environment->height == 2 && environment->texels);
    CHECK(environment->radiance[0] == 2 && environment->texels[0][2] == 3);
    for (int i = 1; i < 4; i++)
        CHECK(environment->texels[i][0] == 0 && environment->texels[i][1] == 0, "texel %d", i);
    CHECK(scene.note_count == 2 && strstr(scene.notes[1], "sky.exr: 3 of 4 texels were negative"),
          "%s", scene.notes[1]);

    struct err err = {0};
    uint64_t hash = scene.hash;
    CHECK(scene_set_environment(&scene, path, NULL, &err), "%s", err.msg);
    CHECK(scene.environment.radiance[0] == 1 && scene.environment.texels && scene.hash != hash);
    const float blue[3] = {0, 0, 4};
    CHECK(scene_set_environment(&scene, NULL, blue, &err), "%s", err.msg);
    CHECK(scene.environment.radiance[2] == 4 && scene.environment.width == 0);
    scene_finish(&scene);
}

TEST(environments_that_are_refused)
{
    struct scene scene = load(write_text("scene.json", "{\"lampyris\": 1}"));
    static const float bad[][3] = {{-1, 0, 0}, {0, NAN, 0}, {0, 0, INFINITY}, {1e31f, 0, 0}};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        struct err err = {0};
        CHECK(!scene_set_environment(&scene, NULL, bad[i], &err) && err.code == ERR_INPUT, "%zu",
              i);
        CHECK(strstr(err.msg, "is outside [0, 1e+30]"), "%s", err.msg);
    }
    struct err err = {0};
    float pixels[1][3] = {{1e25f, 0, 0}};
    const float factor[3] = {1e10f, 1, 1};
    CHECK(!scene_set_environment(&scene, write_image("sun.exr", pixels, 1, 1), factor, &err));
    CHECK(strstr(err.msg, "sun.exr: texel 0, 0: radiance 1e+35 exceeds 1e+30"), "%s", err.msg);
    CHECK(!scene_set_environment(&scene, "none.exr", NULL, &err) && err.code == ERR_INPUT);
    CHECK(strstr(err.msg, "none.exr: No such file"), "%s", err.msg);
    scene_finish(&scene);
}

TEST(parameters_replace_the_environment)
{
    const float red[3] = {3, 0, 0};
    struct scene_load_params params = {
        .path = write_text("one.obj", ONE_TRIANGLE),
        .environment_radiance = red,
    };
    struct scene scene;
    struct err err = {0};
    CHECK(scene_load(&params, &scene, &err), "%s", err.msg);
    CHECK(scene.environment.radiance[0] == 3 && scene.note_count == 1, "%u notes",
          scene.note_count);
    scene_finish(&scene);
    params.environment_file = "none.hdr";
    check_refused(&params, ERR_INPUT, "none.hdr");
}

TEST(directions_see_their_texels)
{
    static const struct {
        double direction[3];
        uint32_t column, row;
    } cases[] = {
        // The directions are slightly off the axes, which are borders between texels of a 4 x 2
        // image.
        {{1, 0.1, 0.1}, 2, 0},    {{1, 0.1, -0.1}, 1, 0},  {{-0.1, 0.1, 1}, 3, 0},
        {{0.1, 0.1, 1}, 2, 0},    {{-1, -0.1, 0.1}, 3, 1}, {{-1, -0.1, -0.1}, 0, 1},
        {{-0.1, -0.1, -1}, 0, 1}, {{0.1, -0.1, -1}, 1, 1}, {{-1, -0.1, 0.0}, 3, 1},
        {{0, 1, 0}, 2, 0},        {{0, -1, 0}, 2, 1},
    };
    const struct environment environment = {.present = true, .width = 4, .height = 2};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        double direction[3];
        memcpy(direction, cases[i].direction, sizeof direction);
        CHECK(vec3_normalize(direction));
        uint32_t texel = environment_texel(&environment, direction);
        CHECK(texel == cases[i].row * 4 + cases[i].column, "case %zu: texel %u", i, texel);
    }
}

int main(int argc, char **argv)
{
    static const struct test_case cases[] = {
        TEST_CASE(a_mesh_alone_is_placed_framed_and_lit),
        TEST_CASE(unknown_files_are_refused),
        TEST_CASE(an_emitter_in_use_is_light_enough),
        TEST_CASE(what_is_framed_fills_the_picture),
        TEST_CASE(framed_shapes_fill_the_picture),
        TEST_CASE(framing_leaves_the_files_camera_alone),
        TEST_CASE(an_empty_scene_is_framed),
        TEST_CASE(environment_images),
        TEST_CASE(environments_that_are_refused),
        TEST_CASE(parameters_replace_the_environment),
        TEST_CASE(directions_see_their_texels),
    };
    if (!begin_mesh_tests())
        return 1;
    return test_run(cases, sizeof cases / sizeof cases[0], argc, argv);
}
