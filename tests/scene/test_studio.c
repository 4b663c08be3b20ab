#include "mesh_files.h"

#include "scene/core/affine.h"
#include "scene/core/environment.h"
#include "scene/core/framing.h"
#include "scene/sky/studio.h"
#include <math.h>
#include <string.h>

static struct scene load(const char *path, enum scene_up up)
{
    const struct scene_load_params params = {.path = path, .studio = SCENE_STUDIO_AUTO, .up = up};
    struct scene scene;
    struct err err = {0};
    bool ok = scene_load(&params, &scene, &err);
    CHECK(ok, "%s", err.msg);
    return scene;
}

static const char triangle[] = "v 1 2 3\nv 2 2 3\nv 1 3 4\nf 1 2 3\n";

// Computes the direction of a texel's centre as environment.h defines it.
static void texel_direction(const struct environment *e, uint32_t row, uint32_t column,
                            double out[3])
{
    double v = M_PI * (row + 0.5) / e->height, u = 2 * M_PI * ((column + 0.5) / e->width - 0.5);
    out[0] = sin(v) * cos(u);
    out[1] = cos(v);
    out[2] = sin(v) * sin(u);
}

// A horizontal surface receives pi. The distant ground reflects as much light as the background has
// at the horizon and below.
TEST(the_ground_meets_the_background)
{
    for (int up = SCENE_UP_Y; up <= SCENE_UP_Z; up++) {
        struct scene scene = load(write_text("a.obj", triangle), (enum scene_up)up);
        const struct environment *e = &scene.environment;
        const struct scene_axes axes = scene_axes((enum scene_up)up);
        REQUIRE(scene.has_studio && scene.has_ground && e->width > 1);
        const struct texture *texture =
            &scene.textures[scene.materials[scene.shapes[0].material].first_texture];
        const float(*texels)[4] = scene.images[texture->image].texels; // its corner is far away
        double received = 0, horizon = (double)texels[0][0];           // times pi / pi
        for (uint32_t row = 0; row < e->height; row++)
            for (uint32_t column = 0; column < e->width; column++) {
                double direction[3];
                double radiance = (double)e->texels[row * e->width + column][0];
                texel_direction(e, row, column, direction);
                double height = vec3_dot(direction, axes.up);
                received += environment_texel_solid_angle(e, row) * fmax(height, 0) * radiance;
                if (fabs(height) < 0.01 || height < -0.6)
                    CHECK(fabs(radiance - horizon) < 1e-3 * horizon, "%g %g", radiance, horizon);
            }
        CHECK(fabs(received / M_PI - 1) < 1e-4, "%g", received / M_PI);
        scene_finish(&scene);
    }
}

// The ground is the last shape, with the last material, below the lowest point. No object of the
// model has another index because of it.
TEST(the_ground_is_below)
{
    static const double lowest[] = {[SCENE_UP_Y] = 2, [SCENE_UP_X] = 1, [SCENE_UP_Z] = 3};
    for (int up = SCENE_UP_Y; up <= SCENE_UP_Z; up++) {
        struct scene scene = load(write_text("a.obj", triangle), (enum scene_up)up);
        const struct scene_axes axes = scene_axes((enum scene_up)up);
        const struct shape *ground = &scene.shapes[scene.shape_count - 1];
        REQUIRE(scene.shape_count == 1 && scene.instance_count == 1);
        CHECK(ground->kind == SHAPE_PLANE && ground->material == scene.material_count - 1);
        CHECK(vec3_dot(ground->normal, axes.up) == 1);
        double height = vec3_dot(ground->center, axes.up) - lowest[up];
        CHECK(height < 0 && height > -1e-4, "%g", height);
        scene_finish(&scene);
    }
}

// F / (pi A) for a unit square that emits, in its bounding sphere of radius sqrt(1/2).
TEST(emission_is_judged)
{
    static const struct {
        const char *emission;
        double expected;
    } rows[] = {{"1 1 1", 1 / (2 * M_PI)},
                {"0.4 0.4 0.4", 0.4 / (2 * M_PI)},
                {"0.3 0.3 0.3", 0.3 / (2 * M_PI)}};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        char mtl[128];
        snprintf(mtl, sizeof mtl, "newmtl m\nKe %s\n", rows[i].emission);
        write_text("m.mtl", mtl);
        struct scene scene = load(write_text("m.obj", "mtllib m.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\n"
                                                      "v 1 1 0\nv 0 1 0\nf 1 2 3 4\n"),
                                  SCENE_UP_Y);
        bool is_lit = rows[i].expected >= STUDIO_EMISSION_LEAST;
        CHECK(scene.has_studio == !is_lit, "row %zu", i);
        CHECK(fabs(scene.weak_emission - (is_lit ? 0 : rows[i].expected)) < 1e-6, "%g",
              scene.weak_emission);
        scene_finish(&scene);
    }
}

