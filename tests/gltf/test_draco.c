// Tests meshes compressed by Draco: draco.glb has the triangles of draco.obj, which Draco's own
// encoder has compressed without quantization.
#include "gltf_fixture.h"
#include "scene/core/scene.h"
#include "test.h"

#include <stdlib.h>

// Reads a file of this folder into memory, to be freed by free().
static struct bytes read_fixture(const char *name)
{
    const char *root = getenv("LAMPYRIS_SOURCE_ROOT");
    char path[1024];
    struct bytes out = {0};
    snprintf(path, sizeof path, "%s/tests/gltf/%s", root ? root : ".", name);
    FILE *file = fopen(path, "rb");
    CHECK(file, "%s", path);
    out.data = calloc(1, 1 << 16);
    if (file) {
        out.size = fread(out.data, 1, (1 << 16) - 1, file);
        fclose(file);
    }
    return out;
}

static bool is_same_corner(const struct mesh *a, uint32_t i, const struct mesh *b, uint32_t k)
{
    return memcmp(a->positions[i], b->positions[k], sizeof a->positions[i]) == 0 &&
           memcmp(a->normals[i], b->normals[k], sizeof a->normals[i]) == 0 &&
           memcmp(a->uvs[0][i], b->uvs[0][k], sizeof a->uvs[0][i]) == 0;
}

// Returns whether the triangles have the same corners in the same order, beginning with any.
static bool is_same_triangle(const struct mesh *a, const uint32_t i[3], const struct mesh *b,
                             const uint32_t k[3])
{
    for (int turn = 0; turn < 3; turn++)
        if (is_same_corner(a, i[0], b, k[turn]) && is_same_corner(a, i[1], b, k[(turn + 1) % 3]) &&
            is_same_corner(a, i[2], b, k[(turn + 2) % 3]))
            return true;
    return false;
}

TEST(triangles_are_those_of_the_original)
{
    struct bytes file = read_fixture("draco.glb");
    struct scene scene = empty_scene("draco.glb"), original = empty_scene("draco.obj");
    struct err err = {0};
    char path[1024];
    uint32_t index;
    snprintf(path, sizeof path, "%s/tests/gltf/draco.obj", getenv("LAMPYRIS_SOURCE_ROOT"));
    REQUIRE(load_bytes(&scene, "draco.glb", file, &err), "%s", err.msg);
    REQUIRE(load_obj(&original, path, SCENE_NONE, true, &index, &err), "%s", err.msg);
    const struct mesh *a = &scene.meshes[0], *b = &original.meshes[0];
    REQUIRE(a->triangle_count == 40 && b->triangle_count == 40 && a->normals && b->normals &&
            a->uvs[0] && b->uvs[0]);
    // The v coordinate points up in OBJ and Draco's file, and down in glTF.
    for (uint32_t v = 0; v < a->vertex_count; v++)
        a->uvs[0][v][1] = 1 - a->uvs[0][v][1];
    uint32_t found = 0;
    for (uint32_t t = 0; t < 40; t++)
        for (uint32_t u = 0; u < 40; u++)
            found += is_same_triangle(a, a->indices[t], b, b->indices[u]);
    CHECK(found == 40, "%u of 40", found);
    scene_finish(&scene);
    scene_finish(&original);
    free(file.data);
}

static uint32_t load_u32(const uint8_t *at)
{
    return (uint32_t)at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
}

TEST(damaged_streams)
{
    struct bytes file = read_fixture("draco.glb");
    const size_t json_size = load_u32(file.data + 12), binary = 28 + json_size;
    uint32_t loaded = 0, random = 1;
    for (int i = 0; i < 2000; i++) {
        random = random * 1664525u + 1013904223u;
        uint8_t *at = file.data + binary + (random >> 8) % (file.size - binary);
        random = random * 1664525u + 1013904223u;
        const uint8_t kept = *at;
        *at = (uint8_t)(random >> 24);
        struct scene scene = empty_scene("draco.glb");
        struct err err = {0};
        bool ok = load_bytes(&scene, "draco.glb", file, &err);
        CHECK(ok ? !scene_objection(&scene) : err.code == ERR_INPUT || err.code == ERR_SYSTEM, "%s",
              err.msg);
        loaded += ok;
        scene_finish(&scene);
        *at = kept;
    }
    CHECK(loaded > 0 && loaded < 2000, "%u loaded", loaded); // both outcomes must occur
    free(file.data);
}

TEST(bad_documents)
{
    static const struct {
        const char *find, *replacement, *message; // replacement: of the same length
    } cases[] = {
        {"\"mode\":4", "\"mode\":5", "\"mode\" is 5; expected 4 (triangles)"},
        {"\"count\":30", "\"count\":31", "the count is 31, but KHR_draco_mesh_compression has 30"},
        {"\"count\":120", "\"count\":123", "the count is 123, but"},
        {"\"bufferView\":0", "\"bufferView\":7", "bufferView: 7; expected an index below 1"},
        {"\"bufferView\":0", "\"bufferVieW\":0", "\"bufferView\" is missing"},
        {"\"NORMAL\":2", "\"NORMAL\":9", "NORMAL: the compressed mesh has no attribute 9"},
        {"\"NORMAL\":2", "\"NORMAT\":2", "\"NORMAT\" is missing"},
        {"\"indices\":3", "\"indiceS\":3", "\"indices\" is missing"},
        {"\"type\":\"SCALAR\"", "\"type\":\"SCALAB\"", "type: "},
        {"\"componentType\":5123", "\"componentType\":5126", "expected unsigned integers"},
    };
    struct bytes file = read_fixture("draco.glb");
    const size_t json_size = load_u32(file.data + 12);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct bytes bad = {malloc(file.size), file.size};
        memcpy(bad.data, file.data, file.size);
        const size_t length = strlen(cases[i].find);
        size_t at = 20;
        while (at + length < 20 + json_size && memcmp(bad.data + at, cases[i].find, length) != 0)
            at++;
        CHECK(at + length < 20 + json_size && strlen(cases[i].replacement) == length, "%s",
              cases[i].find);
        memcpy(bad.data + at, cases[i].replacement, length);
        struct scene scene = empty_scene("draco.glb");
        struct err err = {0};
        bool ok = load_bytes(&scene, "draco.glb", bad, &err);
        CHECK(!ok && err.code == ERR_INPUT && strstr(err.msg, cases[i].message) &&
                  strncmp(err.msg, "draco.glb: ", 11) == 0,
              "%s: %s", cases[i].replacement, ok ? "loaded" : err.msg);
        scene_finish(&scene);
        free(bad.data);
    }
    free(file.data);
}

TEST_MAIN(TEST_CASE(triangles_are_those_of_the_original), TEST_CASE(damaged_streams),
          TEST_CASE(bad_documents))
