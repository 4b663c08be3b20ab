#include "render_fixture.h"

bool load_scene(const char *path, const struct scene_override *overrides, struct scene *out,
                struct err *err)
{
    const char *root = getenv("LAMPYRIS_SOURCE_ROOT");
    char full[4096];
    snprintf(full, sizeof full, "%s/%s", root ? root : ".", path);
    struct scene_load_params params = {.path = full, .overrides = overrides};
    while (overrides && overrides[params.override_count].key)
        params.override_count++;
    return scene_load(&params, out, err);
}

bool render_film(const struct renderer_params *params, uint64_t samples, struct arena *arena,
                 struct film_image *film, struct render_stats *stats, struct err *err)
{
    struct renderer renderer;
    const struct render_call call = {.samples = samples};
    if (!renderer_create(params, &renderer, err))
        return false;
    bool ok = renderer_render(&renderer, &call, err) && renderer_read(&renderer, arena, film, err);
    if (stats)
        *stats = renderer.stats;
    renderer_finish(&renderer);
    return ok;
}
