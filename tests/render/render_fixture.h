// Functions that the render tests share: opening a device, loading scenes, and rendering pictures.
#ifndef LAMPYRIS_TESTS_RENDER_FIXTURE_H
#define LAMPYRIS_TESTS_RENDER_FIXTURE_H

#include "open_gpu.h"
#include "render/render.h"

// For calls whose last argument is a struct err with the name `err`.
#define REQUIRE_OK(call) REQUIRE(call, "%s", err.msg)

// Loads a scene file of the project, given relative to the source root. Overrides end with an entry
// whose key is NULL; NULL means none.
bool load_scene(const char *path, const struct scene_override *overrides, struct scene *out,
                struct err *err);

// Renders `samples` of every pixel into one picture in `arena`, with a renderer that exists only
// for this call. params->scene and params->gpu must be set. `stats` may be NULL.
bool render_film(const struct renderer_params *params, uint64_t samples, struct arena *arena,
                 struct film_image *film, struct render_stats *stats, struct err *err);

#endif
