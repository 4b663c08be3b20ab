// libFuzzer target for glTF and GLB: `fuzz_gltf CORPUS_FOLDER`; write_seeds fills the folder. The
// first four bytes decide which of the two formats it is. Built with clang on request. A file that
// loads must give a valid scene, with its animation at half a second, and with tangents if there
// are texture coordinates.
#include "gltf_fixture.h"
#include "scene/core/affine.h"
#include "scene/gltf/gltf_load.h"
#include "scene/mesh/tangents.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static bool make_tangents(struct scene *scene)
{
    struct err err;
    for (uint32_t i = 0; i < scene->mesh_count; i++)
        if (scene->meshes[i].uvs[0] && !scene->meshes[i].tangents &&
            !mesh_generate_tangents(&scene->meshes[i], 0, NULL, &scene->arena, &err))
            return err.code == ERR_BUDGET; // the budget is small
    return true;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const double half = 0.5;
    uint8_t *copy = malloc(size + 1);
    memcpy(copy, data, size);
    copy[size] = 0; // file_read also appends a NUL
    struct err err;
    const struct gltf_load_params params = {
        // The folder does not exist, so no URI of the input names a file.
        .source = {.path = "/nonexistent/fuzz.gltf", .bytes = {copy, size}},
        .place = AFFINE_IDENTITY,
        .with_cameras = true,
        .at_seconds = &half,
    };
    struct scene scene = empty_scene(params.source.path);
    if (gltf_load_bytes(&scene, &params, &err) &&
        (!make_tangents(&scene) || scene_objection(&scene))) {
        fprintf(stderr, "%s\n", scene_objection(&scene));
        abort();
    }
    scene_finish(&scene);
    free(copy);
    return 0;
}