// If a light sends the flux F to a model of radius sqrt(1/2), the model's illumination is F / (pi
// A). A distant point light of intensity I sends I pi r^2 / d^2, one inside 4 pi I, and a
// directional light E pi r^2.
TEST(lights_are_judged)
{
    static const struct {
        const char *light, *place;
        double expected;
    } rows[] = {
        {"\"type\": \"point\", \"intensity\": 1e-9", "0.5, 0.5, 0", 1e-9 * 2 / M_PI},
        {"\"type\": \"point\", \"intensity\": 0.11", "0.5, 0.5, 0", 0.11 * 2 / M_PI},
        {"\"type\": \"point\", \"intensity\": 1000", "0.5, 0.5, 1000", 1000 / (4 * M_PI) / 1e6},
        {"\"type\": \"point\", \"intensity\": 1e6", "0.5, 0.5, 1000", 1 / (4 * M_PI)},
        {"\"type\": \"point\", \"intensity\": 1e6, \"range\": 9", "0.5, 0.5, 1000", 0},
        {"\"type\": \"spot\", \"spot\": {}, \"intensity\": 1e6", "0.5, 0.5, 1000", 1 / (4 * M_PI)},
        {"\"type\": \"spot\", \"spot\": {}, \"intensity\": 1e6", "0.5, 0.5, -1000", 0},
        {"\"type\": \"directional\", \"intensity\": 0.7", "0, 0, 0", 0.7 / (4 * M_PI)},
        {"\"type\": \"directional\", \"intensity\": 0.8", "0, 0, 0", 0.8 / (4 * M_PI)},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        char text[2048];
        snprintf(
            text, sizeof text,
            "{\"asset\": {\"version\": \"2.0\"}, \"scene\": 0, \"scenes\": [{\"nodes\": [0, 1]}],"
            "\"extensionsUsed\": [\"KHR_lights_punctual\"], \"extensions\":"
            " {\"KHR_lights_punctual\": {\"lights\": [{%s}]}}, \"nodes\": [{\"mesh\": 0},"
            " {\"translation\": [%s], \"extensions\": {\"KHR_lights_punctual\": {\"light\": 0}}}],"
            "\"meshes\": [{\"primitives\": [{\"attributes\": {\"POSITION\": 0}}]}],"
            "\"buffers\": [{\"byteLength\": 36, \"uri\": \"data:application/octet-stream;base64,"
            "AAAAAAAAAAAAAAAAAACAPwAAgD8AAAAAAAAAAAAAgD8AAAAA\"}],"
            "\"bufferViews\": [{\"buffer\": 0, \"byteLength\": 36}], \"accessors\": "
            "[{\"bufferView\":"
            " 0, \"componentType\": 5126, \"count\": 3, \"type\": \"VEC3\", \"min\": [0, 0, 0],"
            " \"max\": [1, 1, 0]}]}",
            rows[i].light, rows[i].place);
        struct scene scene = load(write_text("l.gltf", text), SCENE_UP_Y);
        bool is_lit = rows[i].expected >= STUDIO_EMISSION_LEAST;
        CHECK(scene.has_studio == !is_lit, "row %zu", i);
        CHECK(fabs(scene.weak_emission - (is_lit ? 0 : rows[i].expected)) <=
                  1e-5 * rows[i].expected,
              "row %zu: %g", i, scene.weak_emission);
        scene_finish(&scene);
    }
}

// In this program's own format, a camera shows that the scene is composed, so emission is intended.
TEST(scene_files)
{
    static const struct {
        const char *text;
        bool has_studio, has_ground;
    } rows[] = {
        {"\"materials\": {\"m\": {\"type\": \"diffuse\"}}", true, true},
        {"\"materials\": {\"m\": {\"type\": \"diffuse\"}}, \"camera\": {\"position\": [0, 0, 9],"
         " \"direction\": [0, 0, -1], \"fov_degrees\": 30}",
         false, false},
        {"\"materials\": {\"m\": {\"type\": \"diffuse\", \"emission\": [1e-6, 0, 0]}}", false,
         false},
        {"\"materials\": {\"m\": {\"type\": \"diffuse\"}}, \"environment\": {\"radiance\":"
         " [0, 0, 0]}",
         false, false},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        char document[512];
        snprintf(document, sizeof document,
                 "{\"lampyris\": 1, %s, \"shapes\": [{\"type\": \"sphere\", \"center\":"
                 " [0, 0, 0], \"radius\": 1, \"material\": \"m\"}]}",
                 rows[i].text);
        struct scene scene = load(write_text("s.json", document), SCENE_UP_Y);
        CHECK(scene.has_studio == rows[i].has_studio, "row %zu", i);
        CHECK(scene.has_ground == rows[i].has_ground, "row %zu", i);
        scene_finish(&scene);
    }
}

TEST_MAIN(TEST_CASE(the_ground_meets_the_background), TEST_CASE(the_ground_is_below),
          TEST_CASE(emission_is_judged), TEST_CASE(lights_are_judged), TEST_CASE(scene_files))
