// Loads files made by others. Triangle counts and bounds were computed by a separate Python script
// that decodes the files with the struct module.
#include "gltf_fixture.h"
#include "test.h"

#include <sys/stat.h>

struct expectation {
    const char *file;
    uint64_t triangles;
    uint32_t instances, materials, cameras, textures, images;
    double bounds[2][3];
    double area;
};

static const struct expectation expectations[] = {
    {"balloon/scene.gltf",
     35698,
     37,
     37,
     0,
     19,
     17,
     {{-0.1414320021867752, 0.21339499950408936, -0.28598603606224043},
      {0.43839697539806366, 0.9081050157546997, 0.2917779982089998}},
     1.144309481722075},
    {"roughness-scale/scene.gltf",
     51200,
     10,
     10,
     0,
     5,
     5,
     {{-0.9999999403953552, -4.0, -6.999999940395355}, {1.0, 4.0, 6.999999940395355}},
     125.51266081976135},
    {"shader_ball/shader_ball.gltf",
     9450,
     1,
     1,
     1,
     0,
     0,
     {{-1.0, -1.045469045639038, -1.2017070055007935},
      {1.3013720512390137, 1.0, 1.2017070055007935}},
     22.82256627861396},
};

static bool find_file(const char *name, char *path, size_t size)
{
    const char *data = getenv("LAMPYRIS_DATA"), *root = getenv("LAMPYRIS_SOURCE_ROOT");
    if (data)
        snprintf(path, size, "%s/gltf/%s", data, name);
    else
        snprintf(path, size, "%s/../shared/data/gltf/%s", root ? root : ".", name);
    struct stat status;
    return stat(path, &status) == 0;
}

static void to_world(const struct instance *instance, const float *p, double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = instance->transform[i][0] * (double)p[0] +
                 instance->transform[i][1] * (double)p[1] +
                 instance->transform[i][2] * (double)p[2] + instance->transform[i][3];
}

static double triangle_area(const double p[3][3])
{
    double square = 0;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        double c =
            (p[1][j] - p[0][j]) * (p[2][k] - p[0][k]) - (p[1][k] - p[0][k]) * (p[2][j] - p[0][j]);
        square += c * c;
    }
    return sqrt(square) / 2;
}

struct measure {
    uint64_t triangles;
    double bounds[2][3], area;
};

static void measure_instance(const struct scene *scene, const struct instance *instance,
                             struct measure *out)
{
    const struct mesh *mesh = &scene->meshes[instance->mesh];
    out->triangles += mesh->triangle_count;
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        double p[3][3];
        for (int c = 0; c < 3; c++) {
            to_world(instance, mesh->positions[mesh->indices[t][c]], p[c]);
            for (int i = 0; i < 3; i++) {
                out->bounds[0][i] = fmin(out->bounds[0][i], p[c][i]);
                out->bounds[1][i] = fmax(out->bounds[1][i], p[c][i]);
            }
        }
        out->area += triangle_area((const double(*)[3])p);
    }
}

static void check_measure(const struct scene *scene, const struct expectation *expected)
{
    struct measure found = {
        .bounds = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}}};
    for (uint32_t i = 0; i < scene->instance_count; i++)
        measure_instance(scene, &scene->instances[i], &found);
    CHECK(found.triangles == expected->triangles, "%s: %llu", expected->file,
          (unsigned long long)found.triangles);
    for (int side = 0; side < 2; side++)
        for (int i = 0; i < 3; i++)
            CHECK(fabs(found.bounds[side][i] - expected->bounds[side][i]) < 1e-9, "%s: %.17g",
                  expected->file, found.bounds[side][i]);
    CHECK(fabs(found.area - expected->area) < 1e-9 * expected->area, "%s: %.17g", expected->file,
          found.area);
}

static void check_file(const struct expectation *expected, const char *path)
{
    struct scene scene = empty_scene(path);
    struct err err = {0};
    bool ok = load_gltf(&scene, &(struct scene_load_params){.path = path}, &err);
    CHECK(ok, "%s", err.msg);
    if (ok) {
        CHECK(!scene_objection(&scene), "%s: %s", expected->file, scene_objection(&scene));
        CHECK(scene.instance_count == expected->instances &&
                  scene.material_count == expected->materials &&
                  scene.camera_count == expected->cameras,
              "%s: %u instances, %u materials, %u cameras", expected->file, scene.instance_count,
              scene.material_count, scene.camera_count);
        CHECK(scene.texture_count == expected->textures && scene.image_count == expected->images,
              "%s: %u textures, %u images", expected->file, scene.texture_count, scene.image_count);
        for (uint32_t i = 0; i < scene.material_count; i++)
            CHECK(scene.materials[i].model == MATERIAL_PRINCIPLED);
        CHECK(scene.note_count == 0, "%s: %s", expected->file,
              scene.note_count ? scene.notes[0] : "");
        check_measure(&scene, expected);
    }
    scene_finish(&scene);
}

