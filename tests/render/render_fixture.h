// What the render tests share: a device, scenes from files, and pictures of them.
#ifndef LAMPYRIS_TESTS_RENDER_FIXTURE_H
#define LAMPYRIS_TESTS_RENDER_FIXTURE_H

#include "open_gpu.h"
#include "render/render.h"

// For calls with a struct err called `err` as their last argument.
#define REQUIRE_OK(call) REQUIRE(call, "%s", err.msg)

// A scene file of the project, by its path from the source root. Overrides end with a key of NULL;
// NULL: none.
bool load_scene(const char *path, const struct scene_override *overrides, struct scene *out,
                struct err *err);

// `samples` of every pixel as one picture in `arena`. A renderer is made for it and released;
// params->scene and params->gpu must be set. stats may be NULL.
bool render_film(const struct renderer_params *params, uint64_t samples, struct arena *arena,
                 struct film_image *film, struct render_stats *stats, struct err *err);

#endif
