// Tests truncated and damaged files with skins, morph targets, animations, and compressed and
// interleaved views: the result is an error or a valid scene, never a crash.
#include "gltf_seeds.h"
#include "scene/core/affine.h"
#include "scene/gltf/gltf_load.h"
#include "scene/mesh/tangents.h"
#include "test.h"

static bool load_posed(struct scene *scene, const char *path, struct bytes bytes, struct err *err)
{
    static const double half = 0.5;
    const struct gltf_load_params params = {
        .source = {.path = path, .bytes = {bytes.data, bytes.size}},
        .place = AFFINE_IDENTITY,
        .with_cameras = true,
        .at_seconds = &half,
    };
    *scene = empty_scene(path);
    *err = (struct err){0};
    return gltf_load_bytes(scene, &params, err);
}

// Checks that a loaded scene is valid, also with generated tangents, or that the error names the
// file.
static void check_sound(bool ok, struct scene *scene, struct err *err, const char *path)
{
    if (!ok) {
        CHECK((err->code == ERR_INPUT || err->code == ERR_BUDGET) &&
                  strncmp(err->msg, path, strlen(path)) == 0,
              "code %d: %s", (int)err->code, err->msg);
        return;
    }
    for (uint32_t i = 0; i < scene->mesh_count; i++)
        if (scene->meshes[i].uvs[0] && !scene->meshes[i].tangents)
            CHECK(mesh_generate_tangents(&scene->meshes[i], 0, NULL, &scene->arena, err), "%s",
                  err->msg);
    CHECK(!scene_objection(scene), "%s: %s", path, scene_objection(scene));
}

TEST(whole)
{
    struct gltf_seed seed;
    for (uint32_t i = 0; gltf_seed_make(i, &seed); i++) {
        struct scene scene;
        struct err err;
        bool ok = load_posed(&scene, seed.name, seed.bytes, &err);
        CHECK(ok && scene.mesh_count > 0, "%s", err.msg);
        check_sound(ok, &scene, &err, seed.name);
        scene_finish(&scene);
        free(seed.bytes.data);
    }
}

TEST(cut)
{
    struct gltf_seed seed;
    for (uint32_t i = 0; gltf_seed_make(i, &seed); i++) {
        for (size_t size = 0; size < seed.bytes.size; size++) {
            // A separate copy, so that the sanitizer detects reads past the end. The NUL is that of
            // file_read.
            struct bytes cut = {malloc(size + 1), size};
            memcpy(cut.data, seed.bytes.data, size);
            cut.data[size] = 0;
            struct scene scene;
            struct err err;
            bool ok = load_posed(&scene, seed.name, cut, &err);
            CHECK(!ok && err.code == ERR_INPUT, "%s cut to %zu bytes: %s", seed.name, size,
                  err.msg);
            scene_finish(&scene);
            free(cut.data);
        }
        free(seed.bytes.data);
    }
}

static uint32_t next_random(uint32_t *state)
{
    *state ^= *state << 13;
    *state ^= *state >> 17;
    *state ^= *state << 5;
    return *state;
}

static void damage(struct bytes bytes, uint32_t *random)
{
    static const char likely[] = "0123456789-.e[]{},:\"";
    uint32_t count = 1 + next_random(random) % 4;
    for (uint32_t i = 0; i < count; i++) {
        uint8_t *at = &bytes.data[next_random(random) % bytes.size];
        uint32_t choice = next_random(random);
        if (choice % 3 == 0)
            *at ^= (uint8_t)(1u << (choice >> 8) % 8);
        else
            *at = choice % 3 == 1 ? (uint8_t)(choice >> 8)
                                  : (uint8_t)likely[(choice >> 8) % (sizeof likely - 1)];
    }
}

TEST(damaged)
{
    enum { ROUNDS = 6000 };
    struct gltf_seed seed;
    for (uint32_t i = 0; gltf_seed_make(i, &seed); i++) {
        uint32_t random = 20260729 + i, loaded = 0;
        struct bytes copy = {malloc(seed.bytes.size + 1), seed.bytes.size};
        for (int round = 0; round < ROUNDS; round++) {
            memcpy(copy.data, seed.bytes.data, seed.bytes.size + 1);
            damage(copy, &random);
            struct scene scene;
            struct err err;
            bool ok = load_posed(&scene, seed.name, copy, &err);
            check_sound(ok, &scene, &err, seed.name);
            loaded += ok;
            scene_finish(&scene);
        }
        // Both outcomes must occur, or nothing is tested.
        CHECK(loaded > 0 && loaded < ROUNDS, "%s: %u loaded", seed.name, loaded);
        free(copy.data);
        free(seed.bytes.data);
    }
}

TEST(allocation_failures)
{
    struct gltf_seed seed;
    for (uint32_t i = 0; gltf_seed_make(i, &seed); i++) {
        for (uint64_t n = 1;; n++) {
            struct scene scene;
            struct err err;
            arena_fail_at(n);
            bool ok = load_posed(&scene, seed.name, seed.bytes, &err);
            arena_fail_at(0);
            scene_finish(&scene);
            CHECK(ok || err.code == ERR_SYSTEM, "%s, allocation %llu: code %d: %s", seed.name,
                  (unsigned long long)n, (int)err.code, err.msg);
            if (ok || n > 1000 || err.code != ERR_SYSTEM) {
                CHECK(n > 10 && n < 1000, "%llu allocations", (unsigned long long)n);
                break;
            }
        }
        free(seed.bytes.data);
    }
}

TEST_MAIN(TEST_CASE(whole), TEST_CASE(cut), TEST_CASE(damaged), TEST_CASE(allocation_failures))
