// Tests meshes in the caller's arrays: which data are copied, and which are refused.
#include "base/memory.h"
#include "scene/core/scene.h"
#include "test.h"

#define SCENE                                                                                      \
    "{\"lampyris\": 1, \"materials\": {\"red\": {\"base_color\": [1, 0, 0]}}, \"shapes\": ["       \
    "{\"type\": \"mesh\", \"array\": \"waves\", \"material\": \"red\","                            \
    " \"transform\": {\"translate\": [10, 0, 0]}},"                                                \
    "{\"type\": \"mesh\", \"array\": \"waves\"}]}"

// A vertex with gaps after each attribute.
struct vertex {
    char gap;
    float position[3], normal[3], uv[2], color[4];
} __attribute__((packed));

static const struct vertex vertices[] = {
    {0, {0, 0, 0}, {0, 0, 2}, {0, 0}, {1, 0, 0, 1}},
    {0, {1, 0, 0}, {0, 0, 1}, {1, 0}, {0, 1, 0, 1}},
    {0, {0, 2, 0}, {0, 0, 0}, {0, 1}, {0, 0, 1, .5f}},
    {0, {1, 2, 3}, {3, 0, 4}, {1, 1}, {1, 1, 1, 1}},
};
static const uint32_t indices[][4] = {{0, 1, 2, 99}, {2, 1, 3, 99}};

static struct scene_array waves(void)
{
    const size_t stride = sizeof(struct vertex);
    return (struct scene_array){
        .name = "waves",
        .vertex_count = 4,
        .triangle_count = 2,
        .positions = (const char *)vertices + offsetof(struct vertex, position),
        .normals = (const char *)vertices + offsetof(struct vertex, normal),
        .uvs = (const char *)vertices + offsetof(struct vertex, uv),
        .colors = (const char *)vertices + offsetof(struct vertex, color),
        .position_stride = stride,
        .normal_stride = stride,
        .uv_stride = stride,
        .color_stride = stride,
        .indices = indices,
        .index_stride = sizeof *indices,
    };
}

static bool load(const struct scene_array *array, struct scene *out, struct err *err)
{
    const struct scene_load_params params = {
        .path = "arrays.json", .text = SCENE, .arrays = array, .array_count = 1};
    *err = (struct err){0};
    return scene_load(&params, out, err);
}

TEST(arrays_are_copied_with_their_strides)
{
    struct scene scene;
    struct err err;
    const struct scene_array array = waves();
    REQUIRE(load(&array, &scene, &err), "%s", err.msg);
    REQUIRE(scene.mesh_count == 2 && scene.instance_count == 2);
    const struct mesh *mesh = &scene.meshes[1];
    REQUIRE(mesh->vertex_count == 4 && mesh->triangle_count == 2);
    for (int v = 0; v < 4; v++) {
        CHECK(memcmp(mesh->positions[v], vertices[v].position, 12) == 0, "vertex %d", v);
        CHECK(memcmp(mesh->uvs[0][v], vertices[v].uv, 8) == 0, "vertex %d", v);
        CHECK(memcmp(mesh->colors[v], vertices[v].color, 16) == 0, "vertex %d", v);
    }
    CHECK(mesh->normals[0][2] == 1 && mesh->normals[2][2] == 0);
    CHECK(mesh->normals[3][0] == .6f && mesh->normals[3][2] == .8f);
    for (int t = 0; t < 2; t++)
        CHECK(memcmp(mesh->indices[t], indices[t], 12) == 0, "triangle %d", t);
    CHECK(scene.meshes[0].material == 0 && scene.instances[0].transform[0][3] == 10);
    CHECK(scene.materials[mesh->material].base_color[2] == 1, "white below the colours");
    CHECK(scene.camera_is_framed, "the meshes are framed");
    scene_finish(&scene);
}

TEST(arrays_without_gaps_and_without_indices)
{
    static const float soup[6][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0},
                                     {0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
    struct scene scene;
    struct err err;
    struct scene_array array = {
        .name = "waves", .vertex_count = 6, .triangle_count = 2, .positions = soup};
    REQUIRE(load(&array, &scene, &err), "%s", err.msg);
    const struct mesh *mesh = &scene.meshes[0];
    CHECK(mesh->indices[1][0] == 3 && mesh->indices[1][2] == 5);
    CHECK(memcmp(mesh->positions, soup, sizeof soup) == 0);
    CHECK(!mesh->normals && !mesh->uvs[0] && !mesh->colors);
    uint64_t hash = scene.hash;
    scene_finish(&scene);
    array.triangle_count = 1;
    array.vertex_count = 3;
    REQUIRE(load(&array, &scene, &err), "%s", err.msg);
    CHECK(scene.hash != hash, "the hash covers the arrays");
    scene_finish(&scene);
}

static void check_refused(const struct scene_array *array, const char *message)
{
    struct scene scene;
    struct err err;
    CHECK(!load(array, &scene, &err) && err.code == ERR_INPUT, "code %d", err.code);
    CHECK(strstr(err.msg, message), "'%s' is not in '%s'", message, err.msg);
    CHECK(strcmp(err.place, "/shapes/0/array") == 0, "%s", err.place);
    CHECK(strcmp(err.file, "arrays.json") == 0, "%s", err.file);
}

TEST(what_is_wrong_is_named)
{
    static const uint32_t beyond[][3] = {{0, 1, 2}, {0, 4, 1}};
    static const float far[][3] = {{0, 0, 0}, {0, 0, 1e14f}, {0, 1, 0}, {1, 1, 1}};
    static const float infinite[][3] = {{0, 0, 0}, {0, INFINITY, 0}, {0, 1, 0}, {1, 1, 1}};
    struct scene_array array = waves();
    array.indices = beyond;
    array.index_stride = 0;
    check_refused(&array, "mesh \"waves\": indices[1][1]: 4; expected less than 4, the number of");
    array = waves();
    array.position_stride = 0;
    array.positions = far;
    check_refused(&array, "mesh \"waves\": positions[1][2]: 1e+14 is outside [-1e+13, 1e+13]");
    array.positions = infinite;
    check_refused(&array, "mesh \"waves\": positions[1][1]: inf is outside");
    array = waves();
    array.indices = NULL;
    check_refused(&array, "mesh \"waves\": 2 triangles without indices need three vertices each; "
                          "there are 4");
    array = waves();
    array.name = "other";
    check_refused(&array, "there are no arrays for a mesh \"waves\"");
}

TEST(memory_that_is_lacking_is_an_error)
{
    struct scene_array array = waves();
    struct scene scene;
    struct err err;
    uint32_t failures = 0;
    for (uint64_t n = 1;; n++) {
        arena_fail_at(n);
        bool ok = load(&array, &scene, &err);
        arena_fail_at(0);
        if (ok)
            break;
        failures++;
        CHECK(err.code == ERR_SYSTEM, "at allocation %llu: %s", (unsigned long long)n, err.msg);
    }
    CHECK(failures > 10, "%u", failures);
    scene_finish(&scene);
    CHECK(memory_used() == 0);
}

TEST_MAIN(TEST_CASE(arrays_are_copied_with_their_strides),
          TEST_CASE(arrays_without_gaps_and_without_indices), TEST_CASE(what_is_wrong_is_named),
          TEST_CASE(memory_that_is_lacking_is_an_error))
