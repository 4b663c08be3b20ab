#include "check/check_scene.h"

#include "render/render.h"
#include <math.h>

// Zero areas: nothing hits these triangles, and no light comes from them.
static bool find_zero_areas(const struct flat_scene *flat, struct arena *arena,
                            struct scene_findings *out, struct err *err)
{
    if (flat->dropped_degenerate == 0)
        return true;
    out->items = ARENA_NEW(arena, struct scene_finding, 1);
    const char *figure = arena_printf(arena, "%u of %u triangles", flat->dropped_degenerate,
                                      flat->triangle_count + flat->dropped_degenerate);
    if (!out->items || !figure)
        return err_memory(err, "what is found in the scene", sizeof *out->items);
    out->items[out->count++] = (struct scene_finding){
        .name = "zero-area",
        .place = "all meshes",
        .figure = figure,
        .consequence = "Triangles without area are left out.",
        .remedy = "Merge or remove them in the file.",
        .share = NAN,
    };
    return true;
}

bool check_scene(const struct renderer_params *params, struct arena *arena,
                 struct scene_findings *out, struct err *err)
{
    struct renderer renderer = {0};
    *out = (struct scene_findings){0};
    bool ok = renderer_prepare(params, &renderer, err) &&
              find_zero_areas(&renderer.flat, arena, out, err);
    renderer_finish(&renderer);
    return ok;
}