TEST(real_files)
{
    for (size_t i = 0; i < sizeof expectations / sizeof expectations[0]; i++) {
        char path[4096];
        if (!find_file(expectations[i].file, path, sizeof path))
            SKIP("%s is not there", path);
        check_file(&expectations[i], path);
    }
}

// The exporter also wrote the eye and the centre, which give the camera's position and direction.
TEST(camera_of_the_shader_ball)
{
    static const double eye[3] = {-6.100406646728516, 3.0585501194000244, 1.417274832725525};
    static const double center[3] = {-0.02529621124267578, -0.1367936134338379,
                                     0.18913745880126953};
    char path[4096];
    if (!find_file("shader_ball/shader_ball.gltf", path, sizeof path))
        SKIP("%s is not there", path);
    struct scene scene = empty_scene(path);
    struct err err = {0};
    CHECK(load_gltf(&scene, &(struct scene_load_params){.path = path}, &err), "%s", err.msg);
    if (scene.camera_count == 1) {
        double to_center[3], length = 0;
        for (int i = 0; i < 3; i++) {
            to_center[i] = center[i] - eye[i];
            length += to_center[i] * to_center[i];
        }
        for (int i = 0; i < 3; i++) {
            CHECK(scene.cameras[0].position[i] == eye[i]);
            CHECK(fabs(scene.cameras[0].direction[i] - to_center[i] / sqrt(length)) < 1e-5);
        }
    }
    scene_finish(&scene);
}

// Five materials have their roughness as a factor, the others as a texture of one texel. The file
// contains them in pairs.
TEST(roughness_by_factor_and_by_texture)
{
    char path[4096];
    if (!find_file("roughness-scale/scene.gltf", path, sizeof path))
        SKIP("%s is not there", path);
    struct scene scene = empty_scene(path);
    struct err err = {0};
    CHECK(load_gltf(&scene, &(struct scene_load_params){.path = path}, &err), "%s", err.msg);
    uint32_t pairs = 0;
    for (uint32_t i = 0; i < scene.material_count; i++) {
        const struct material *textured = &scene.materials[i];
        if (textured->texture_count != 1)
            continue;
        const struct texture *texture = &scene.textures[textured->first_texture];
        float roughness = textured->roughness * scene.images[texture->image].mean[1];
        for (uint32_t j = 0; j < scene.material_count; j++)
            pairs += scene.materials[j].texture_count == 0 &&
                     fabsf(scene.materials[j].roughness - roughness) < 1e-3f;
    }
    CHECK(pairs == 5, "%u", pairs);
    scene_finish(&scene);
}

// Placed inside another scene, the file gives the same triangles at another place, and no cameras.
TEST(placed_in_another_scene)
{
    static const double place[3][4] = {{2, 0, 0, 10}, {0, 2, 0, 20}, {0, 0, 2, 30}};
    char path[4096];
    if (!find_file("shader_ball/shader_ball.gltf", path, sizeof path))
        SKIP("%s is not there", path);
    struct scene scene = empty_scene(path);
    struct err err = {0};
    struct expectation expected = expectations[2];
    for (int i = 0; i < 3; i++)
        for (int side = 0; side < 2; side++)
            expected.bounds[side][i] = 2 * expected.bounds[side][i] + 10 * (i + 1);
    expected.area *= 4;
    bool ok = scene_add_material(&scene, NULL) && scene_add_mesh(&scene, NULL) &&
              load_gltf_into(&scene, path, place, false, &err);
    CHECK(ok, "%s", err.msg);
    CHECK(scene.camera_count == 0 && scene.material_count == 2 && scene.mesh_count == 2);
    CHECK(scene.mesh_count == 2 && scene.meshes[1].material == 1);
    if (ok)
        check_measure(&scene, &expected);
    scene_finish(&scene);
}

TEST_MAIN(TEST_CASE(real_files), TEST_CASE(camera_of_the_shader_ball),
          TEST_CASE(roughness_by_factor_and_by_texture), TEST_CASE(placed_in_another_scene))
