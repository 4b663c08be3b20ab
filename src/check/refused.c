#include "check/refused.h"

#include "check/embedded_scene.h"
#include "check/made_mesh.h"
#include "scene/core/texture_load.h"
#include <stdio.h>
#include <string.h>

bool refused_vertex(struct scene *scene, const struct refusal *refusal, struct err *err)
{
    struct mesh *mesh = made_mesh_add(scene, 2, err);
    if (!mesh)
        return false;
    for (uint32_t i = 0; i < mesh->vertex_count; i++)
        made_mesh_set(mesh, i, i % 2, i / 2, 0);
    mesh->positions[4][1] = (float)refusal->value;
    return true;
}

// Adds an image in Radiance's format: a header and four bytes per pixel.
bool refused_image(struct scene *scene, const struct refusal *refusal, struct err *err)
{
    uint32_t width = (uint32_t)refusal->value, index;
    size_t size = 64 + 4 * (size_t)width;
    char *bytes = arena_alloc(&scene->arena, size, 1);
    if (!bytes)
        return err_memory(err, "an image", size);
    memset(bytes, 0x7f, size);
    int header = snprintf(bytes, 64, "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X %u\n", width);
    bytes[header] = 0x7f; // replaces the terminating NUL
    const struct texture_source source = {
        .data = bytes, .size = (size_t)header + 4 * (size_t)width, .name = "wide.hdr"};
    return texture_image_load(scene, &source, &index, err);
}

static bool is_refused(const struct check *check, const struct refusal *refusal,
                       struct scene *scene, struct err *err)
{
    const struct renderer_params params = {.gpu = check->gpu, .scene = scene};
    struct renderer renderer = {0};
    bool taken = (!refusal->add || refusal->add(scene, refusal, err)) &&
                 renderer_create(&params, &renderer, err);
    renderer_finish(&renderer);
    return !taken;
}

bool refused_run(const struct check *check, const struct check_case *this_case,
                 struct check_result *result, struct err *err)
{
    const struct refusal *refusal = this_case->data;
    struct scene scene;
    bool refused = !embedded_scene_load(refusal->scene, refusal->overrides, &scene, err);
    if (!refused) {
        refused = is_refused(check, refusal, &scene, err);
        scene_finish(&scene);
    }
    bool passed = refused && err->code == ERR_INPUT && strstr(err->msg, refusal->words);
    check_seen(result, passed, "%s", refused ? err->msg : "it was accepted");
    return true;
}
